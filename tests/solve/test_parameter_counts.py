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
    ("error_filter.troubled", "andrews", "steps", 1063, 1301, None),
    ("error_test.growth", "cart_pendulum", "steps", 150, 180, 383),
    ("error_test.margin", "half_car 1e-09", "steps", 3610, 3168, 2764),
    ("error_test.renewal", "cart_pendulum 1e-10", "steps", 632, 669, 701),
    ("error_test_in_space.growth", "dzhanibekov", "jacobians", 64, 54, 39),
    ("error_test_in_space.margin", "dzhanibekov", "steps", 1203, 1077, 966),
    ("error_test_in_space.renewal", "spatial_chain", "newton_failures", 3, 7, 11),
    ("error_test_of_radau.margin", "bouncing_ball radau", "residuals", 766, 710, 589),
    ("explicit_events.most_retaken", "sliding projected", "accelerations", 1303, 1879, 3031),
    ("explicit_first_step.part", "bouncing_ball projected", "accelerations", 451, 470, 495),
    ("explicit_steps.astray", "cart_pendulum projected", "accelerations", None, 169, 160),
    ("explicit_steps.far_beyond", "stick_slip projected", "accelerations", 34822, 35002, None),
    ("explicit_steps.hardly_off", "cart_pendulum projected", "accelerations", 178, 169, None),
    ("explicit_steps.hardly_off", "chain projected", "accelerations", None, 680, 644),
    ("explicit_steps.largest_factor", "bouncing_ball projected", "steps", 16, 20, None),
    ("explicit_steps.largest_factor", "narrow projected", "accelerations", None, 313, 289),
    ("explicit_steps.least_factor", "half_car auto", "rejected", 14, 17, 27),
    ("explicit_steps.safety", "cart_pendulum projected", "steps", 48, 14, None),
    ("explicit_steps.safety", "half_car auto", "steps", None, 302, 274),
    ("explicit_steps.shortest", "sliding projected", "accelerations", None, 1879, 1771),
    ("explicit_steps.smallest_error", "cart_pendulum projected", "accelerations", None, 169, 160),
    ("explicit_steps.untrusted", "sliding projected", "accelerations", 2081, 1879, 1713),
    ("fastest_rate.iterations", "stick_slip projected", "rejected", 28, 26, 23),
    ("newton.last", "andrews 0.001", "newton_failures", None, 27, 34),
    ("newton.last", "cart_pendulum 1e-10", "jacobians", 62, 57, None),
    ("newton.least", "chain", "steps", 581, 557, None),
    ("newton.loosest", "andrews", "steps", 1202, 1301, 1462),
    ("newton.slowest", "cart_pendulum", "jacobians", 42, 38, None),
    ("newton.slowest", "cart_pendulum", "residuals", None, 251, 279),
    ("newton.trusted", "cart_pendulum 1e-10", "newton_failures", 24, 20, None),
    ("newton.trusted", "cart_pendulum 1e-10", "steps", None, 669, 705),
    ("newton.unknown", "dead_centres", "steps", 3277, 3051, 3183),
    ("radau.converging", "half_car radau", "error_test_failures", 7, 5, None),
    ("radau.gain", "cart_pendulum radau", "jacobians", 22, 15, None),
    ("radau.keep_high", "half_car radau", "steps", None, 184, 206),
    ("radau.keep_matrix", "half_car radau", "jacobians", 40, 28, 14),
    ("radau.largest_factor", "half_car radau", "factorizations", 183, 167, None),
    ("radau.least_factor", "bouncing_ball radau", "residuals", None, 710, 681),
    ("radau.slowest", "cart_pendulum radau 0.001", "residuals", 262, 292, None),
    ("radau.solution_cost", "half_car radau", "factorizations", None, 167, 212),
    ("radau.stages_after", "half_car radau", "factorizations", 216, 167, None),
    ("radau.tolerance", "cart_pendulum radau", "residuals", None, 557, 485),
    ("relaxation.largest_factor", "andrews 0.001", "rejected", 13, 15, 17),
    ("relaxation.of_positions", "andrews 0.001", "newton_failures", 32, 27, 24),
    ("relaxation.of_velocities", "andrews", "rejected", 17, 24, 15),
    ("stability_bound.held_back", "stick_slip projected", "steps", 2864, 2869, 2884),
    ("stability_bound.most_apart", "stick_slip projected", "rejected", 28, 26, 27),
    ("stability_bound.soon", "stick_slip projected", "rejected", 23, 26, None),
    ("stability_bound.steep", "stick_slip projected", "steps", None, 2869, 2495),
    ("stability_bound.worth", "half_car auto 0.001", "rejected", 13, 23, None),
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
