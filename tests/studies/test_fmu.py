"""Scenes as FMUs, run by FMPy in a process of its own: an FMU brings its own Python into the program that runs it."""

import json
import subprocess
import sys

import numpy as np
import pytest
from click.testing import CliRunner

import stiffmbs
from stiffmbs import InputError
from stiffmbs.commands.main import main

pytest.importorskip("fmpy")
pytest.importorskip("pythonfmu")

SCENE = """
name: Pushed
parameters: {k: 40 N/m}
inputs: {push: 0 N}
bodies: {sled: {mass: 2 kg, inertia: 0.1, velocity: [1, 0]}}
joints: {rail: {type: prismatic, i: sled, j: ground}}
forces:
  spring: {type: spring_damper, i: {body: sled, point: [0, 0]}, j: {body: ground, point: [-3, 0]}, stiffness: k, free_length: 3}
  pusher: {type: force, i: sled, force: [push, 0]}
requests: {where: sled.x, speed: sled.vx}
run: {duration: 2 s, output: 10 ms, rtol: 1e-9}
"""

RUN = """
import json, sys
import numpy as np
from fmpy import simulate_fmu
path, values, pushes = sys.argv[1], json.loads(sys.argv[2]), json.loads(sys.argv[3])
signals = np.array([tuple(row) for row in pushes], dtype=[("time", float), ("push", float)]) if pushes else None
found = simulate_fmu(path, stop_time=2.0, step_size=0.01, output_interval=0.01, start_values=values, input=signals)
print(json.dumps({name: found[name].tolist() for name in found.dtype.names}))
"""


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "pushed.yaml"
    path.write_text(SCENE, encoding="utf-8")
    return path


def simulated(fmu, values=None, pushes=()):
    command = [sys.executable, "-c", RUN, str(fmu), json.dumps(values or {}), json.dumps(list(pushes))]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr[-2000:]
    return {name: np.array(found) for name, found in json.loads(done.stdout.splitlines()[-1]).items()}


def test_an_fmu_moves_as_the_run_does(scene, tmp_path):
    """Free, with another parameter, and pushed from 0.5 s on: by the closed form of the oscillator."""
    fmu = tmp_path / "pushed.fmu"
    assert stiffmbs.build_fmu(scene, fmu) == ("where", "speed")
    omega = np.sqrt(90 / 2)
    stiffer = simulated(fmu, {"k": 90.0})
    np.testing.assert_allclose(stiffer["where"], np.sin(omega * stiffer["time"]) / omega, atol=1e-6)
    np.testing.assert_allclose(
        stiffer["where"][-1], stiffmbs.run(stiffmbs.load_scene(scene, [("k", "90 N/m")]))["where"][-1], atol=1e-6
    )

    pushed = simulated(fmu, pushes=[(0.0, 0.0), (0.5, 0.0), (0.5, 8.0), (2.0, 8.0)])
    omega = np.sqrt(40 / 2)
    late = np.maximum(pushed["time"] - 0.5, 0)
    x = np.sin(omega * pushed["time"]) / omega + 8 / 40 * (1 - np.cos(omega * late))
    np.testing.assert_allclose(pushed["where"], x, atol=1e-6)


def test_the_command_names_the_outputs(scene, tmp_path):
    found = CliRunner().invoke(
        main, ["fmu", str(scene), "-o", str(tmp_path / "a.fmu"), "--channel", "rail.fy", "--json"]
    )
    assert found.exit_code == 0, found.output
    assert json.loads(found.output)["outputs"] == ["rail.fy"]


@pytest.mark.parametrize(
    ("output", "channels", "words"),
    [("a.zip", (), "found the ending '.zip', expected .fmu"), ("a.fmu", ("sled.q",), "found no channel 'sled.q'")],
)
def test_what_cannot_be_built_is_told(scene, tmp_path, output, channels, words):
    with pytest.raises(InputError, match=words):
        stiffmbs.build_fmu(scene, tmp_path / output, channels)
