"""Decisions of Radau methods."""

from __future__ import annotations

from dataclasses import asdict

import numpy as np

from stiffmbs.solve.cost import ImplicitCost
from stiffmbs.solve.radau import collocation
from stiffmbs.solve.radau import memory as radau_memory
from stiffmbs.solve.radau.native import between_steps, error_estimate, interface, newton, steps
from tests.decisions.common import Record, always, nothing, parameters
from tests.interpreted import interpreted
from tests.solve.test_parameter_thresholds import HALVES, count_while


def collocating(**fields):
    """Return the record of a method of three stages with one unknown."""
    usual = {
        **asdict(parameters("radau")), "n": 1, "n_all": 1, "n_tested": 1, "n_closing": 0, "n_efforts": 0, "n_levers": 0, "newton": 0.03, "rtol": 1e-6, "h": 1.0, "t": 0.0,
        "acting": 0, "current": 0, "iterations": 0, "iterations_taken": 3, "suggested": 0.0, "contraction": 0.0, "left": 0.0, "rejected": 0,
        "h_accepted": 1.0, "h_past": 1.0, "last_error": 1.0, "error_size": 1.0, "rate_kept": 0, "since_change": 0, "n_methods": 2, "method": 0,
        "methods": [], "below": [], "error": np.ones(1), "weight": np.ones(1), "z": np.zeros(3), "misfit": np.ones(1), "yp_stage": np.zeros(1),
        "y": np.zeros(1), "y_stage": np.zeros(1), "b": np.zeros(1), "x": np.zeros(1), "d": np.zeros(1), "outputs": 0, "suffice": 0,
        "h_factored": 1.0, "method_past": 0, "output_correction": Record(long=0.0), "y_past": np.zeros(1), "past": np.zeros(3),
    }  # fmt: skip
    return Record(**{**usual, **fields})


METHOD = Record(
    stages=3,
    relaxed=1.0,
    keep=1.0,
    setup_cost=1.0,
    iteration_cost=1.0,
    error=np.zeros(3),
    nodes=[0.2, 0.6, 1.0],
    weights=[0, 1, 0, 0],
)


def iterated(sizes, x=None, **replaced):
    """Return the outcome of an iteration with corrections of given sizes, and its record."""
    x, following = x or collocating(), iter(sizes)
    found = {"_residuals": always, "_corrected": lambda x, c: next(following), "_confirmed": always, **replaced}
    with interpreted(newton, **found):
        return newton.iterated(x, METHOD, 0.0, 1.0), x


def largest_contraction():
    """Return the thousandths above 0.95 of the ratio of corrections up to which an iteration does not diverge."""
    return count_while(lambda k: iterated((0.95 + 1e-3 * k) ** np.arange(9))[0] != newton.DIVERGED, range(50))


def suggested_after_a_slow_iteration():
    return iterated(100.0 * 0.9 ** np.arange(9))[1].suggested


def allowed_later():
    """Return the remainder of a later correction that is confirmed, in that of the second."""
    found = []

    def confirmed(x, c, t, h, size, allowed):
        return found.append(allowed) or False

    iterated(0.1 ** np.arange(1, 10), collocating(acting=1, current=1), _confirmed=confirmed)
    return found[1] / found[0]


def following_step(**fields):
    """Return the length of the step after one of 1 s."""
    x = collocating(**fields)
    with interpreted(steps, _predicted_growth=lambda *_: fields.get("growth", 5.0)):
        steps._choose_next(x, METHOD, 1.0, 1.0, False)
    return x.h


def largest_growth_that_is_kept():
    return count_while(lambda k: following_step(growth=1.0 + 0.01 * k, contraction=0.0) == 1.0, range(400))


def last_error():
    x = collocating(error_size=0.0)
    with interpreted(steps, _predicted_growth=lambda *_: 1.0):
        steps._choose_next(x, METHOD, 1.0, 1.0, False)
    return x.last_error


def steps_to_a_choice():
    x = collocating(methods=[METHOD] * 2, below=[METHOD] * 2)

    def waits(_):
        steps._choose_method(x, METHOD, 1.0)
        return x.since_change > 0

    with interpreted(steps, estimate_below=lambda *_: 1.0, _cost_rate=lambda *_: 1.0):
        return count_while(waits, range(100))


def cost_at_which_stages_change():
    """Return the hundredths of the cost of the present method up to which one with more stages is chosen."""

    def is_chosen(hundredths):
        x = collocating(methods=[METHOD] * 2, below=[METHOD] * 2, since_change=99, error_size=0.5)
        costs = iter([1.0, 0.01 * hundredths])
        with interpreted(steps, estimate_below=lambda *_: 1.0, _cost_rate=lambda *_: next(costs)):
            steps._choose_method(x, METHOD, 1.0)
        return x.method == 1

    return count_while(is_chosen, range(1, 200))


def slowest_coefficients():
    """Return the highest Chebyshev coefficient, in hundredths of the second, up to which a polynomial converges."""

    def converges(hundredths):
        # differences with sum 1 and first moment m: |1| > converging 4 |m|
        m = 100.0 / (4.0 * hundredths)
        first = (1.0 - m) / 0.8
        x = collocating(z=np.array([first, 0.0, 1.0 - first]), x=np.ones(1))
        c = Record(stages=3, weights=[0.0, 1.0, 1.0, 1.0], nodes=[0.2, 0.5, 1.0])
        return error_estimate._unresolved(x, c) == 0.0

    return count_while(converges, range(1, 400))


def relaxed_tolerance():
    c = Record(stages=3, relaxed=0.0)
    interface._relax(collocating(rtol=1.0), c)
    return c.relaxed


def costs_of(name):
    return radau_memory._costs(3, ImplicitCost(1.0, 1.0, 1.0, 1.0, 1.0, 1.0), 1.0, parameters("radau"))[name]


def least_error():
    x = collocating()
    with interpreted(error_estimate, _solved_defect=lambda *_: 0.0):
        return error_estimate._estimate(x, METHOD, 0.0, 1.0, None)


def smallest_correction_between_steps():
    """Return the size of a correction, in quarter octaves of 1e-9/rtol, down to which a state without agreement is open."""

    def is_open(size):
        replaced = {
            "_defects": nothing,
            "solved_real": nothing,
            "add_efforts": nothing,
            "size_in_tolerances": lambda *_: size,
        }
        x = collocating(n_efforts=1, rtol=1.0)
        with interpreted(between_steps, **replaced):
            return between_steps.closed(x, 0.0, np.inf) == between_steps.OPEN

    return count_while(is_open, 1e-9 * HALVES)


def most_moved(within):
    """Return the allowed change of the state at the end of a step, or within it."""
    found = []

    def closed(x, t, most):
        return found.append(most) or between_steps.AGREED

    with interpreted(between_steps, closed=closed, _corrected=nothing):
        if within:
            between_steps._closed_at(collocating(), METHOD, 0.0, 0.5)
        else:
            between_steps.close_end(collocating(), METHOD, 0.0, 1.0)
    return found[0]


def remainder():
    """Return the part of the tolerance that Newton's iteration may leave where no force is stiff."""
    x = collocating(part=0.0)
    with interpreted(interface, radau_view=lambda _: x, ints=lambda at: at):
        interface.set_newton(None, 1.0)
    return x.part


def starts_without_decay():
    """Return the number of replacements of a start whose forces never agree."""
    x = collocating(acting=1, h_past=0.0, n_all=1, n_efforts=0, decaying=0, remainder=0.0, part=0.0, yp=np.zeros(1))
    x.output_correction = Record(long=0.0)
    with interpreted(steps, closed=lambda *_: steps.CLOSED, output_correction_view=lambda at: at, copied=nothing):
        steps._choose_unknowns(x)
        x.acting = 1
        return count_while(lambda _: steps._removes_decay(x, METHOD), range(100))


DECISIONS = {
    "radau.tolerance": relaxed_tolerance,
    "radau.least_factor": lambda: steps._bounded(collocating(), 0.0),
    "radau.largest_factor": lambda: steps._bounded(collocating(), np.inf),
    "radau.keep_matrix": lambda: costs_of("keep"),
    "radau.keep_high": largest_growth_that_is_kept,
    "radau.stages_after": steps_to_a_choice,
    "radau.gain": cost_at_which_stages_change,
    "radau.solution_cost": lambda: costs_of("iteration_cost"),
    "radau.slowest": lambda: following_step(contraction=0.2),
    "radau.converging": slowest_coefficients,
    "radau.after_failure": lambda: iterated([np.nan])[1].suggested,
    "radau.remainder": remainder,
    "solve.radau.collocation:MOST_BETWEEN": lambda: len(collocation._between(np.array([0.0, 0.2, 0.6, 1.0]))) - 2,
    "solve.radau.native.between_steps:ROUNDING": smallest_correction_between_steps,
    "solve.radau.native.between_steps:MOST_MOVED": lambda: most_moved(False),
    "polishing.most_moved": lambda: most_moved(True),
    "solve.radau.native.newton:MOST_ITERATIONS": lambda: newton.most_iterations(METHOD),
    "solve.radau.native.newton:DIVERGING": largest_contraction,
    "solve.radau.native.newton:SHORTER": suggested_after_a_slow_iteration,
    "solve.radau.native.newton:MOST_LEFT": suggested_after_a_slow_iteration,
    "solve.radau.native.newton:LATER": allowed_later,
    "solve.radau.native.error_estimate:LEAST_ESTIMATE": least_error,
    "solve.radau.native.steps:LEAST_ERROR": last_error,
    "solve.radau.native.steps:MOST_DECAYS": starts_without_decay,
}  # fmt: skip
"""Decision of each parameter: ``subsystem.field``, or ``module:NAME``."""
EXPECTED = {
    "radau.tolerance": 0.01, "radau.least_factor": 0.125, "radau.largest_factor": 5, "radau.keep_matrix": 0.003125, "radau.keep_high": 51,
    "radau.stages_after": 3, "radau.gain": 79, "radau.solution_cost": 3.2, "radau.slowest": 1, "radau.converging": 25, "radau.after_failure": 0.5, "radau.remainder": 0.003,
    "solve.radau.collocation:MOST_BETWEEN": 4, "solve.radau.native.between_steps:ROUNDING": 27, "solve.radau.native.between_steps:MOST_MOVED": 0.5,
    "polishing.most_moved": 30,
    "solve.radau.native.newton:MOST_ITERATIONS": 7, "solve.radau.native.newton:DIVERGING": 40, "solve.radau.native.newton:SHORTER": 0.5214690759,
    "solve.radau.native.newton:MOST_LEFT": 0.5214690759, "solve.radau.native.newton:LATER": 5, "solve.radau.native.error_estimate:LEAST_ESTIMATE": 1e-10,
    "solve.radau.native.steps:LEAST_ERROR": 0.01, "solve.radau.native.steps:MOST_DECAYS": 3,
}  # fmt: skip
"""The decisions of the default parameters."""
