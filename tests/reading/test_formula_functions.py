"""Each function of formulas does the same in all its forms: numbers, arrays, equations, kernels, intervals."""

import json
import math
import re
from pathlib import Path

import numpy as np
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

import stiffmbs
from stiffmbs.compile.inputs.enclosed_functions import FUNCTIONS as ENCLOSED
from stiffmbs.compile.inputs.features import breakpoint_times
from stiffmbs.compile.inputs.interval_arithmetic import Enclosure
from stiffmbs.compile.inputs.of_time import inputs_of
from stiffmbs.compile.symbolic.generate import HEADER
from stiffmbs.compile.symbolic.symbols import SMOOTH
from stiffmbs.reading.formula.functions import FUNCTIONS, IN_FORMULAS
from stiffmbs.reading.units.units import UNITS

ARGUMENTS = {"step": (0.1, -1.0, 0.8, 2.0), "step5": (0.1, 3.0, 0.8, -2.0), "branch": (1.0, 2.0, 3.0)}
POINTS = (-0.75, -0.3, 0.1, 0.35, 0.5, 0.8, 0.95)


def others(name):
    return ARGUMENTS.get(name, (0.4,) * (FUNCTIONS[name].takes.least - 1) + (0.2,) * FUNCTIONS[name].takes.or_more)


def points(name):
    low, high = FUNCTIONS[name].domain
    return [x for x in POINTS if low < x < high]


@pytest.mark.parametrize("name", FUNCTIONS)
def test_numbers_and_arrays_agree(name):
    function = FUNCTIONS[name]
    expected = [float(function.value(x, *others(name))) for x in points(name)]
    np.testing.assert_allclose(function.array(np.array(points(name)), *others(name)), expected, rtol=1e-14)


@pytest.mark.parametrize("name", IN_FORMULAS)
def test_kernels_agree_with_numbers(name):
    """A torque of the function along x = t, which leaves x as it is."""
    more = "".join(f", {value}" for value in others(name))
    scene = {
        "bodies": {"a": {"mass": 1, "inertia": 1, "position": [points(name)[0], 0], "velocity": [1, 0]}},
        "forces": {"f": {"type": "torque", "i": "a", "torque": f"{name}(a.x{more})"}},
        "run": {"duration": points(name)[-1] - points(name)[0], "points": 30, "rtol": 1e-10},
    }
    solution = stiffmbs.run(stiffmbs.read_scene(json.dumps(scene)))
    expected = [FUNCTIONS[name].value(x, *others(name)) for x in solution["a.x"]]
    np.testing.assert_allclose(solution["f.torque"], expected, rtol=1e-12, atol=1e-14)


def test_kernels_call_a_function_by_its_name():
    """SymPy's log(x + sqrt(x^2 + 1)) for asinh(x) would lose all digits below zero."""
    scene = {
        "bodies": {"a": {"mass": 1, "inertia": 1}},
        "forces": {"f": {"type": "force", "i": "a", "force": ["asinh(-1e7*t)", 0]}},
        "run": {"duration": 10, "points": 11},
    }
    solution = stiffmbs.run(stiffmbs.read_scene(json.dumps(scene)))
    np.testing.assert_allclose(solution["f.fx"], np.arcsinh(-1e7 * solution.time), rtol=1e-14)


@given(name=st.sampled_from(sorted(IN_FORMULAS)), low=st.floats(-2, 2), width=st.floats(1e-4, 1.5))
def test_intervals_hold_the_values(name, low, width):
    x = Enclosure.of_time(np.array([low]), np.array([low + width]), 3)
    with np.errstate(all="ignore"):
        constants = [x.constant(value) for value in others(name)] if name in ("atan2", "min", "max") else others(name)
        (least, greatest) = ENCLOSED[name](x, *constants).value[:, 0]
        values = FUNCTIONS[name].array(np.linspace(low, low + width, 50), *others(name))
    values = values[np.isfinite(values)]
    if not math.isnan(least) and len(values):
        rounding = 1e-12 * (1 + np.abs(values).max())
        assert least - rounding <= values.min() and values.max() <= greatest + rounding


@pytest.mark.parametrize("name", [name for name, function in FUNCTIONS.items() if function.derivative])
def test_a_derivative_is_that_of_the_function(name):
    x = sp.Symbol("x", real=True)
    given_one = sp.sympify(FUNCTIONS[name].derivative.replace("^", "**"), locals={"x": x})
    assert sp.simplify(sp.diff(SMOOTH[name](x), x) - given_one) == 0


@pytest.mark.parametrize("name", [name for name, function in IN_FORMULAS.items() if function.breakpoints])
def test_corners_in_time_are_found(name):
    """Where the function of t - 1/2 bends."""
    bends = {"step": (0.6, 1.3), "step5": (0.6, 1.3), "min": (0.7,), "max": (0.7,)}.get(name, (0.5,))
    more = "".join(f", {value}" for value in others(name))
    scene = {
        "bodies": {"a": {"mass": 1, "inertia": 1}},
        "forces": {"f": {"type": "force", "i": "a", "force": [f"{name}(t - 0.5{more})", 0]}},
    }
    found = breakpoint_times(inputs_of(stiffmbs.compile_model(stiffmbs.read_scene(json.dumps(scene)))), 0.0, 2.0)
    np.testing.assert_allclose(found, bends, atol=1e-9)


def test_kernels_import_what_functions_are_called():
    for name, function in FUNCTIONS.items():
        assert not function.in_c or f" {name}," in HEADER or f" {name}\n" in HEADER


def test_the_reference_lists_all_functions_and_units():
    text = (Path(__file__).parents[2] / "docs/reference/scenes.md").read_text()
    listed = set(re.findall(r"\w+", text))
    assert set(FUNCTIONS) | set(UNITS) <= listed
