"""Each parameter of a table is measured by what it decides: the decision moves if the parameter is halved or doubled.

These parameters are read by Python alone, so that nothing is compiled; the others are in `test_parameter_counts`.
"""

from __future__ import annotations

from functools import cache
from types import SimpleNamespace
from unittest.mock import patch

import numpy as np
import pytest

import stiffmbs
from stiffmbs import tuning
from stiffmbs.analyses.job import prepare
from stiffmbs.errors import SolverError
from stiffmbs.model.settings import RunSettings
from stiffmbs.solve import cost, kinematic
from stiffmbs.solve.error_control.precision import governed_by_rounding, too_fine
from stiffmbs.solve.error_control.relaxation import drift_of_positions, drift_of_velocities, refuse_drift
from stiffmbs.solve.error_control.stability_limit import (
    STABILITY_LIMIT,
    CubicFit,
    StabilityLimitDetection,
    limits_steps,
)
from stiffmbs.solve.events.chattering import Chattering
from stiffmbs.solve.events.discontinuity import Jumps
from stiffmbs.solve.events.narrow_inputs import hidden_peak
from stiffmbs.solve.events.refusals import exponential, refuse_beyond_sense
from stiffmbs.solve.events.restart import straight_on
from stiffmbs.solve.ida.native.parameters import LOOP
from stiffmbs.solve.linear_solvers.block_lu import BlockLU
from stiffmbs.solve.linear_solvers.linear_solver import COSTS
from stiffmbs.solve.linear_solvers.sparse_lu import SparseLU
from stiffmbs.solve.radau.native import newton as stages
from stiffmbs.solve.radau.parameters import RADAU
from stiffmbs.solve.trajectory import Rows, unwatched
from stiffmbs.sparse.elimination_order import EliminationOrder
from tests.parameters import EXAMPLES, SCENES, changed


def count_while(holds, values):
    """Return how many values at the beginning hold."""
    return next((k for k, value in enumerate(values) if not holds(value)), len(values))


HALVES = 2.0 ** (-0.25 * np.arange(400))
DOUBLES = 1 / HALVES


@cache
def job_of(name):
    scene = stiffmbs.read_scene(SCENES[name]) if name in SCENES else stiffmbs.load_scene(EXAMPLES / f"{name}.yaml")
    return prepare(scene)


def raised(call):
    try:
        call()
    except SolverError:
        return True
    return False


def saved_by_blocks(rods):
    """Return the time that blocks save in a chain of rods, ns."""
    n = 10 * rods
    order = EliminationOrder(np.arange(n), fill=10 * n, updates=100 * n)
    nothing = np.empty(0, dtype=np.int64)
    pattern = n, nothing, nothing, order
    return SparseLU(*pattern).cost - BlockLU(*pattern, [nothing] * (3 * rods), nothing).cost - COSTS.worth_compiling


def longest_chain_in_blocks():
    return count_while(lambda rods: saved_by_blocks(rods) > 0.0, range(5, 5000))


def shortest_chain_in_blocks():
    return count_while(lambda rods: saved_by_blocks(rods) <= 0.0, range(5000))


def limited(distance, third=0.0):
    return limits_steps(CubicFit(distance, third), tuning.parameters_of(STABILITY_LIMIT))


def detection():
    found = StabilityLimitDetection(None, RunSettings(duration=1.0, rtol=1e-6))
    found.__dict__["_atol"] = np.array([1e-6])
    return found


def next_check_after(wave):
    """Return the steps to the next check after samples of a wave of a height in tolerances."""
    found, k = detection(), np.arange(LOOP.samples)
    found.begin(0.0, 0)
    found.changed(np.column_stack([1.0 + k, 1e-6 * wave * (-1.0) ** k]), 10_000)
    return found.wait(10_000)


def finest_rtol(place, value):
    """Return the number of quarter octaves of tolerances that a coordinate's rounding allows."""
    job = job_of("cart_pendulum")
    q = np.zeros(len(job.start.q))
    q[place] = value
    return count_while(
        lambda rtol: not too_fine(job.dynamics, job.settings.model_copy(update={"rtol": rtol}), 0.0, q), HALVES
    )


def smallest_velocity_jump():
    job = job_of("cart_pendulum")
    state = job.dynamics.state
    state.u[:] = 1.0 / Jumps(job.dynamics, job.settings).resolution[0]

    def is_noted(size):
        jumps = Jumps(job.dynamics, job.settings)
        jumps.note(0.0, state.q, state.u - size * (np.arange(len(state.u)) == 0))
        return bool(jumps.sentence())

    return count_while(is_noted, HALVES)


def highest_power():
    """Return the tenths of the power of time up to which a growth is no exponential one."""
    t = np.linspace(0.0, 1.0, 20_001)
    return count_while(lambda tenths: not exponential(t, t ** (0.1 * tenths)), range(1, 400))


def largest_growth():
    job = job_of("narrow")

    def is_allowed(size):
        rows = Rows(len(job.start.q), len(job.start.u), 1001)
        for t in np.linspace(0.0, 1.0, 1001):
            rows.append(t, job.start.q + size * np.exp(40.0 * (t - 1.0)), job.start.u)
        return not raised(lambda: refuse_beyond_sense(job.dynamics, rows, 1.0, job.start.q + size, job.start.u))

    return count_while(is_allowed, DOUBLES[:100])


def largest_drift():
    job = job_of("cart_pendulum")
    way = np.ones(len(job.start.u))
    return count_while(
        lambda size: not raised(lambda: refuse_drift(job.dynamics, 0.0, job.start.q, 1e-6 * size * way, job.settings)),
        DOUBLES,
    )


def longest_chain_without_less_relaxation():
    settings = RunSettings(duration=1.0)
    creep = [drift_of_velocities(settings, SimpleNamespace(bodies=range(n))) for n in range(1, 500)]
    return count_while(lambda each: each == creep[0], creep)


def relaxation_at_a_loose_tolerance():
    loose, usual = (drift_of_positions(RunSettings(duration=1.0, rtol=rtol)) for rtol in (0.1, 1e-8))
    return round(loose / usual)


def watched(end=1.0, rtol=1e-6):
    job = job_of("sliding")
    return job, Chattering(job.dynamics, end, rtol)


def steps_to_a_rate():
    """Return the steps, in units of 50 000, after which a run without progress is stopped."""
    job = job_of("narrow")
    monitor = Chattering(job.dynamics, 1e6, 1e-6)
    state = job.start.q, job.start.u
    return count_while(lambda k: not raised(lambda: monitor.look(1e-9 * k, *state, 50_000 * k)), range(1, 100))


def longest_run_at_a_rate():
    """Return the duration, in quarter octaves of 1 s, of a run whose last million steps have covered 1 s."""
    job = job_of("narrow")

    def is_allowed(end):
        monitor = Chattering(job.dynamics, end + 1.0, 1e-6)
        monitor.look(0.0, job.start.q, job.start.u, 0)
        return not raised(lambda: monitor.look(1.0, job.start.q, job.start.u, 1_000_000))

    return count_while(is_allowed, DOUBLES[:100])


def events_to_a_rate():
    """Return the number of events, in fast succession, after which a run is stopped."""
    job, monitor = watched()
    return count_while(
        lambda k: not raised(lambda: monitor.note_event(1e-9 * k, lambda: (job.start.q, job.start.u), 0)), range(5000)
    )


def longest_run_with_events():
    """Return the duration, in quarter octaves of 1 us, of a run with an event each us."""

    def is_allowed(end):
        job, monitor = watched(1e-6 * end)
        return not any(
            raised(lambda t=1e-6 * k: monitor.note_event(t, lambda: (job.start.q, job.start.u), 0)) for k in range(1600)
        )

    return count_while(is_allowed, DOUBLES[40:140])


def expected_events(steady, power):
    """Return the events that a monitor expects after 1000, of whose rate the power is known."""
    _, monitor = watched(steady)
    monitor._count, monitor._events = 1000, [0.0]
    window = (monitor._events, tuning.defaults_of("chattering").window)[1]
    ratio = ((1000 - 0.5 * window) / (1000 - 1.5 * window)) ** power
    return monitor._to_come(window * ratio, window)


def fewest_events_that_grow():
    return count_while(lambda steady: expected_events(steady, 1.0) == pytest.approx(steady), DOUBLES)


def powers_of_growth(first):
    """Return the tenths of the first power, or of the first above 1, that is of another kind than the one before."""
    grows = [expected_events(1e5, 0.1 * tenths) > 2e5 for tenths in range(1, 100)]
    return count_while(lambda each: not each, grows) if first else count_while(bool, grows[10:])


def reach(rtol):
    return watched(rtol=rtol)[1]._reaches[1]


def part_after_a_failure():
    """Return the part of a step of radau that follows one whose stages are not finite."""
    x = SimpleNamespace(newton=1.0, rtol=1e-6, after_failure=RADAU.after_failure)
    with patch.object(stages, "_residuals", lambda *_: False):
        stages.iterated(x, SimpleNamespace(stages=3), 0.0, 1.0)
    return x.suggested


def kinematic_steps():
    job = prepare(stiffmbs.load_scene(EXAMPLES / "crank_slider.yaml"), solver="kinematic", duration=3.0, points=2)
    return kinematic.solve(job.dynamics, job.start, job.grid, job.settings, unwatched).statistics["steps"]


def explicit_cost():
    return cost.of_explicit_step(job_of("andrews").dynamics)


def implicit_cost(part):
    return getattr(cost.ImplicitCost.of(job_of("andrews").dynamics), part)


def rejections_by_rounding():
    """Return the rejected steps of 100 000, in hundreds, up to which rounding does not govern a run."""
    return count_while(
        lambda hundreds: not governed_by_rounding({"steps": 100_000, "rejected": 100 * hundreds}), range(1000)
    )


def highest_hidden_peak():
    """Return the height of a peak between output times, in thousandths of the change of the input, up to which it is left out."""
    times = np.linspace(0.0, 1.0, 11)
    features = SimpleNamespace(breakpoints=np.array([0.55]), instants=lambda *_: np.empty(0))

    def is_left_out(thousandths):
        height = 1.0 / (1.0 - 1e-3 * thousandths)
        pulse = SimpleNamespace(text="f", at=lambda t: np.where(t == 0.55, height, np.clip(2.0 * t, 0.0, 1.0)))
        return not hidden_peak([pulse], features, times)

    return count_while(is_left_out, range(1, 500))


TABLE = {
    "linear_solver": {
        **dict.fromkeys(["sparse", "blocks", "cached_nodes", "far_node"], longest_chain_in_blocks),
        "worth_compiling": shortest_chain_in_blocks,
    },
    "stability_limit": {
        "least_distance": lambda: count_while(lambda d: limited(10.0 * d), HALVES),
        "negligible": lambda: count_while(lambda d: limited(10.0 * d), DOUBLES),
        "gain": lambda: count_while(lambda third: limited(20.0, third), DOUBLES * 1e-6),
        "gain_if_faint": lambda: count_while(lambda third: limited(1.0, third), DOUBLES * 1e-6),
        "step_error": lambda: count_while(lambda third: limited(20.0, third), DOUBLES * 1e-6),
        "faint": lambda: count_while(lambda d: limited(d, 300.0), DOUBLES),
        "interval": lambda: detection().wait(0),
        "growth": lambda: next_check_after(0.0),
        "damping_steps": lambda: next_check_after(1.0),
    },
    "precision": {
        "noise_of_positions": lambda: finest_rtol(0, 1e6),
        "noise_of_angles": lambda: finest_rtol(2, 1e4),
        "failed": rejections_by_rounding,
    },
    "narrow_inputs": {"hidden": highest_hidden_peak},
    "cost": {
        **dict.fromkeys(["explicit_step", "explicit_operation", "explicit_equation"], explicit_cost),
        "multiplication": lambda: cost._of_elimination(5_000),
        **dict.fromkeys(["large_blocks", "large_block_multiplication"], lambda: cost._of_elimination(20_000)),
        **dict.fromkeys(["residual", "residual_unknown"], lambda: implicit_cost("residual")),
        **dict.fromkeys(["matrix_operation", "matrix_solver", "least_solver"], lambda: implicit_cost("matrix")),
        **dict.fromkeys(["step_residuals", "step_matrices"], lambda: implicit_cost("step")),
        **dict.fromkeys(["start", "start_unknown"], lambda: implicit_cost("memory")),
        "start_steps": lambda: implicit_cost("start_steps"),
    },
    "velocity_jumps": {"least": smallest_velocity_jump},
    "divergence": {"fraction": highest_power, "faster": highest_power, "unbounded": largest_growth},
    "relaxation": {
        "short_chain": longest_chain_without_less_relaxation,
        "largest_factor": relaxation_at_a_loose_tolerance,
        "refused": largest_drift,
    },
    "chattering": {
        "window": events_to_a_rate,
        "too_many": longest_run_with_events,
        "at_least": fewest_events_that_grow,
        "least_power": lambda: powers_of_growth(True),
        "largest_power": lambda: powers_of_growth(False),
        "steps_seen": steps_to_a_rate,
        "steps_ahead": longest_run_at_a_rate,
        "stays_within": lambda: reach(1e-5),
        "stays_within_at_most": lambda: reach(1.0),
    },
    "jumps": {"larger_move": lambda: reach(1e-12)},
    "restarts": {
        "hidden": lambda: straight_on(1.0, 0.0, 1e-6),
        "passed": lambda: straight_on(0.0, 1.0, 1e-6),
        "largest_rtol": lambda: straight_on(0.0, 1.0, 0.1),
    },
    "radau": {"after_failure": part_after_a_failure},
    "kinematic": {"surprise": kinematic_steps},
}  # fmt: skip
"""What each parameter decides, as a number."""

EXPECTED = {
    "linear_solver.sparse": 1119, "linear_solver.blocks": 1119, "linear_solver.cached_nodes": 1119, "linear_solver.far_node": 1119,
    "linear_solver.worth_compiling": 2,
    "stability_limit.least_distance": 18, "stability_limit.negligible": 16, "stability_limit.gain": 105, "stability_limit.gain_if_faint": 117,
    "stability_limit.step_error": 105, "stability_limit.faint": 8, "stability_limit.interval": 2000, "stability_limit.growth": 5000, "stability_limit.damping_steps": 100,
    "precision.noise_of_positions": 119, "precision.noise_of_angles": 121, "precision.failed": 201, "narrow_inputs.hidden": 50, "velocity_jumps.least": 27,
    "cost.explicit_step": 7.058, "cost.explicit_operation": 7.058, "cost.explicit_equation": 7.058, "cost.multiplication": 35,
    "cost.large_blocks": 94, "cost.large_block_multiplication": 94, "cost.residual": 1.4142, "cost.residual_unknown": 1.4142,
    "cost.matrix_operation": 7.27106, "cost.matrix_solver": 7.27106, "cost.least_solver": 7.27106,
    "cost.step_residuals": 3.575512, "cost.step_matrices": 3.575512, "cost.start": 537, "cost.start_unknown": 537, "cost.start_steps": 10,
    "divergence.fraction": 50, "divergence.faster": 50, "divergence.unbounded": 54,
    "relaxation.short_chain": 100, "relaxation.largest_factor": 1000, "relaxation.refused": 80,
    "chattering.window": 749, "chattering.too_many": 40, "chattering.at_least": 54, "chattering.least_power": 7, "chattering.largest_power": 10,
    "chattering.steps_seen": 10, "chattering.steps_ahead": 31, "chattering.stays_within": 0.01, "chattering.stays_within_at_most": 0.1, "jumps.larger_move": 1e-6,
    "restarts.hidden": 1e-11, "restarts.passed": 1e-8, "restarts.largest_rtol": 1e-6, "radau.after_failure": 0.5, "kinematic.surprise": 104,
}  # fmt: skip
"""The decisions of the default parameters."""
PARAMETERS = [(name, field) for name, fields in TABLE.items() for field in fields]


@pytest.mark.parametrize(("name", "field"), PARAMETERS)
def test_a_decision_moves_if_its_parameter_is_halved_or_doubled(name, field):
    measure, expected = TABLE[name][field], EXPECTED[f"{name}.{field}"]
    assert measure() == pytest.approx(expected, rel=1e-6)
    default = tuning.numbers_of(tuning.defaults_of(name))[field]
    parts = range(len(default)) if isinstance(default, tuple) else [None]
    for part in parts:
        for factor in (0.5, 2.0):
            value = changed(default if part is None else default[part], factor)
            other = value if part is None else (*default[:part], value, *default[part + 1 :])
            with tuning.in_use({name: {field: other}}):
                assert measure() != pytest.approx(expected, rel=0.01)
