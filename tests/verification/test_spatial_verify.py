"""Verified runs, reports and changed forces of scenes in space: what is said of motions in the plane is said here too."""

from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

import stiffmbs
from stiffmbs.analyses import rerun
from stiffmbs.analyses.job import prepare
from stiffmbs.analyses.renumber import with_numbers
from stiffmbs.commands.main import main
from stiffmbs.compile.machine.native.statuses import NO_BALANCE
from stiffmbs.dynamics.dynamics import Dynamics

from ..conftest import EXAMPLES


def nearly_a_parallelogram():
    """Two cranks and a rod on a ball and a sleeve, a micron too long: a loose tolerance doesn't see it at the flat pose."""
    return stiffmbs.read_scene(
        """
        dimensions: 3
        parameters: {L: 1 m}
        gravity: [0, -9.81, 0]
        bodies:
          crank{k}:
            for: k in 0..1
            mass: 1
            inertia: [1/12, 1/12, 1/12]
            position: [k*L, L/2, 0]
            orientation: {x: [0, 1, 0], z: [0, 0, 1]}
            velocity: [0.5, 0, 0]
            omega: [0, 0, -1]
            markers: {foot: {point: [-L/2, 0, 0]}, head: {point: [L/2, 0, 0]}}
          rod:
            mass: 1
            inertia: [1/12, 1/12, 1/12]
            position: [L/2, L, 0]
            velocity: [1, 0, 0]
            markers: {left: {point: [-L/2, 0, 0]}, right: {point: [L/2 + 1e-6, 0, 0]}}
        joints:
          foot{k}: {for: k in 0..1, type: revolute, i: "crank{k}.foot", j: {body: ground, point: [k*L, 0, 0]}}
          ball: {type: spherical, i: rod.left, j: crank0.head}
          sleeve: {type: cylindrical, i: rod.right, j: crank1.head}
        run: {duration: 3 s, rtol: 1e-5}
        """
    )


@pytest.mark.long
def test_another_branch_is_told_with_time_and_poses(monkeypatch):
    monkeypatch.setattr(rerun, "DRIFTED", np.inf)  # exact constraints see the micron at any tolerance
    found = stiffmbs.verify(nearly_a_parallelogram())
    (told,) = [note for note in found.notes if "another branch" in note]
    upright = 1 - 2 * (found["crank0.q1"] ** 2 + found["crank0.q3"] ** 2)
    flat = found.time[np.argmax(np.abs(1 - upright**2) > 0.99)]
    assert float(told.split("at t = ")[1].split(" s")[0]) == pytest.approx(0.708, abs=0.1), flat
    for part in ("singular", "crank0 at quaternion (", "ball", "Remedy"):
        assert part in told


def double_pendulum():
    """On balls: it tumbles in all directions."""
    return stiffmbs.read_scene(
        """
        dimensions: 3
        gravity: [0, 0, -9.81]
        bodies:
          upper: {mass: 1, inertia: [0.02, 1/12, 1/12], position: [0.5, 0, 0], omega: [3, 0, 1]}
          lower: {mass: 1, inertia: [0.02, 1/12, 1/12], position: [1, 0, 0.5], orientation: {x: [0, 0, 1]}}
        joints:
          top: {type: spherical, i: {body: upper, point: [-0.5, 0, 0]}, j: ground}
          middle: {type: spherical, i: {body: upper, point: [0.5, 0, 0]}, j: {body: lower, point: [-0.5, 0, 0]}}
        run: {duration: 40 s, points: 2001, rtol: 1e-6}
        """
    )


@pytest.mark.long
def test_a_chaotic_motion_is_told_with_the_time_from_which_it_is_not_known():
    scene = double_pendulum()
    found = stiffmbs.verify(scene)
    (told,) = [note for note in found.notes if "chaotic" in note]
    parted = float(told.split("from t = ")[1].split(" s")[0])
    exact = stiffmbs.run(scene, solver="projected", scheme="dop853", rtol=1e-12)
    apart = np.linalg.norm([found[f"lower.{axis}"] - exact[f"lower.{axis}"] for axis in "xyz"], axis=0)
    assert np.all(apart[found.time < parted - 1] < 0.2)
    assert np.max(apart[(found.time > parted) & (found.time < parted + 3)]) > 0.1


@pytest.mark.long
def test_a_body_that_only_turns_parts_by_its_orientation():
    """Let go next to the separatrix, Dzhanibekov's body turns over sooner or later by the errors of a loose tolerance."""
    scene = stiffmbs.load_scene(EXAMPLES / "dzhanibekov.yaml", [("bodies.nut.omega", "[0, 4, 1e-9]")])
    found = stiffmbs.verify(scene, rtol=1e-4)
    (told,) = [note for note in found.notes if "from t =" in note]
    assert "nut differs" in told
    assert np.all(found["nut.x"] == 0)


def driven():
    """A weight on a driven hinge, whose turns are counted."""
    return stiffmbs.read_scene(
        """
        dimensions: 3
        bodies:
          arm: {mass: 1, inertia: [0.1, 0.1, 0.1], position: [1, 0, 0]}
          bob: {mass: 1, inertia: [0.1, 0.1, 0.1], position: [2, 0, 0]}
        joints:
          pin: {type: revolute, i: {body: arm, point: [-1, 0, 0]}, j: ground}
          ball: {type: spherical, i: {body: bob, point: [-0.5, 0, 0]}, j: {body: arm, point: [0.5, 0, 0]}}
          motor: {type: drive, joint: pin, position: 20*t^2}
        """
    )


@pytest.mark.long
def test_an_instant_without_reactions_keeps_its_pose(monkeypatch):
    report = Dynamics.report

    def up_to_half_a_second(self, t, q, u, project):
        count = int(np.argmax([*(abs(instant - 0.5) < 1e-9 for instant in t), True]))
        found = report(self, t[:count], q[:count], u[:count], project)
        return found if count == len(t) else replace(found, status=NO_BALANCE)

    monkeypatch.setattr(Dynamics, "report", up_to_half_a_second)
    for scene, body, force in (
        (stiffmbs.load_scene(EXAMPLES / "heavy_top.yaml"), "top", "tip.fz"),
        (driven(), "arm", "pin.fx"),
    ):
        found = stiffmbs.run(scene, duration=1.0, points=11, rtol=1e-4)
        assert list(np.flatnonzero(np.isnan(found[force]))) == [5]
        length = np.sqrt(sum(found[f"{body}.q{k}"] ** 2 for k in range(4)))
        assert np.max(np.abs(length - 1)) < 1e-14


def sprung():
    """A plate on a ball, held by two springs."""
    return stiffmbs.read_scene(
        """
        dimensions: 3
        gravity: [0, 0, -9.81]
        bodies:
          plate: {mass: 2, inertia: [0.1, 0.12, 0.2], position: [0.3, 0, 0], omega: [1, 0, 2]}
        joints:
          ball: {type: spherical, i: {body: plate, point: [-0.3, 0, 0]}, j: ground}
        forces:
          long: {type: spring_damper, i: {body: plate, point: [0.2, 0.1, 0]}, j: {body: ground, point: [0.5, 0, 1]},
                 stiffness: 50, free_length: 0.8, damping: 0.2}
          short: {type: spring_damper, i: {body: plate, point: [0, -0.1, 0]}, j: {body: ground, point: [0.3, -1, 0]},
                  stiffness: 20, free_length: 0.5}
        run: {duration: 1, points: 51, rtol: 1e-8}
        """
    )


def test_a_spring_changed_in_place_moves_as_one_given_at_first():
    scene = sprung()
    job = prepare(scene)
    before = job.integrate().q.copy()
    for name, numbers in (("long", {"stiffness": 90.0}), ("short", {"stiffness": 35.0, "free_length": 0.4})):
        job = with_numbers(job, name, **numbers)
    stiffer = scene.forces["long"].model_copy(update={"stiffness": 90.0})
    shorter = scene.forces["short"].model_copy(update={"stiffness": 35.0, "free_length": 0.4})
    expected = prepare(scene.model_copy(update={"forces": {"long": stiffer, "short": shorter}}))
    np.testing.assert_array_equal(job.integrate().q, expected.integrate().q)
    assert np.max(np.abs(job.integrate().q - before)) > 0.01


@pytest.mark.long
def test_a_report_holds_channels_units_and_figures_of_space(tmp_path):
    pytest.importorskip("jinja2")
    pytest.importorskip("matplotlib")
    path = tmp_path / "top.html"
    result = CliRunner().invoke(
        main, ["report", str(EXAMPLES / "heavy_top.yaml"), "-o", str(path), "--duration", "0.5"]
    )
    assert result.exit_code == 0, result.output
    rows = {row.split("</td>")[0].split(">")[-1]: row for row in path.read_text(encoding="utf-8").split("<tr>")}
    for channel, unit in (
        ("top.z", "m"),
        ("top.wx", "rad/s"),
        ("top.wdz", "rad/s^2"),
        ("tip.fz", "N"),
        ("tip.tx", "N m"),
    ):
        assert f"<td>{unit}</td>" in rows[channel], rows[channel]
    assert "±" in rows["top.q1"]
