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


@pytest.mark.long
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
    [
        ("a.zip", (), "found the ending '.zip', expected .fmu"),
        ("a.fmu", ("sled.q",), "found no channel 'sled.q'"),
        ("a.fmu", ("push",), "which is an input or parameter"),
    ],
)
def test_what_cannot_be_built_is_told(scene, tmp_path, output, channels, words):
    with pytest.raises(InputError, match=words):
        stiffmbs.build_fmu(scene, tmp_path / output, channels)


INSTANCES = """
import json, sys
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

def instance(folder, path, k):
    about = read_model_description(path)
    model = about.coSimulation.modelIdentifier
    made = FMU2Slave(guid=about.guid, unzipDirectory=folder, modelIdentifier=model, instanceName=f"instance{k}")
    made.instantiate()
    return made, {v.name: v.valueReference for v in about.modelVariables}

def started(made, refs, k):
    made.setupExperiment(startTime=0.0)
    made.enterInitializationMode()
    made.setReal([refs["k"]], [40.0 + 10 * k])
    at_start = made.getReal([refs["pull"]])
    made.exitInitializationMode()
    assert made.getReal([refs["pull"]]) == at_start, (made.getReal([refs["pull"]]), at_start)

paths, freed = sys.argv[1].split(","), sys.argv[2] == "freed"
folders = [extract(path) for path in paths]
instances = [instance(folders[k % len(paths)], paths[k % len(paths)], k) for k in range(6)]
if freed:
    for made, _ in instances[::2]:
        made.freeInstance()
    instances[::2] = [instance(folders[k % len(paths)], paths[k % len(paths)], k) for k in range(0, 6, 2)]
for k, (made, refs) in enumerate(instances):
    started(made, refs, k)
for step in range(50):
    for made, _ in instances:
        made.doStep(0.01 * step, 0.01)
print(json.dumps([made.getReal([refs["where"]])[0] for made, refs in instances]))
for made, _ in instances:
    made.terminate()
    made.freeInstance()
"""


@pytest.mark.long
@pytest.mark.parametrize(("files", "freed"), [(1, "freed"), (3, "kept"), (3, "freed")])
def test_a_process_may_have_many_instances_of_one_or_several_files(tmp_path, files, freed):
    paths = [tmp_path / f"sled{k}.fmu" for k in range(files)]
    for k, path in enumerate(paths):
        (tmp_path / f"sled{k % 2}.yaml").write_text(SCENE.replace("where: sled.x", "where: sled.x, pull: spring.fx"))
        stiffmbs.build_fmu(tmp_path / f"sled{k % 2}.yaml", path, ["where", "pull"])  # two of three have one name
    command = [sys.executable, "-c", INSTANCES, ",".join(map(str, paths)), freed]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr[-2000:]
    omega = np.sqrt((40 + 10 * np.arange(6)) / 2)
    np.testing.assert_allclose(json.loads(done.stdout.splitlines()[-1]), np.sin(omega * 0.5) / omega, atol=1e-7)


SPACE = """
dimensions: 3
gravity: [0, 0, -9.81]
parameters: {k: 40 N/m}
bodies: {ball: {mass: 1, inertia: [1, 1, 1], position: [0.3, 0, 0]}}
forces: {spring: {type: force, i: ball, force: [-k*ball.x, 0, 9.81 N]}}
"""


@pytest.mark.parametrize(
    ("text", "outputs"),
    [
        (SCENE, ()), (SCENE, ("sled.x",)), (SCENE.replace("requests:", "# "), ()), (SCENE.replace("inputs: {push: 0 N}", "variables: {push: 0 N}"), ()),
        (SCENE.replace("k: 40 N/m", "k: 40 N/m, other: 3, third: 2 m"), ()), (SPACE, ()), (SPACE, ("ball.vx", "spring.fx")),
        (SCENE.replace("name: Pushed", r'name: "a <b> & \x9b \"c\" \u202e \ufffe"'), ()),
    ],
)  # fmt: skip
def test_the_model_description_is_valid(tmp_path, text, outputs):
    from fmpy.validation import validate_fmu

    (tmp_path / "model.yaml").write_text(text, encoding="utf-8")
    stiffmbs.build_fmu(tmp_path / "model.yaml", tmp_path / "model.fmu", outputs)
    assert validate_fmu(str(tmp_path / "model.fmu")) == []


NAMES = (
    "class", "a b", "1st", "-x", "ünïcode", "日本", "SceneSlave", "hold", "...", "x" * 200, "a'b\"c", "a\nb", "None", "\u202ex", "import.os",
)  # fmt: skip
STARTS = """
import json, os, sys
from fmpy import simulate_fmu
print(json.dumps([float(simulate_fmu(path, stop_time=0.01, step_size=0.01)["where"][0]) for path in sys.argv[1:]]), flush=True)
os._exit(0)  # at exit, PythonFMU 0.7.0 deletes a static object after its destructor: "free(): corrupted unsorted chunks"
"""


@pytest.mark.long
def test_a_scene_may_have_any_name(tmp_path):
    paths = [tmp_path / f"x{k}.fmu" for k in range(len(NAMES))]
    for k, (name, path) in enumerate(zip(NAMES, paths, strict=True)):
        scene = tmp_path / f"{name}.yaml"
        scene.write_text(
            SCENE.replace("[-3, 0]", f"[{-3 - k}, 0]").replace(
                "requests: {where: sled.x", f"requests: {{where: sled.x + {k}"
            )
        )
        stiffmbs.build_fmu(scene, path)
    done = subprocess.run([sys.executable, "-c", STARTS, *map(str, paths)], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr[-2000:]
    np.testing.assert_allclose(json.loads(done.stdout.splitlines()[-1]), range(len(NAMES)), atol=1e-12)
