"""Explicit steps that follow rounding alone are told, or left to bdf; others are not taken for such."""

from dataclasses import replace

import pytest

import stiffmbs
from stiffmbs.solve.explicit import rounding
from stiffmbs.solve.trajectory import Outcome
from stiffmbs.tuning import parameters_of
from tests.stress.families.structure.large_multipliers import nearly_repeated, swing_error

HOW = {"duration": 2.0, "points": 101, "rtol": 1e-7}


@pytest.mark.long
def test_steps_that_rounding_shortens_are_told_by_the_explicit_integrator():
    solution = stiffmbs.run(nearly_repeated(1e-7), solver="projected", scheme="dop853", **HOW)
    assert solution.outcome is Outcome.STOPPED
    assert "rounding errors limit the steps" in solution.message and "changes block.ax by" in solution.message
    assert solution.message.endswith("or solver bdf")


@pytest.mark.long
@pytest.mark.sampled(5)
@pytest.mark.parametrize("slope", [3e-8, 5e-8])
@pytest.mark.parametrize("rtol", [3e-7, 5e-7, 1e-6])
def test_auto_leaves_them_to_implicit_steps(slope, rtol):
    """Most of these runs stopped where no step of radau succeeded, which bdf passes."""
    solution = stiffmbs.run(nearly_repeated(slope), solver="auto", duration=2.0, points=101, rtol=rtol, errors=False)
    assert solution.outcome is Outcome.DONE and solution.solver["name"] in ("bdf", "radau")
    assert swing_error(solution) < 1e-4
    assert slope > 3e-8 or any("bdf, because no step of radau succeeds at t = " in note for note in solution.notes)


@pytest.mark.parametrize("scene", ["andrews", "elastic_bearing", "vehicles/half_car_at_rest", "stick_slip"])
@pytest.mark.parametrize("rtol", [1e-6, 1e-10])
def test_no_other_steps_are_taken_for_such(examples, scene, rtol, monkeypatch):
    monkeypatch.setattr(rounding, "CONTROL", replace(parameters_of(rounding.CONTROL), enough_steps=50))
    monkeypatch.setattr(rounding, "CHATTERING", replace(parameters_of(rounding.CHATTERING), too_many=0.0))
    solution = stiffmbs.run(examples / f"{scene}.yaml", solver="projected", scheme="dop853", duration=0.05, rtol=rtol)
    assert solution.outcome is Outcome.DONE
