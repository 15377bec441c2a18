"""Each parameter of a table changes a counter of a short run if it is halved or doubled.

The quick test compares the counters of the default parameters with those of the table, unless rounding, which depends on the
processor, may change them as much. A parameter that is halved or doubled moves them beyond the margin, which the long test shows: it
compiles the routines that read the parameter.
"""

from __future__ import annotations

from functools import cache

import pytest

from stiffmbs import tuning
from tests.parameters import CASES, changed

TABLE = [
    ("error_test.growth", "cart_pendulum", "steps", 150, 180, 383),
    ("error_test.margin", "half_car 1e-09", "steps", 3610, 3168, 2764),
    ("error_test.renewal", "cart_pendulum 1e-10", "steps", 632, 669, 701),
    ("error_test_in_space.growth", "dzhanibekov", "jacobians", 64, 54, 39),
    ("error_test_in_space.margin", "dzhanibekov", "steps", 1203, 1077, 966),
    ("error_test_in_space.renewal", "spatial_chain", "newton_failures", 3, 7, 11),
    ("error_test_of_radau.margin", "bouncing_ball radau", "residuals", 766, 710, 589),
    ("relaxation.largest_factor", "andrews 0.001", "rejected", 13, 15, 17),
]
"""Parameter, run, counter, and its values with the parameter halved, as it is, and doubled; None without a clear change."""
RUNS = {case.name: case for case in CASES}
ROWS = [pytest.param(*row, id=" ".join(row[:3])) for row in TABLE]
ROUNDING = 0.01
"""Relative change of a counter that a processor with other rounding may cause."""


@cache
def usual(run):
    return RUNS[run].counts()


def margin(halved, expected, doubled):
    """Return half of the smallest change by the parameter."""
    return 0.5 * min(abs(value - expected) for value in (halved, doubled) if value is not None)


BEYOND_ROUNDING = [row for row in ROWS if margin(*row.values[3:]) > ROUNDING * row.values[4]]


@pytest.mark.parametrize(("parameter", "run", "counter", "halved", "expected", "doubled"), BEYOND_ROUNDING)
def test_the_counters_are_those_of_the_default_parameters(parameter, run, counter, halved, expected, doubled):
    assert abs(usual(run)[counter] - expected) < margin(halved, expected, doubled)


@pytest.mark.long
@pytest.mark.parametrize(("parameter", "run", "counter", "halved", "expected", "doubled"), ROWS)
def test_a_parameter_halved_or_doubled_moves_its_counter(parameter, run, counter, halved, expected, doubled):
    name, field = parameter.split(".")
    default = getattr(tuning.defaults_of(name), field)
    for factor, value in ((0.5, halved), (2.0, doubled)):
        if value is not None:
            moved = RUNS[run].counts({name: {field: changed(default, factor)}})[counter] - usual(run)[counter]
            assert moved * (value - expected) > 0
            assert abs(moved) > margin(halved, expected, doubled)
