"""Runs whose relaxed constraints creep are taken again with exact ones."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import stiffmbs
from stiffmbs.analyses import rerun
from stiffmbs.analyses.job import prepare
from stiffmbs.analyses.run import solved
from stiffmbs.elements.planar_kinds import FORCES
from stiffmbs.errors import SolverError
from stiffmbs.solve.trajectory import Outcome
from stiffmbs.studies import simulation
from tests.stress.families.structure.large_multipliers import barely_held, pulled, swing_error
from tests.stress.mechanisms.pendulum import bar_rate, swing

HOW = {"duration": 2.0, "points": 101, "rtol": 1e-7}
CREEP = "constraint drift (formulation SI2)"


@pytest.mark.parametrize("model", [pulled(1e6), pulled(1e8), barely_held(1e-3)], ids=["1e6 N", "1e8 N", "slope 1e-3"])
def test_a_pendulum_under_huge_multipliers_swings_by_its_closed_form_and_the_run_says_how(model):
    solution = stiffmbs.run(model, **HOW)
    assert swing_error(solution) < 20 * HOW["rtol"]
    assert any(CREEP in note and "repeated with formulation SI2_exact" in note for note in solution.notes)


def test_nothing_is_taken_again_where_multipliers_are_as_large_as_weights():
    solution = stiffmbs.run(pulled(1e3), **HOW)
    assert swing_error(solution) < 20 * HOW["rtol"]
    assert not any(CREEP in note for note in solution.notes)


def test_a_run_that_exact_constraints_do_not_bring_as_far_is_kept_and_doubted(monkeypatch):
    job = prepare(pulled(1e6), **HOW)
    monkeypatch.setattr(rerun, "exactly", lambda job: replace(job, grid=replace(job.grid, times=job.grid.times[:2])))
    solution = solved(job)
    assert len(solution.t) == 101
    assert any(
        "the results may be wrong by this amount, and formulation SI2_exact stopped earlier" in note
        for note in solution.notes
    )


def test_an_interrupted_run_is_not_taken_again():
    def interrupt(t: float) -> None:
        raise KeyboardInterrupt

    solution = solved(prepare(pulled(1e6), **HOW), interrupt)
    assert solution.outcome is Outcome.INTERRUPTED
    assert any(CREEP in note and note.endswith("the results may be wrong by this amount") for note in solution.notes)


@pytest.mark.long
@pytest.mark.parametrize("restarted", [False, True])
def test_steps_of_a_simulation_go_on_with_exact_constraints(restarted):
    model = pulled(1e6)
    model.add("nudge", FORCES["torque"](i="bar", j="ground", torque=0.0))
    simulation = stiffmbs.simulation(model, inputs={"forces.nudge.torque": 0.0}, rtol=1e-7, duration=2.0)
    times, angles = 0.02 * np.arange(1, 101), []
    for number in range(100):
        simulation.step(0.02, inputs={"forces.nudge.torque": 1e-12 * (number % 2)} if restarted else None)
        angles.append(simulation["bar.angle"])
    assert np.max(np.abs(np.array(angles) + np.pi / 2 - swing(times, np.pi / 2, bar_rate(1.0)))) < 2e-6


def test_a_simulation_goes_back_to_relaxed_constraints_where_exact_ones_end(monkeypatch):
    """As they may in a singular pose; here they are made to."""
    made = simulation.stepper_of

    def ending(job, start, t):
        stepper = made(job, start, t)
        if job.settings.formulation == "SI2_exact":
            advance = stepper.advance

            def up_to_a_second(end):
                if end > 1.0:
                    raise SolverError("a singular pose")
                advance(end)

            monkeypatch.setattr(stepper, "advance", up_to_a_second)
        return stepper

    monkeypatch.setattr(simulation, "stepper_of", ending)
    steps, formulations = stiffmbs.simulation(pulled(1e6), rtol=1e-7, duration=2.0), []
    for _ in range(100):
        steps.step(0.02)
        formulations.append(steps._relaxed)
    assert not any(formulations[:49])
    assert formulations[50]
    expected = swing(np.array([2.0]), np.pi / 2, bar_rate(1.0))[0]
    assert steps["bar.angle"] + np.pi / 2 == pytest.approx(expected, abs=1e-4)
