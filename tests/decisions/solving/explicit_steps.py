"""Decisions of explicit steps and of the kinematic solver."""

from __future__ import annotations

from unittest.mock import patch

import numpy as np
import pytest

import stiffmbs
from stiffmbs.analyses.job import prepare
from stiffmbs.compile.inputs.features import NO_FEATURES
from stiffmbs.model.settings import RunSettings
from stiffmbs.solve import kinematic
from stiffmbs.solve.driven_states import IntegratedMotion
from stiffmbs.solve.explicit import adaptive, fixed, rounding, stable_step
from stiffmbs.solve.explicit.native import (
    attempt,
    explicit_events,
    fastest_rate,
    interpolant,
    linearly_implicit,
    runge_kutta,
)  # fmt: skip
from stiffmbs.solve.explicit.native import start as explicit_start
from stiffmbs.solve.explicit.schemes import RK4
from stiffmbs.solve.trajectory import Grid
from tests.decisions.common import Reached, Record, always, never, nothing, parameters, searched
from tests.interpreted import interpreted
from tests.parameters import EXAMPLES
from tests.solve.test_parameter_thresholds import DOUBLES, HALVES, count_while


def stepping(**fields):
    """Return the record of explicit steps with one unknown."""
    usual = {
        "n": 1, "n_q": 0, "t": 0.0, "t_before": 0.0, "h": 1.0, "span": 1.0, "longest": np.inf, "stable": 0.0, "shortest": 1e-12, "atol": np.full(1, 1e-3),
        "rtol": 0.0, "y": np.ones(1), "y_before": np.zeros(1), "y_stage": np.ones(1), "k": np.ones(3), "weight": np.ones(1), "difference": np.zeros(1),
        "steps": 1, "stiff_steps": 0, "far_beyond": 0, "rejected": 0, "repeats": 1.0, "last_error": 0.0, "uncertain": 0, "measured": 0,
        "distance": np.inf, "distance_of_end": np.inf, "pivots_tell": 0, "eliminates": 1, "eliminated": None,
        "dense_ready": 0, "signs": np.zeros(1), "watch": searched(), "step_bound": Record(n=0),
    }  # fmt: skip
    return Record(**{**usual, **fields})


def scheme(**fields):
    return Record(
        **{
            "stages": 1,
            "exponent": 0.125,
            "memory": 0.0,
            "stability": 1.0,
            "order": 8,
            "n_errors": 2,
            "free_error": None,
            **fields,
        }
    )


LOCATED = {
    "load_state": nothing, "switches": lambda *_: np.full(1, -1.0), "located": lambda *_: 0.5, "_signs_change": always,
}  # fmt: skip
"""Functions with an event in the middle of a step."""


def factor_after_a_rejection(exponent):
    """Return the factor of a step to an event that is not reached."""
    lengths = []
    replaced = {
        **LOCATED, "_taken_to_change": lambda *_: explicit_events.RETRIED, "_gone_back": lambda x, c, h: lengths.append(h),
    }  # fmt: skip
    with interpreted(explicit_events, **replaced):
        explicit_events.ended_at_event(stepping(), scheme(exponent=exponent), None, None)
    return lengths[0]


def distance_beyond_an_event():
    found = []
    with interpreted(explicit_events, **LOCATED, _taken_to_change=lambda *given: found.append(given[-1]) or -1):
        explicit_events.ended_at_event(stepping(), scheme(), None, None)
    return found[0]


def steps_to_an_event():
    count = []
    replaced = {
        "prepare": nothing, "load_state": nothing, "switches": nothing, "changes": always,
        "_has_changed": always, "retaken": lambda *_: count.append(1) or 0,
    }  # fmt: skip
    with interpreted(explicit_events, **replaced):
        explicit_events._taken_to_change(stepping(), scheme(), None, None, 1.0, 1.0, 0.1)
    return len(count)


def fastest_stable_rate():
    """Return the rate, in tenths of the stability limit, up to which a step is not far beyond it."""

    def is_near(tenths):
        x = stepping(k=np.array([0.0, 0.1 * tenths]), y=np.ones(1), y_stage=np.zeros(1))
        runge_kutta._watch_stiffness(x, scheme(), 1.0)
        return x.far_beyond == 0

    with interpreted():
        return count_while(is_near, range(1, 200))


def limited_fraction():
    """Return the limited steps of 1000 up to which a long run is not given up."""
    return count_while(
        lambda k: not runge_kutta._is_hopeless(stepping(stiff_steps=k, steps=1000, h=1e-12), 1.0), range(1000)
    )


def largest_number_of_steps():
    """Return the number of steps, in quarter octaves of 1, up to which a run limited by stability is not given up."""
    return count_while(lambda end: not runge_kutta._is_hopeless(stepping(stiff_steps=1), end), DOUBLES)


def worst_free_interpolant():
    """Return the error of an interpolant, in hundredths of a tolerance, up to which it needs no further stages."""

    def serves(hundredths):
        def add(x, target, *_):
            target[0] = 0.01 * hundredths

        with interpreted(interpolant, add_stages=add, _is_fast=never):
            return interpolant._free_serves(stepping(), scheme(), 1.0)

    return count_while(serves, range(1, 400))


def largest_terms_of_stages():
    """Return the terms of stages, in quarter octaves of those of the ends, up to which an interpolant is valid."""

    def sound(ratio):
        return interpolant._sound(stepping(polynomial=np.array([100.0, 0.0, 0.0, 100.0 * ratio])), 4) == 4

    return count_while(sound, DOUBLES[:100])


def first_length(y=1.0, rate=1.0):
    x = stepping(y=np.full(1, y), k=np.full(2, rate))
    with interpreted(explicit_start, go_straight=nothing, rates=lambda *_: -1):
        return explicit_start.first_step(x, scheme(), None, None, 1.0)


def smallest_state_that_determines_a_step():
    """Return the size of a state, in quarter octaves of a tolerance, down to which it determines the first step."""
    return count_while(lambda size: first_length(1e-3 * size) != 1e-6, HALVES)


def uncertain(kept, rate):
    x = stepping(
        pivots_tell=1,
        eliminated=Record(kept=kept, most_kept=1.0, n_scales=0, pivot_scale=(), largest_scale=()),
        k=np.array([0.0, rate]),
    )
    return attempt.uncertain_end(x, scheme(), 1.0, attempt.distance_of_end(x))


def largest_uncertain_pivot():
    """Return the thousandths of the largest pivot up to which the end of a step is checked."""
    with interpreted():
        return count_while(lambda k: uncertain(1e-3 * k, 1e30), range(1, 200))


def largest_harmless_change():
    """Return the velocity change by rounding, in thousandths of a tolerance, up to which a step may end."""
    with interpreted():
        return count_while(lambda k: not uncertain(1e-4, 1e-3 * k * 1e-6 / attempt.EPSILON), range(1, 500))


def step_before_a_bifurcation():
    answers = [True, False]
    replaced = {
        "_depart": nothing, "attempt": nothing, "trusted_error": lambda *_: 0.5, "arrive": nothing,
        "uncertain_end": lambda *_: answers.pop(0), "_watch_stiffness": nothing,
    }  # fmt: skip
    x = stepping()
    with interpreted(runge_kutta, **replaced):
        runge_kutta._step(x, scheme(), None, None, 1e9)
    return x.span


def nearest_end():
    """Return the relative distance from a singular pose, in quarter octaves of 1e-7, up to which no step ends."""

    def turns(distance):
        replaced = {
            "_depart": nothing, "attempt": nothing, "trusted_error": lambda *_: 0.5, "arrive": nothing,
            "distance_of_end": lambda _: distance, "uncertain_end": never, "_watch_stiffness": nothing,
        }  # fmt: skip
        with interpreted(runge_kutta, **replaced):
            return runge_kutta._step(stepping(), scheme(), None, None, 1e9) == runge_kutta.SINGULAR

    return count_while(turns, 1e-7 * DOUBLES)


def changes_of_velocities():
    """Return the changes of a velocity by which accelerations are differentiated."""
    found, s = [], Record(u=np.zeros(1), q=np.zeros(1), n_u=1, n_q=1)

    def accelerated(t, target, *_):
        found.append(abs(float(s.u[0])))
        target[0] = -1e3 * s.u[0]
        return 0

    with interpreted(fastest_rate, _accelerated=accelerated):
        fastest_rate._growth(0.0, 0, np.ones(1), np.zeros(5), s, None, None)
    return found


def look_for_rounding():
    """Return the number of places and the length over which the elimination is compared with the LU, for steps of 1 s."""
    check, asked = rounding.Rounding(Record(forget_pivots=lambda **_: None), 1e-6, 0.0, 1.0), []
    check._along = lambda work, span, count: asked.extend((count, span)) or iter(())
    check._loses_digits(Record(u=np.zeros(1)), 1.0)
    return asked


def jumps_along_a_line(accelerations):
    """Return the size of repeated jumps among accelerations, and the number of places."""
    count = []
    dynamics = Record(accelerate=lambda k: (0, np.array([accelerations(k)])))
    check = rounding.Rounding(dynamics, 1e-6, 0.0, 1.0)
    check._along = lambda work, span, places: count.append(places) or iter(range(places))
    return float(check._jumps(Record(u=np.zeros(1)), 1.0)[0]), count[0]


def jumps_of_a_law():
    """Return the number of breakpoints of a law up to which its jumps are not those of rounding."""

    def steps_at(n):
        return lambda k: float(min(k // 6, n))

    return count_while(lambda n: jumps_along_a_line(steps_at(n))[0] == 0.0, range(1, 10))


def smallest_rounding():
    """Return the size of alternating accelerations, in quarter octaves, down to which they are jumps."""
    return count_while(lambda size: jumps_along_a_line(lambda k: 1.0 + size * (-1.0) ** k)[0] > 0.0, HALVES)


def checks_of_fixed_steps():
    count = []
    dynamics = Record(input_features=lambda *_: NO_FEATURES)
    work = Record(q=np.zeros(1), u=np.zeros(1), at=0, scheme=RK4, unresolved=np.nan)
    settings = RunSettings(duration=1.0)
    jumps = Record(sentence=lambda: "")
    with patch.multiple(
        fixed,
        refuse_beyond_limits=nothing,
        _jumps=lambda *_: count.append(1) and "",
        Jumps=lambda *_: jumps,
        FIXED_STEPS=Record(call=lambda *_: 0),
    ):
        fixed.solve_with_fixed_steps(dynamics, work, Grid(0.0, 1.0, np.linspace(0.0, 1.0, 1001)), settings, nothing)
    return len(count)


def shortest_step():
    """Return the shortest step of a prescribed motion of 1 s."""
    found = []

    def motion(dynamics, start, t, shortest, features):
        found.append(shortest)
        raise Reached

    job = prepare(stiffmbs.load_scene(EXAMPLES / "crank_slider.yaml"), solver="kinematic", duration=1.0, points=2)
    with patch.object(kinematic, "_Motion", motion), pytest.raises(Reached):
        kinematic.solve(job.dynamics, job.start, job.grid, job.settings, nothing)
    return found[0]


def tolerance_of_a_prescribed_motion():
    found = []

    def solve_ivp(*_, rtol, **__):
        found.append(rtol)
        raise Reached

    with patch("scipy.integrate.solve_ivp", solve_ivp), pytest.raises(Reached):
        IntegratedMotion.go_to(Record(t=0.0, q=np.zeros(1), _rates=None, _longest=1.0), 1.0)
    return found[0]


def largest_change_of_velocity():
    """Return the change of a velocity, in hundredths of the velocity before, up to which a prescribed step is accepted."""

    def is_accepted(hundredths):
        state = Record(q=np.zeros(1), u=np.ones(1))

        def correct(t):
            state.u[:] = 1.0 + 0.01 * hundredths
            return 0

        system = Record(of_body=Record(moved=lambda q, step: q + step))
        motion = Record(
            _dynamics=Record(state=state, system=system, assemble=nothing, correct_velocities=correct), q=np.zeros(1), u=np.ones(1),
            a=np.zeros(1), _turns=np.zeros(1), _counters=slice(0, 0), _turning=np.empty(0), _near=always, _take=always,
            _parameters=parameters("kinematic"), steps=0, moves=0,
        )  # fmt: skip
        return kinematic._Motion._step(motion, 1.0, 1.0)

    return count_while(is_accepted, range(1, 1000))


def stable():
    return stable_step.StableStep(Record(stability=1.0, order=8), None)


def lowest_order_with_a_bound():
    return count_while(
        lambda order: not stable_step.StableStep(Record(stability=1.0, order=order), None)._serves, range(40)
    )


def next_checks_of_a_bound(waits):
    """Return the steps to the last of some checks of a bound."""
    found = stable()
    work = Record(count=lambda name: 0)
    for _ in range(waits):
        found._wait(work)
    return found._next


def fewest_steps_with_a_bound():
    """Return the number of remaining steps up to which no bound is computed."""

    def is_left_out(count):
        asked = []
        work = Record(stable=0.0, h=1.0, t=0.0, count=nothing, q=np.zeros(1), u=np.zeros(1))
        with patch.object(stable_step, "rates_at", lambda *_: asked.append(1) or Record(fastest=0.0)):
            stable().ask(work, float(count))
        return not asked

    return count_while(is_left_out, range(1000))


def is_unresolved(part):
    """Return True if a negative work of a part of the sizes in it is that of a growth."""
    table, state = Record(x=np.array([1.0, 1.0]), b=np.array([1.0, -1.0 - part])), Record(n_q=2, n_pose=2, n_u=2)
    return linearly_implicit._is_unresolved(table, state, Record(n=2))


def steps_to_an_early_check(most):
    """Return the steps limited by stability after which a run of `auto` checks whether implicit steps are to follow."""
    return adaptive.AdaptiveSteps._looks(Record(work=Record(count=lambda name: 0), _may_leave=True), most)[1]


DECISIONS = {
    "linearly_implicit_steps.noise": lambda: count_while(lambda part: not is_unresolved(1e-9 * part), DOUBLES),
    "explicit_checks.now_and_then": lambda: steps_to_an_early_check(800),
    "explicit_ends.close": largest_uncertain_pivot,
    "explicit_ends.harmful": largest_harmless_change,
    "explicit_ends.shorter": step_before_a_bifurcation,
    "explicit_ends.turning": nearest_end,
    "explicit_events.beyond": distance_beyond_an_event,
    "explicit_events.most_retaken": steps_to_an_event,
    "explicit_first_step.part": first_length,
    "explicit_first_step.short": lambda: first_length(0.0),
    "explicit_first_step.small": smallest_state_that_determines_a_step,
    "explicit_rounding.few": lambda: look_for_rounding()[0],
    "explicit_rounding.within": lambda: look_for_rounding()[1],
    "explicit_rounding.instants": lambda: jumps_along_a_line(float)[1],
    "explicit_rounding.jumps": jumps_of_a_law,
    "explicit_rounding.part": smallest_rounding,
    "explicit_steps.safety": lambda: runge_kutta._factor(stepping(), scheme(), 1.0),
    "explicit_steps.smallest_error": lambda: runge_kutta._factor(stepping(), scheme(memory=0.5), 1.0),
    "explicit_steps.largest_factor": lambda: runge_kutta._factor(stepping(), scheme(), 0.0),
    "explicit_steps.least_factor": lambda: factor_after_a_rejection(2.0),
    "explicit_steps.untrusted": lambda: factor_after_a_rejection(0.125),
    "explicit_steps.far_beyond": fastest_stable_rate,
    "explicit_steps.stiff_part": limited_fraction,
    "explicit_steps.too_many_steps": largest_number_of_steps,
    "explicit_steps.hardly_off": worst_free_interpolant,
    "explicit_steps.astray": largest_terms_of_stages,
    "explicit_steps.shortest": shortest_step,
    "fastest_rate.iterations": lambda: len(changes_of_velocities()),
    "fastest_rate.move": lambda: changes_of_velocities()[0],
    "fixed_steps.checks": checks_of_fixed_steps,
    "kinematic.tolerance": tolerance_of_a_prescribed_motion,
    "kinematic.change": largest_change_of_velocity,
    "stability_bound.soon": lambda: next_checks_of_a_bound(1),
    "stability_bound.most_apart": lambda: next_checks_of_a_bound(5),
    "stability_bound.held_back": lambda: stable()._left(Record(count=lambda name: 0)),
    "stability_bound.worth": fewest_steps_with_a_bound,
    "stability_bound.steep": lowest_order_with_a_bound,
}  # fmt: skip
"""Decision of each parameter: ``subsystem.field``, or ``module:NAME``."""
EXPECTED = {
    "linearly_implicit_steps.noise": 44,
    "explicit_checks.now_and_then": 100, "explicit_ends.close": 10, "explicit_ends.harmful": 30, "explicit_ends.shorter": 0.55, "explicit_ends.turning": 27,
    "explicit_events.beyond": 1e-10, "explicit_events.most_retaken": 8, "explicit_first_step.part": 0.01, "explicit_first_step.short": 1e-06,
    "explicit_first_step.small": 67, "explicit_rounding.few": 4, "explicit_rounding.within": 0.01,
    "explicit_rounding.instants": 64, "explicit_rounding.jumps": 3, "explicit_rounding.part": 48, "explicit_steps.safety": 0.9,
    "explicit_steps.smallest_error": 0.009, "explicit_steps.largest_factor": 10, "explicit_steps.least_factor": 0.2,
    "explicit_steps.untrusted": 0.3795268531, "explicit_steps.far_beyond": 20, "explicit_steps.stiff_part": 101, "explicit_steps.too_many_steps": 120,
    "explicit_steps.hardly_off": 30, "explicit_steps.astray": 27, "explicit_steps.shortest": 1e-12, "fastest_rate.iterations": 5,
    "fastest_rate.move": 1e-07, "fixed_steps.checks": 50, "kinematic.tolerance": 1e-11, "kinematic.change": 100, "stability_bound.soon": 8,
    "stability_bound.most_apart": 512, "stability_bound.held_back": 16, "stability_bound.worth": 128, "stability_bound.steep": 8,
}  # fmt: skip
"""The decisions of the default parameters."""
