"""Loads of bushings in their own axes, with peaks over load cases."""

import json

import numpy as np
import pytest
from click.testing import CliRunner

import stiffmbs
from stiffmbs.commands.main import main
from stiffmbs.errors import InputError

SCENE = """
dimensions: 3
gravity: [0, 0, -10]
parameters: {push: 0 N/s}
bodies:
  block: {mass: 2, inertia: [1, 1, 1]}
forces:
  hold:
    type: bushing
    i: {body: block, orientation: {x: [0, 1, 0], z: [0, 0, 1]}}
    j: {body: ground, orientation: {x: [0, 1, 0], z: [0, 0, 1]}}
    stiffness: [1e5, 1e5, 1e5, 1e3, 1e3, 1e3]
  shove: {type: force, i: block, force: [push*t, 0, 0]}
start: equilibrium
run: {duration: 1 s, points: 11}
"""


def runs():
    cases = {"rest": [], "pushed": [("push", "50 N/s")]}
    return {name: stiffmbs.quasi_static(stiffmbs.read_scene(SCENE, changes)) for name, changes in cases.items()}


@pytest.mark.long
def test_peaks_are_along_the_axes_of_the_bushing():
    """x of the ground is minus y of a bushing that is turned by 90 degrees: it pushes back by as much."""
    found = stiffmbs.road_loads(stiffmbs.read_scene(SCENE), runs())
    peaks = {peak.component: peak for peak in found.peaks["hold"]}
    assert peaks["fz"].value == pytest.approx(20)
    assert (peaks["fy"].value, peaks["fy"].time, peaks["fy"].case) == (pytest.approx(50), 1.0, "pushed")
    assert abs(peaks["fx"].value) < 1e-6
    assert np.max(np.abs(found.loads["rest"]["hold.fy"])) < 1e-6


def test_a_run_of_another_model_is_refused():
    other = stiffmbs.read_scene(SCENE.replace("hold:", "held:"))
    with pytest.raises(InputError, match=r"rest: found no channel 'held\.fx', expected a run of this model"):
        stiffmbs.road_loads(other, runs())
    with pytest.raises(InputError, match="found 0 load cases"):
        stiffmbs.road_loads(other, {})


@pytest.mark.long
def test_the_command_tells_time_and_case(tmp_path):
    scene = tmp_path / "block.yaml"
    scene.write_text(SCENE)
    given = ["loads", str(scene), "--case", "still=push=0 N/s", "--case", "pushed=push=50 N/s,run.duration=0.5"]
    found = json.loads(CliRunner().invoke(main, [*given, "--json"]).output)
    assert found["status"] == "done"
    assert found["loads"]["hold"]["fy"]["case"] == "pushed"
    assert "pushed" in CliRunner().invoke(main, given).output
    assert CliRunner().invoke(main, ["loads", str(scene), "--case", "still"]).exit_code == 2
