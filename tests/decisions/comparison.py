"""Decisions on comparisons of solvers: settings, agreement of references, timing, tables."""

from __future__ import annotations

from inspect import signature
from unittest.mock import patch

import numpy as np

from stiffmbs.comparison import at_error, over, plan, reference, sweep, table, words
from stiffmbs.errors import SolverError
from stiffmbs.solve.trajectory import Outcome
from tests.decisions.common import Reached, Record, executed, module, reach, reached
from tests.solve.test_parameter_thresholds import DOUBLES, count_while

compare = module("comparison.compare")


def points_on_a_line(errors):
    """Return the number of points of the line at an error of 1."""
    with patch.object(at_error, "on_line", lambda near, _: len(near)):
        return at_error.value_at_error([(error, 1e9) for error in errors], 1.0)


def most_points_without_a_line():
    return count_while(lambda n: points_on_a_line(1.01 ** (np.arange(n) - n / 2 + 0.25)) == 2, range(2, 20))


def default_of(name):
    return signature(executed("comparison.compare").compare).parameters[name].default


def values_per_decade():
    with patch.multiple(
        plan, variation=lambda *_: None, numbers_of=lambda _, count: (count,), Plan=lambda *args: args[2][0]
    ):
        return plan.plan_of((), (), (), None, "positions", 1, 1.0)


def time_of_a_reference():
    """Return the time limit of the runs of a reference, relative to that of other runs."""
    with patch.multiple(
        compare, data_of=lambda _: None, plan_of=lambda *_: Record(longest=1.0, entries=lambda _: ()),
        base_settings=lambda *_: None, reference=lambda _model, _base, allowed, _tell: reach(allowed),
    ):  # fmt: skip
        return reached(lambda: compare.compare(None))


def tolerances_of_a_reference(part):
    """Return the tolerances of the runs of a reference, of which both integrators differ by a part of the motion."""
    tolerances = []

    def pair(_model, _settings, rtol, *_):
        tolerances.append(rtol)
        return Record(part=lambda _: part)

    with patch.multiple(reference, _pair=pair, _agreed=lambda _: None, _disagreement=lambda *_: ""):
        try:
            reference.reference(None, None, 1.0, None)
        except SolverError:
            return ()
    return tolerances


def largest_difference_of_forces():
    def is_silent(part):
        pair = Record(
            channels={"forces": ("f",)}, parts=lambda _: {"f": np.array([part])}, implicit=None, names=(), part=lambda _: 0.0,
            explicit=Record(unit=lambda _: "N", time=np.zeros(1), not_unique=()),
        )  # fmt: skip
        with patch.multiple(reference, difference=lambda *_: np.zeros(1), largest=lambda *_: 0.0):
            return not reference._agreed(pair).notes

    return count_while(lambda part: is_silent(1e-4 * part), DOUBLES)


def resolved(agreement, size):
    return reference.Reference.resolved(Record(agreement={"m": agreement}, size=lambda _: size), "m")


def settings_beyond_the_target():
    """Return the number of settings of a sweep that are all far more accurate than required."""
    point = Record(message="", errors={"m": 0.0})
    entry = Record(name="", setting=str, at=lambda *_: None)
    found = Record(tell=str, model=None, settings=None, _first=lambda *_: (point, False))
    with patch.multiple(sweep, prepare=lambda *_: None, _warm_up=lambda _: None):
        return len([*sweep.Sweep.points(found, entry, range(20), ("m", 1.0))])


def end_of_a_warm_up():
    job = Record(grid=Record(start=0.0, end=1.0), varied=lambda times: reach(times[-1]))
    return reached(lambda: sweep._warm_up(job))


def longest_run_timed_twice():
    def is_timed_twice(seconds):
        measured = iter([(seconds, Record(outcome=Outcome.DONE))])
        job = Record(grid=Record(start=0.0, end=1.0))
        with patch.object(sweep, "seconds_of", lambda _: next(measured, None) or reach(True)):
            try:
                sweep.Sweep._first(Record(longest=1.0), job, None, "", True)
            except AttributeError:  # of the statistics of the only timed run
                return False
            except Reached:
                return True

    return count_while(lambda seconds: not is_timed_twice(0.01 * seconds), DOUBLES)


def columns_at(width):
    """Return the number of solvers side by side on a console of a width."""
    shown = Record(measure="positions", name="")
    with patch.object(table, "measured_tables", lambda _, columns: reach(columns)):
        return reached(lambda: table._show_measured(shown, Record(width=width), str))


def narrowest_pair():
    return count_while(lambda width: columns_at(width) < 2, range(400))


DECISIONS = {
    "comparison.at_error:LineAtError.window": lambda: points_on_a_line(2.0 ** (np.arange(-100, 101) / 4 + 0.01)),
    "comparison.at_error:LineAtError.fewest": most_points_without_a_line,
    "comparison.over:USUAL_ERROR": lambda: over._error(None, "positions"),
    "comparison.plan:PER_DECADE": values_per_decade,
    "comparison.plan:REPEATS": lambda: default_of("repeats"),
    "comparison.plan:LONGEST_RUN": lambda: default_of("longest"),
    "comparison.plan:LONGER_REFERENCE": time_of_a_reference,
    "comparison.reference:TIGHT": lambda: tolerances_of_a_reference(5e-6)[0],
    "comparison.reference:TIGHTER": lambda: tolerances_of_a_reference(5e-6)[1],
    "comparison.reference:NEAR_ENOUGH": lambda: count_while(
        lambda part: len(tolerances_of_a_reference(1e-8 * part)) == 1, DOUBLES
    ),
    "comparison.reference:AGREED": lambda: count_while(lambda part: tolerances_of_a_reference(1e-7 * part), DOUBLES),
    "comparison.reference:FORCES_AGREED": largest_difference_of_forces,
    "comparison.reference:NO_MOTION": lambda: reference._sizes(Record(channels={"a.x": np.zeros(2)}, requested={}), 1.0)["a.x"],
    "comparison.reference:RESOLVED": lambda: resolved(1.0, 0.0),
    "comparison.reference:ROUNDING_OF_A_RUN": lambda: resolved(0.0, 1.0),
    "comparison.sweep:ENOUGH_SETTINGS": settings_beyond_the_target,
    "comparison.sweep:WARM_UP": end_of_a_warm_up,
    "comparison.sweep:Timing.once": longest_run_timed_twice,
    "comparison.table:COLUMNS": lambda: columns_at(10_000),
    "comparison.table:FIRST": narrowest_pair,
    "comparison.table:EACH": narrowest_pair,
    "comparison.words:ALIKE": lambda: count_while(
        lambda more: len(words._fastest(Record(seconds={"a": 1.0, "b": 1.0 + 0.01 * more}), ["a", "b"])) == 2, DOUBLES
    ),
}  # fmt: skip
EXPECTED = {
    "comparison.at_error:LineAtError.window": 39, "comparison.at_error:LineAtError.fewest": 2, "comparison.over:USUAL_ERROR": 0.0001,
    "comparison.plan:PER_DECADE": 4, "comparison.plan:REPEATS": 9, "comparison.plan:LONGEST_RUN": 20.0,
    "comparison.plan:LONGER_REFERENCE": 10.0, "comparison.reference:TIGHT": 1e-12, "comparison.reference:TIGHTER": 1e-13,
    "comparison.reference:NEAR_ENOUGH": 27, "comparison.reference:AGREED": 27, "comparison.reference:FORCES_AGREED": 27,
    "comparison.reference:NO_MOTION": 0.0001, "comparison.reference:RESOLVED": 3.0, "comparison.reference:ROUNDING_OF_A_RUN": 1e-11,
    "comparison.sweep:ENOUGH_SETTINGS": 2, "comparison.sweep:WARM_UP": 0.001, "comparison.sweep:Timing.once": 18, "comparison.table:COLUMNS": 4,
    "comparison.table:FIRST": 72, "comparison.table:EACH": 72, "comparison.words:ALIKE": 14,
}  # fmt: skip
