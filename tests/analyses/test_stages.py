"""Scenes that are run in stages."""

import json

import numpy as np
import pytest
from click.testing import CliRunner

import stiffmbs
from stiffmbs.commands.main import main
from stiffmbs.model.files.stages import merge_patch, merged

THROWN = """
name: a bar that is let go
gravity: [0, -10]
bodies:
  bar: {mass: 2, inertia: 0.5, position: [1, 0], markers: {end: {point: [-1, 0]}}}
joints:
  hinge: {type: revolute, i: bar.end, j: ground}
requests: {carried: hinge.fy}
run: {rtol: 1e-9}
stages:
  - {analysis: static}
  - {change: {gravity: [10, 0]}, run: {duration: 0.5, output: 0.25}}
  - {change: {joints: {hinge: null}, requests: null}, run: {duration: 1, points: 3}}
"""


def test_a_stage_starts_where_the_one_before_it_ends():
    found = stiffmbs.run(stiffmbs.read_scene(THROWN))
    np.testing.assert_allclose(found.time, [0, 0, 0.25, 0.5, 0.5, 1, 1.5])
    assert found["bar.y"][0] == pytest.approx(-1) and found["hinge.fy"][0] == pytest.approx(20)
    t, flown = found.time[4:] - 0.5, slice(4, None)
    for name, pull in (("x", 10), ("y", 0)):
        start, speed = found[f"bar.{name}"][4], found[f"bar.v{name}"][4]
        np.testing.assert_allclose(found[f"bar.{name}"][flown], start + speed * t + pull * t**2 / 2, atol=1e-6)
    assert found["bar.omega"][4] == found["bar.omega"][6]
    assert not np.any(found["hinge.fx"][flown]) and np.all(np.isnan(found["carried"][flown]))
    kinetic = 10 * 2 * found["bar.x"][3]  # what gravity has done since the equilibrium at x = 0
    assert found["energy.kinetic"][3] == pytest.approx(kinetic, rel=1e-6)


def test_the_whole_is_checked_and_followed_from_the_command_line(tmp_path):
    (tmp_path / "scene.yaml").write_text(THROWN)
    checked = CliRunner().invoke(main, ["check", str(tmp_path / "scene.yaml"), "--json"])
    assert json.loads(checked.output)["messages"][-1] == "stage 3 of 3: 3 degrees of freedom"
    ran = CliRunner().invoke(main, ["run", str(tmp_path / "scene.yaml"), "--json", "--set", "bodies.bar.mass=4"])
    report = json.loads(ran.output)
    assert report["time"] == {"start": 0, "end": 1.5} and report["channels"]["hinge.fy"]["first"] == pytest.approx(40)


def test_a_stage_that_fails_is_named_and_what_was_found_before_it_is_kept():
    falling = THROWN.replace("duration: 1, points: 3", "duration: 1, points: 3, solver: kinematic")
    with pytest.raises(stiffmbs.InputError, match="stage 3 of 3: kinematic"):
        stiffmbs.run(stiffmbs.read_scene(falling))


@pytest.mark.parametrize(
    "change, words",
    [
        (("run.duration", "3"), "--set run.duration: found a scene with stages"),
        (("bodies.bar.mass", "-1"), "bodies.bar.mass: found -1"),
    ],
)
def test_changes_that_make_no_sense_are_refused(change, words):
    with pytest.raises(stiffmbs.InputError, match=words):
        stiffmbs.read_scene(THROWN, [change])


def test_a_stage_that_keeps_a_request_of_a_joint_that_it_removes_gets_a_hint():
    scene = THROWN.replace("hinge: null}, requests: null", "hinge: null}")
    with pytest.raises(
        stiffmbs.InputError, match=r"requests\.carried: .*: the stage removes 'hinge', so its change must also"
    ):
        stiffmbs.read_scene(scene)


def test_other_jobs_refuse_a_scene_with_stages():
    scene = stiffmbs.read_scene(THROWN)
    for job in (stiffmbs.modes, stiffmbs.equilibrium, stiffmbs.verify):
        with pytest.raises(stiffmbs.InputError, match="found a scene with stages, which only `run` accepts"):
            job(scene)
    with pytest.raises(stiffmbs.InputError, match="found duration for a scene with stages"):
        stiffmbs.run(scene, duration=3)


def test_a_stage_with_other_bodies_is_refused():
    with pytest.raises(stiffmbs.InputError, match=r"stage 2 of 3: .*found no state of body 'other'"):
        stiffmbs.run(
            stiffmbs.read_scene(
                THROWN.replace("gravity: [10, 0]", "bodies: {other: {mass: 1, inertia: 1, position: [0, 9]}}")
            )
        )


def test_merge_patches():
    old = {"a": {"b": 1, "c": [1, 2]}, "d": 4}
    new = {"a": {"c": [1], "e": {"f": 2}}, "g": 5}
    assert merged(old, merge_patch(old, new)) == new
    assert merge_patch(old, old) == {}
    assert merged({"a": 1}, {"a": {"b": None, "c": 2}}) == {"a": {"c": 2}}
