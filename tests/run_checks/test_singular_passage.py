"""A slider on a turning guide, whose line passes the guide's hinge: the nearer it does, the less is known of what follows."""

import itertools
from pathlib import Path

import numpy as np
import pytest

import stiffmbs
from stiffmbs.run_checks.singular_poses import deepest_dips
from tests.stress.families.structure.singular_passages import four_bar

NOTE = "passes a singular pose near t = 0."


def slider(miss: float) -> stiffmbs.Scene:
    """The slider moves along y = `miss` at 2 m/s, from 1 m before the guide's hinge in the origin on."""
    return stiffmbs.read_scene(f"""
        gravity: [0, 0]
        bodies:
          guide: {{mass: 1, inertia: 0.5, position: [0, 0], angle: 0}}
          slider: {{mass: 1, inertia: 0.2, position: [-1, {miss}], angle: 0, velocity: [2, 0]}}
        joints:
          hinge: {{type: revolute, i: guide, j: ground}}
          rail: {{type: prismatic, i: slider, j: guide}}
          line: {{type: equation, zero: slider.y - {miss}}}
        forces:
          push: {{type: torque, i: guide, torque: 1}}
    """)


@pytest.mark.parametrize("solver", ["bdf", "projected"])
def test_a_branch_that_rounding_chooses_is_told(solver):
    solution = stiffmbs.run(slider(1e-11), duration=1.0, points=200, solver=solver)
    assert any(NOTE in note and "hinge" in note and "slider at" in note for note in solution.notes)


@pytest.mark.parametrize("solver", ["bdf", "projected"])
def test_a_swing_that_is_resolved_is_not(solver):
    solution = stiffmbs.run(slider(0.05), duration=1.0, points=200, solver=solver, rtol=1e-8)
    assert solution.success and not any("singular pose near" in note for note in solution.notes)


@pytest.mark.parametrize("points", [41, 401])
@pytest.mark.parametrize("solver", ["bdf", "projected"])
def test_a_pose_between_two_outputs_is_seen(solver, points):
    """A kite whose flat pose the motion crosses, whatever its branch, far faster than the outputs show."""
    solution = stiffmbs.run(four_bar(1.0 + 1e-9, 0.5), duration=0.5, points=points, solver=solver)
    (note,) = [note for note in solution.notes if "singular pose" in note]
    assert "more than one motion may follow" in note and "a, b, c and d" in note


def test_a_passage_that_a_smaller_rtol_resolves_is_told_as_such():
    notes = [stiffmbs.run(slider(1e-4), duration=1.0, points=101, rtol=rtol).notes for rtol in (1e-6, 1e-10)]
    assert any("errors grow by a factor of about" in note and "use a smaller rtol" in note for note in notes[0])
    assert not any("singular pose near" in note for note in notes[1])


def test_dips_are_seen_from_outputs_on_both_sides():
    t = np.linspace(0, 1, 60)
    passed = 2 * np.log(np.abs(np.sin(3 * (t - 0.4242))))  # the det goes as the square of the distance from the pose
    assert deepest_dips(passed) == [int(np.argmin(passed))]
    assert deepest_dips(np.log(1 + 0.5 * np.cos(9 * t))) == []
    passed[20] = np.nan
    assert deepest_dips(passed)[-1] in (20, int(np.nanargmin(passed)))


@pytest.mark.long
def test_a_look_that_is_cut_short_is_told():
    """A law that fails in the second run alone, which looks at the passage."""
    calls, last = itertools.count(), [10**9]

    def nothing(x):
        if next(calls) == last[0]:
            raise KeyboardInterrupt
        return 0.0 * x[0], 0.0, 0.0

    model = four_bar(1.0 + 1e-9, 0.5)
    model.add("law", stiffmbs.PythonForce(i="rocker", of=("rocker.x",), function=nothing))
    assert any("singular pose" in note for note in stiffmbs.run(model, duration=0.5, points=101, errors=False).notes)
    total = next(calls)
    told = []
    for before_the_end in (100, 300, 600):
        last[0] = next(calls) + total - before_the_end
        solution = stiffmbs.run(model, duration=0.5, points=101, errors=False)
        assert solution.success
        told += [note for note in solution.notes if "a singular pose near" in note]
    assert len(told) == 3 and any("may pass" in note and "aborted" in note for note in told)


FOLDING = Path(__file__).parents[1] / "data" / "folding_cv_joint.yaml"
"""A constant-velocity joint that folds at 0.561 s; b1.wx(0.6 s) is 5.162."""


@pytest.mark.long
def test_radau_passes_a_singular_pose_at_tolerances_near_rounding():
    """Newton's remainder stayed below the rounding of the near-singular equations: 55 774 steps at 3e-11, 600 000 at 1e-11."""
    found = stiffmbs.run(
        stiffmbs.load_scene(FOLDING), solver="radau", rtol=3e-11, duration=0.6, points=25, errors=False
    )
    assert found["b1.wx"][-1] == pytest.approx(5.162, abs=1e-3)
    assert any("passes a singular pose near t = 0.56125 s" in note for note in found.notes)
    assert found.solver["steps"] < 20_000


@pytest.mark.parametrize("scheme", ["dop853", "dopri5"])
def test_explicit_steps_stop_at_the_pose_or_pass_it_on_the_same_branch(scheme):
    """At the scene's own tolerance; they had continued on other branches, without a note."""
    found = stiffmbs.run(
        stiffmbs.load_scene(FOLDING), solver="projected", scheme=scheme, duration=0.6, points=25, errors=False
    )
    if found.success:
        assert found["b1.wx"][-1] == pytest.approx(5.162, abs=1e-3)
    else:
        assert "the motion may branch there" in found.message and "'j1'" in found.message
