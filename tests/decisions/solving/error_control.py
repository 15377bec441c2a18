"""Decisions of Newton's iteration of bdf, of polished output and of error estimates."""

from __future__ import annotations

from unittest.mock import patch

import numpy as np

from stiffmbs.compile.machine.native.statuses import NORM_TABLE, OPERATIONS
from stiffmbs.model.settings import RunSettings
from stiffmbs.solve import integrator
from stiffmbs.solve.error_control.relaxation import drift_of_positions, drift_of_velocities
from stiffmbs.solve.error_control.tolerances import absolute_tolerances
from stiffmbs.solve.ida import native_engine
from stiffmbs.solve.ida.native import error_norm, iteration, output_correction, start
from stiffmbs.solve.ida.starts import newton_bounds, polishing_bounds
from stiffmbs.solve.trajectory import Grid
from tests.decisions.common import Record, always, nothing
from tests.interpreted import interpreted
from tests.solve.test_parameter_thresholds import DOUBLES, count_while


def iterating(**fields):
    """Return the record of an iteration with one unknown."""
    usual = {
        "n": 1, "array_of": lambda vector: vector, "iteration_of": nothing, "cj_of": nothing, "memory": 0, "done": 1, "cj": 1.0, "age": 0,
        "first": 1.0, "by_cj": 0.0, "growth": 0.0, "span": 1.0, "since": 0, "slow": 0, "given_up": 0, "matrix_cj": 1.0, "has_kinks": 0,
    }  # fmt: skip
    return Record(**{**usual, **fields})


def largest_rate(holds):
    """Return the rate of convergence, in thousandths, up to which a condition holds for the record after a correction."""

    def after(thousandths):
        c = iterating()
        return holds(iteration._later(c, 1e-3 * thousandths, 1e9), c)

    return count_while(after, range(1, 1100))


def residual_of_a_short_step():
    """Return the size of a correction, in quarter octaves of 1e-6 tolerances, with which an iteration ends at cj = 1000/s."""

    def ends(size):
        c = iterating(cj=1000.0, first=2.0 * size)
        return iteration.converged(0, 0, [size], 1e-3, [1.0], c) == iteration.SETTLED

    with interpreted():
        return count_while(ends, 1e-6 * DOUBLES)


def corrections_that_are_predicted():
    """Return the tolerance, in quarter octaves, up to which a slow iteration with an old matrix is given up."""

    def given_up(enough):
        return iteration._later(iterating(age=1, first=2.0), 1.0, enough) == iteration.GIVE_UP

    return count_while(given_up, 1e-3 * DOUBLES)


def attributed_to_age():
    c = iterating(age=1, by_cj=0.5)
    iteration._later(c, 0.5, 1.0)
    return c.growth


def eased(newton, failures=1000, steps=1000):
    """Return the Newton tolerance after a call with a number of failures."""
    begun = [newton]
    counted = {"steps": steps, "convergence_failures": failures}
    ida = Record(counters=Record(total=lambda: counted), usual_steps=0)
    engine = Record(
        ida=ida, _counted={"steps": 0, "convergence_failures": 0}, _newton=newton, _resume=begun.append,
    )  # fmt: skip
    native_engine.NativeEngine._ease_newton(engine)
    return begun[-1]


def tolerance(of_positions, rtol=1e-6):
    w = Record(**newton_bounds(rtol, None), of_positions=of_positions, of_velocities=0.0, newton=0.0)
    start.allow_remainder(w)
    return w.newton


def long_step(of_positions):
    return start._long_step(Record(**polishing_bounds(1e-6), of_positions=of_positions, of_velocities=0.0))


def corrections(ratio):
    """Return the number of corrections of a state that remains unbalanced."""
    sizes = iter(ratio ** np.arange(100))
    count = []
    replaced = {
        "_corrected": lambda *_: count.append(1) or next(sizes),
        "_look": nothing,
        "_is_balanced": lambda *_: False,
    }
    with interpreted(output_correction, **replaced):
        output_correction._remaining(Record(enough=0.0, factored=1.0), None, None, 0.0, False)
    return len(count)


def largest_rounded_off_imbalance():
    """Return the imbalance, in quarter octaves, up to which corrections that become no smaller have converged."""

    def converges(part):
        replaced = {
            "_corrected_by": always, "_factored": always, "_remaining": lambda *_: 1e-3, "_left": lambda *_: 1e3 * part,
        }  # fmt: skip
        with interpreted(output_correction, **replaced):
            return output_correction._by_new_factors(Record(current=1.0, balanced=1e-3), None, None, 0.0, 1.0)

    return count_while(converges, 1e-6 * DOUBLES[:200])


def steps_at_an_event():
    """Return the product of the factors by which the matrices at an event are those of shorter steps."""
    factors, imbalance = [], iter([3.0, 2.0])
    replaced = {
        "_placed": always, "_factored": lambda b, s, e, t, cj: factors.append(cj) or True, "_corrected": nothing, "_look": nothing,
        "_left": lambda *_: next(imbalance),
    }  # fmt: skip
    with interpreted(output_correction, **replaced):
        assert output_correction._without_spurious_forces(Record(current=1.0), None, None, 0.0)
    return np.prod(factors)


def filtering(failures=0, steps=1, order=1, trouble=0.0):
    """Return the record of the error norm after a number of failures and steps."""
    c = Record(
        iteration=Record(cj=1.0), looked=0.0, steps=steps, failures=failures, known_steps=0, known_failures=0, order=order, trouble=trouble,
        until=0, equal_until=0, memory=0, steps_of=nothing, failures_of=nothing, order_of=nothing, set_growth=nothing,
    )  # fmt: skip
    with interpreted():
        error_norm._look(c)
    return c


def largest_filtered_norm():
    """Return the norm, in quarter octaves of 1e9, up to which a vector is an error estimate."""

    def is_estimate(size):

        def norm(vector, weights):
            return size if vector == "filtered" else 0.0

        c = Record(
            iteration=Record(cj=1.0), looked=1.0, equal_until=0, always=1, steps=0, until=0, repeats=1.0, part_before_event=0, norm=norm, at_filtered="filtered",
        )  # fmt: skip
        return error_norm.error_norm({OPERATIONS: {NORM_TABLE: c}}, None) > 0.0

    with interpreted(error_norm, _filtered=always):
        return count_while(is_estimate, 1e9 * DOUBLES[:100])


def first_check(module, name, check, counts):
    """Return how many numbers of steps pass before a run of bdf makes a check of a module for the first time."""

    def unchecked(steps):
        made = []
        with patch.object(module, name, lambda *_: made.append(1)):
            check(Record(steps=lambda: steps, statistics=dict))
        return not made

    return count_while(unchecked, counts)


def at_a_step(engine):
    """Let an engine judge its steps."""
    reached = Record(t=0.0, state=lambda: (np.zeros(1), np.zeros(1)), failure="")
    engine._failure, engine._dynamics, engine._settings = lambda *_: "", None, None
    native_engine.NativeEngine.refuse(engine, reached, Grid(0.0, 1.0, None))


def in_a_run(engine):
    """Integrate to one step of an engine."""
    row = np.zeros((1, 1))
    reached = Record(times=np.zeros(1), rows=(row, row), t=0.0, state=lambda: (row[0], row[0]))
    more = {
        "last_step": nothing, "history": nothing, "recorded": tuple, "refuse": nothing, "whole_steps": nothing,
        "watch": Record(departures=nothing, refuse_departures=nothing),
    }  # fmt: skip
    for each, value in more.items():
        setattr(engine, each, value)
    job = Record(system=Record(n_q=1, n_u=1))
    run = Record(dynamics=job, run=lambda *_, **__: [reached], engine=engine, statistics=dict, note=str)
    integrator.integrated(run, Record(q=np.zeros(1), u=np.zeros(1)), Grid(0.0, 1.0, None), nothing)


def steps_that_rounding_governs():
    """Return the thousands of steps up to which a run is not checked for a tolerance below rounding."""

    def engine(n):
        return Record(steps=lambda: 1000 * n, statistics=dict, _dynamics=None, _settings=None)

    reached = Record(state=lambda: (np.zeros(1), np.zeros(1)), failure="", t=0.0)
    grid = Grid(0.0, 1.0, None)
    with patch.multiple(native_engine, governed_by_rounding=always, too_fine=lambda *_: "too fine"):
        return count_while(lambda n: not native_engine.NativeEngine._failure(engine(n), reached, grid), range(100))


def tolerance_of_a_counter():

    def ones(*sizes):
        return np.ones(2)

    system = Record(
        size=1.0, per_coordinate=ones, per_velocity=ones, n_pose=1, first_state=2, n_q=2, state_scales=np.ones(0)
    )
    return absolute_tolerances(system, RunSettings(duration=1.0))[1]


DECISIONS = {
    "newton.loosest": lambda: tolerance(0.0),
    "newton.soft": lambda: tolerance(1.5e7),
    "newton.negligible": lambda: tolerance(1e20, 1e-2),
    "newton.precision": lambda: tolerance(1e20, 1e-10),
    "newton.unknown": lambda: iteration._left(2.0, 1.0),
    "newton.diverging": lambda: largest_rate(lambda verdict, c: verdict == iteration.SETTLED),
    "newton.slowest": lambda: largest_rate(lambda verdict, c: c.slow == 0),
    "newton.trusted": lambda: count_while(lambda k: iteration._predicted(iterating(age=1, since=k)) < 1.0, range(100)),
    "newton.least": attributed_to_age,
    "newton.last": corrections_that_are_predicted,
    "newton.long_steps": residual_of_a_short_step,
    "newton.many_failures": lambda: count_while(lambda k: eased(1e-6, k) == 1e-6, range(1000)),
    "newton.eased": lambda: eased(1e-6),
    "newton.easiest": lambda: eased(0.1),
    "polishing.amplified": lambda: long_step(100.0),
    "polishing.unbalanced": lambda: polishing_bounds(1e-6)["balanced"],
    "polishing.most_corrections": lambda: corrections(0.1),
    "polishing.slowest": lambda: count_while(lambda k: corrections(0.01 * k) > 2, range(1, 100)),
    "polishing.rounded_off": largest_rounded_off_imbalance,
    "polishing.at_events": steps_at_an_event,
    "error_filter.fades_low": lambda: filtering(steps=100, trouble=1.0).trouble,
    "error_filter.fades": lambda: filtering(steps=2, order=3, trouble=1.0).trouble,
    "error_filter.troubled": lambda: count_while(lambda k: filtering(failures=k).until == 0, range(100)),
    "error_filter.lasts": lambda: filtering(failures=100).until,
    "error_filter.no_estimate": largest_filtered_norm,
    "relaxation.of_positions": lambda: drift_of_positions(RunSettings(duration=1.0, rtol=1e-8)),
    "relaxation.of_velocities": lambda: drift_of_velocities(RunSettings(duration=1.0, rtol=1e-8), Record(bodies=[0])),
    "relaxation.check_interval": lambda: first_check(native_engine, "refuse_drift", at_a_step, range(0, 5000, 50)),
    "divergence.followed_steps": lambda: first_check(integrator, "refuse_beyond_sense", in_a_run, range(0, 300_000, 5000)),
    "explicit_steps.enough_steps": steps_that_rounding_governs,
    "solve.error_control.tolerances:WHICH_TURN": tolerance_of_a_counter,
}  # fmt: skip
"""Decision of each parameter: ``subsystem.field``, or ``module:NAME``."""
EXPECTED = {
    "newton.loosest": 0.03, "newton.soft": 0.001, "newton.negligible": 1e-06, "newton.precision": 0.001, "newton.unknown": 20,
    "newton.diverging": 900, "newton.slowest": 100, "newton.trusted": 20, "newton.least": 0.05, "newton.last": 32, "newton.long_steps": 50,
    "newton.many_failures": 201, "newton.eased": 0.0001, "newton.easiest": 0.33, "polishing.amplified": 0.5477225575051661, "polishing.unbalanced": 3e-07,
    "polishing.most_corrections": 8, "polishing.slowest": 29, "polishing.rounded_off": 54, "polishing.at_events": 1e9, "error_filter.fades_low": 0.3660323413, "error_filter.fades": 0.64,
    "error_filter.troubled": 8, "error_filter.lasts": 1001, "error_filter.no_estimate": 40, "relaxation.of_positions": 1e-09,
    "relaxation.of_velocities": 1e-12, "relaxation.check_interval": 20, "divergence.followed_steps": 20, "explicit_steps.enough_steps": 21,
    "solve.error_control.tolerances:WHICH_TURN": 0.001,
}  # fmt: skip
"""The decisions of the default parameters."""
