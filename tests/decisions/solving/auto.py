"""Decisions of auto, and of its cost model."""

from __future__ import annotations

from unittest.mock import patch

import numpy as np

from stiffmbs.solve import auto
from stiffmbs.solve.cost import ImplicitCost
from stiffmbs.solve.radau import radau
from stiffmbs.solve.radau.radau import of_radau
from stiffmbs.solve.trajectory import Outcome, Trajectory
from tests.decisions.common import Record, nothing
from tests.solve.test_parameter_thresholds import count_while


def check_after_steps():
    """Return the steps up to the next check of implicit steps after 1000."""
    waits, counts = [], [0, 0, 1000, 1000]
    engine = Record(ida=Record(pause_after=waits.append))
    engine.steps = lambda: counts.pop(0) if len(counts) > 1 else counts[0]
    implicit = Record(engine=engine, steps=lambda t: Record(time=t), start=0.0, cost=Record(step=1.0))
    run = Record(implicit=implicit, explicit_cost=lambda *_: 0.0, remaining=lambda t: 0.0)
    check = auto.ImplicitCheck(run, 0.0)
    check._begun = 0
    counts[:] = [1000]
    check._wait()
    return waits[-1]


def tolerated_loss():
    """Return the loss of implicit steps that is tolerated, where explicit ones cost 1000."""
    engine = Record(steps=lambda: 0, ida=Record(pause_after=nothing))
    implicit = Record(engine=engine, steps=lambda t: Record(time=t), start=1.0, cost=Record(step=1.0))
    run = Record(implicit=implicit, explicit_cost=lambda *_: 1000.0, remaining=lambda t: 0.0)
    return auto.ImplicitCheck(run, 0.0)._wait()


def switches_in_a_note():
    trajectory = Trajectory(np.zeros(1), np.zeros((1, 1)), np.zeros((1, 1)), Outcome.DONE, "", {})
    run = Record(_messages=["switch"] * 20, _segments=[trajectory])
    return auto._AutoRun._joined(run).note.count("switch")


def mechanism():
    """Return dynamics of 100 unknowns and 6000 operations."""
    none, half = np.zeros(0, dtype=bool), np.ones(50, dtype=bool)
    coordinates = Record(independent=half, independent_u=half, satisfied=none)
    return Record(coordinates=coordinates, system=Record(active=none, n_operations=lambda _: 6000, size=1.0))


def of_five_stages(name):
    return getattr(of_radau(mechanism(), 1.0), name)


def residual_by_which_radau_chooses():
    """Return the cost of a residual, in that of bdf, by which radau chooses the number of stages."""
    costs = []
    replaced = {
        "chosen": lambda _: (None, 1000.0), "natural": nothing, "NativeEngine": nothing, "pair_cost": lambda _: 1.0,
        "Radau": lambda *given: costs.append(given[4]),
    }  # fmt: skip
    with patch.multiple(radau, **replaced):
        radau.driven_by_radau(Record(state=None, **vars(mechanism())), Record(stages=3, rtol=1e-6), None).make()
    return costs[0].residual / ImplicitCost.of(mechanism(), 1.0).residual


DECISIONS = {
    "auto.steps_per_radian": lambda: auto.steps_of_decay(np.e, 1.0, np.inf),
    "auto.trial_margin": lambda: count_while(lambda k: auto.implicit_solver(2.0, 0.1 * k) == "bdf", range(100)),
    "auto.check_interval": check_after_steps,
    "auto.trial_loss": tolerated_loss,
    "cost.restart_steps": lambda: auto._AutoRun.explicit_cost(Record(_explicit_rate=0.0, explicit_step=1.0), 0.0, 1),
    "solve.auto:MOST_MESSAGES": switches_in_a_note,
    "solve.radau.radau:ITERATIONS": lambda: of_five_stages("step_residuals"),
    "solve.radau.radau:START_STEPS": lambda: of_five_stages("start_steps"),
    "solve.radau.radau:RESIDUAL": residual_by_which_radau_chooses,
}  # fmt: skip
"""Decision of each parameter: ``subsystem.field``, or ``module:NAME``."""
EXPECTED = {
    "auto.steps_per_radian": 0.35, "auto.trial_margin": 31, "auto.check_interval": 250, "auto.trial_loss": 50.0, "cost.restart_steps": 27,
    "solve.auto:MOST_MESSAGES": 3, "solve.radau.radau:ITERATIONS": 15, "solve.radau.radau:START_STEPS": 4, "solve.radau.radau:RESIDUAL": 4.0,
}  # fmt: skip
"""The decisions of the default parameters."""
