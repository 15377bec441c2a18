"""Functions and splines of Adams datasets as formulas and tables of a scene."""

import ast
import math

import numpy as np
import pytest
from scipy.interpolate import Akima1DInterpolator, CubicSpline

from stiffmbs.compile.table_values import curve
from stiffmbs.errors import InputError
from stiffmbs.reading.formula.text import evaluate
from stiffmbs.reading.table import Table

from .adams_parts import made


def formula(text, length="METER"):
    return made(f"VARIABLE/9, FUNCTION={text}", length)["requests"]["VARIABLE_9"]


@pytest.mark.parametrize(
    "text, expected",
    [
        ("DX(22,1)", "dx(PART_2.MARKER_22, ground.MARKER_1)"),
        ("DX(22)", "dx(PART_2.MARKER_22)"),
        ("DX(22,0,2)", "dx(PART_2.MARKER_22, ground, ground.MARKER_2)"),
        ("WZ(22,1,1)", "wz(PART_2.MARKER_22, ground.MARKER_1, ground.MARKER_1)"),
        ("VR(22,33,33)", "vr(PART_2.MARKER_22, PART_3.MARKER_33)"),
        ("AZ(22,1)*RTOD", "az(PART_2.MARKER_22, ground.MARKER_1) * 57.29577951308232"),
        ("2*time+PI", "2 * t + 3.141592653589793"),
        ("ACCX(22,1,2)", "accx(PART_2.MARKER_22, ground.MARKER_1, ground.MARKER_2)"),
        ("PSI(22,1)", "psi(PART_2.MARKER_22, ground.MARKER_1)"),
        ("ORIENT(27,2,22,1)", "q1(PART_2.MARKER_22, ground.MARKER_1)"),
        ("VX(22,1,1,1)", "vx(PART_2.MARKER_22, ground.MARKER_1, ground.MARKER_1)"),
        (
            "VX(22,33,33,33)",
            "vx(PART_2.MARKER_22, PART_3.MARKER_33, PART_3.MARKER_33) - wy(PART_3.MARKER_33, ground, PART_3.MARKER_33) * "
            "dz(PART_2.MARKER_22, PART_3.MARKER_33, PART_3.MARKER_33) + wz(PART_3.MARKER_33, ground, PART_3.MARKER_33) * "
            "dy(PART_2.MARKER_22, PART_3.MARKER_33, PART_3.MARKER_33)",
        ),
        ("IF(TIME-1: 0, 1, 2)", "branch(t - 1, 0, 1, 2)"),
        ("MOD(TIME, 2)", "mod(t, 2)"),
    ],
)
def test_functions_become_formulas(text, expected):
    assert formula(text) == expected


FUNCTIONS = {
    "sin": math.sin, "cos": math.cos, "min": min, "max": max, "abs": abs, "sign": lambda x: math.copysign(1, x), "log": math.log,
    "step5": lambda x, x0, h0, x1, h1: h0 + (h1 - h0) * np.polyval([6, -15, 10, 0, 0, 0], np.clip((x - x0) / (x1 - x0), 0, 1)),
    "step": lambda x, x0, h0, x1, h1: h0 if x <= x0 else h1 if x >= x1 else h0 + (h1 - h0) * ((x - x0) / (x1 - x0))**2 * (3 - 2 * (x - x0) / (x1 - x0)),
}  # fmt: skip


@pytest.mark.parametrize(
    "text, expected",
    [
        ("SHF(TIME, 0.1, 2, 3, 0.5, 1)", lambda t: 2 * math.sin(3 * (t - 0.1) - 0.5) + 1),
        ("SHF(TIME, 0.1, 2, 3)", lambda t: 2 * math.sin(3 * (t - 0.1))),
        ("POLY(TIME, 1, 1, 2, 3)", lambda t: 1 + 2 * (t - 1) + 3 * (t - 1) ** 2),
        ("CHEBY(TIME, 1, 1, 2, 3, 4)", lambda t: np.polynomial.chebyshev.chebval(t - 1, [1, 2, 3, 4])),
        ("FORCOS(TIME, 0.2, 3, 1, 2, 4)", lambda t: 1 + 2 * math.cos(3 * (t - 0.2)) + 4 * math.cos(6 * (t - 0.2))),
        ("FORSIN(TIME, 0.2, 3, 1, 2, 4)", lambda t: 1 + 2 * math.sin(3 * (t - 0.2)) + 4 * math.sin(6 * (t - 0.2))),
        (
            "HAVSIN(TIME, 0.5, 1, 1.5, 3)",
            lambda t: 1 if t < 0.5 else 3 if t > 1.5 else 2 + math.sin((t - 0.5) * math.pi - math.pi / 2),
        ),
        ("SWEEP(TIME, 3, 0.2, 2, 1.2, 5, 0.5)", lambda t: sweep(t)),
        ("IMPACT(TIME, 2, 1, 100, 1.5, 0.3, 0.1)", lambda t: max(0, impact(1 - t, 2)) if t < 1 else 0),
        ("BISTOP(TIME, 2, 0.5, 1, 100, 1.5, 0.3, 0.1)", lambda t: bistop(t, 2)),
        ("SIGN(3, TIME-1)", lambda t: math.copysign(3, t - 1)),
        ("SIGN(-3, TIME-0.3)", lambda t: 3 if t >= 0.3 else -3),
        ("DIM(TIME, 1)", lambda t: max(t - 1, 0)),
        ("LOG10(TIME+1)", lambda t: math.log10(t + 1)),
    ],
)
def test_special_functions(text, expected):
    tree = ast.parse(formula(text), mode="eval").body
    for t in (0.0, 0.3, 0.6, 0.95, 1.3, 2.0):
        assert evaluate(tree, {"t": t}.__getitem__, FUNCTIONS) == pytest.approx(expected(t), abs=1e-12)


def sweep(t):
    """Of an amplitude of 3 and a phase whose rate goes from 2 Hz at 0.2 to 5 Hz at 1.2, by quadrature."""
    knots = np.unique(np.clip([0, 0.2, 1.2, t], 0, t))
    turns = np.trapezoid(np.interp(knots, [0.2, 1.2], [2, 5]), knots)
    return 3 * FUNCTIONS["step5"](t, 0.2, 0, 0.7, 1) * math.sin(2 * math.pi * turns)


def impact(depth, rate):
    """Of k = 100, e = 1.5, c = 0.3, d = 0.1, the rate being that of the way out."""
    damping = 0.3 * FUNCTIONS["step"](depth, 0, 0, 0.1, 1)
    return 100 * depth**1.5 - damping * rate


def bistop(x, rate):
    if x < 0.5:
        return max(0, impact(0.5 - x, rate))
    return -max(0, impact(x - 1, -rate)) if x > 1 else 0


def test_variables_are_those_of_the_scene():
    found = made(
        "VARIABLE/1, FUNCTION=2*TIME\nVARIABLE/2, IC=1, FUNC=VARVAL(1)+1\nSFORCE/1, TRANS, I=22, J=1, FUNC=VARVAL(2)"
    )
    assert found["forces"]["SFORCE_1"]["force"] == "VARIABLE_2"
    assert found["variables"] == {"VARIABLE_1": "2 * t", "VARIABLE_2": "VARIABLE_1 + 1"}
    assert found["requests"] == {"VARIABLE_1": "VARIABLE_1", "VARIABLE_2": "VARIABLE_2"}


def test_a_motion_is_integrated_with_the_expressions_of_variables():
    found = made(
        "VARIABLE/1, FUNCTION=2*TIME\nJOINT/1, REV, I=22, J=1\nMOTION/1, ACCEL, ROT, JOINT=1, FUNC=VARVAL(1)", "METER"
    )
    assert found["joints"]["MOTION_1"]["position"] == "t ** 3 / 3"


def test_variables_that_depend_on_themselves_are_algebraic_states():
    found = made(
        "VARIABLE/1, IC=2, FUNCTION=VARVAL(2)/2+1\nVARIABLE/2, FUNCTION=COS(VARVAL(1))\nVARIABLE/3, FUNCTION=2*VARVAL(1)\n"
        "SFORCE/1, TRANS, I=22, J=1, FUNC=VARVAL(3)"
    )
    assert found["states"] == {
        "VARIABLE_1_value": {"zero": "VARIABLE_2_value / 2 + 1 - VARIABLE_1_value", "start": 2},
        "VARIABLE_2_value": {"zero": "cos(VARIABLE_1_value) - VARIABLE_2_value", "start": 0},
    }
    assert found["forces"]["SFORCE_1"]["force"] == "VARIABLE_3"
    assert found["variables"] == {"VARIABLE_3": "2 * VARIABLE_1_value"}


@pytest.mark.parametrize(
    "text, words",
    [
        ("GRAVITY(1)", "found the function GRAVITY in"),
        ("FOO", "found 'FOO' in 'FOO', expected TIME, PI"),
        ("DX(99)", "found the marker 99 in"),
        ("DX(32)", "found the floating marker 32"),
        ("DM(22,1,1)", "found 3 markers of DM"),
        ("DX(TIME)", "found 'TIME' in 'DX"),
        ("SHF(TIME)", "found 1 arguments of SHF"),
        ("VARVAL(7)", r"found VARVAL\(7\), expected the number of a VARIABLE"),
        ("ACCX(22)", "found the function ACCX in"),
    ],
)
def test_forces_refuse_what_formulas_do_not_have(text, words):
    with pytest.raises(InputError, match=rf"line 14, SFORCE/1: {words}"):
        made(f"SFORCE/1, TRANS, I=22, J=1, FUNC={text}")


SPLINE = "SPLINE/3, X=0,1,2,3,5, Y=0,2,1,4,4\n"


def test_splines_are_tables_that_formulas_call():
    text = (
        SPLINE
        + "SFORCE/1, TRANS, I=22, J=1, FUNC=10*AKISPL(DM(22,1),0,3,0)\nVARIABLE/1, FUNC=CUBSPL(TIME,0,3)+INTERP(TIME,1,3)"
    )
    found = made(text, "MILLIMETER")
    points = [[0, 0], [1, 2], [2, 1], [3, 4], [5, 4]]
    assert found["tables"] == {
        "AKISPL_3": {"table": points, "akima": True, "beyond": "extend"},
        "CUBSPL_3": {"table": points, "ends": "not-a-knot", "beyond": "extend"},
        "LINE_3": {"table": points, "lines": True, "beyond": "extend"},
    }
    assert found["forces"]["SFORCE_1"]["force"].startswith(
        "10 * (AKISPL_3(dm(PART_2.MARKER_22, ground.MARKER_1) / 0.001) + "
    )


def test_interp_has_the_method_before_the_spline():
    """INTERP(x, method, id, iord): a derivative is refused, not read as the number of another spline."""
    text = SPLINE + "SPLINE/1, X=0,1,2,3, Y=0,1,2,3\nVARIABLE/1, FUNC="
    assert made(text + "INTERP(TIME,3,1)")["requests"]["VARIABLE_1"] == "CUBSPL_1(t)"
    assert made(text + "INTERP(TIME,1,3,0)")["requests"]["VARIABLE_1"].startswith("LINE_3(t) + ")
    with pytest.raises(InputError, match="expected the value of a cubic or linear spline"):
        made(f"{text.partition('VARIABLE')[0]}SFORCE/1, TRANS, I=22, J=1, FUNC=INTERP(TIME,3,1,1)")


@pytest.mark.parametrize("function", ["AKISPL(DX(22,1),0,3)", "CUBSPL(DX(22,1),0,3,0)", "INTERP(DX(22,1),1,3)"])
@pytest.mark.parametrize("linear", [False, True])
def test_splines_are_extrapolated_as_by_adams(function, linear):
    """A parabola through the three points at an end, with LINEAR_EXTRAPOLATE a line through two."""
    statement = SPLINE.replace("/3", "/3, LINEAR_EXTRAPOLATE") if linear else SPLINE
    found = made(f"{statement}VARIABLE/1, FUNC=2*{function}")
    ((name, table),) = found["tables"].items()
    tree = ast.parse(
        found["requests"]["VARIABLE_1"].replace("dx(PART_2.MARKER_22, ground.MARKER_1)", "x"), mode="eval"
    ).body
    functions = {"min": min, "max": max, name: lambda x: float(curve(Table(**table))(x))}
    x, y = np.array([0, 1, 2, 3, 5.0]), np.array([0, 2, 1, 4, 4.0])
    count = 2 if linear else 3
    for at, points in (
        (-0.7, slice(count)),
        (-3.0, slice(count)),
        (5.4, slice(-count, None)),
        (9.0, slice(-count, None)),
    ):
        wanted = np.polynomial.Polynomial.fit(x[points], y[points], count - 1)(at)
        assert evaluate(tree, {"x": at}.__getitem__, functions) == pytest.approx(2 * wanted, rel=1e-12)
    for at, value in zip(x, y, strict=True):
        assert evaluate(tree, {"x": at}.__getitem__, functions) == pytest.approx(2 * value, abs=1e-12)


@pytest.mark.parametrize("function", ["AKISPL", "CUBSPL"])
def test_families_of_curves_are_cubic_in_x_and_linear_in_z(function):
    x, z, y = [0, 1, 2, 3, 5.0], [-1, 0.5, 2], [[0, 2, 1, 4, 4], [1, 1, 3, 2, 0], [5, 4, 4, 3, 9.0]]
    rows = "\n".join(f", Y={a}, {str(b)[1:-1]}" for a, b in zip(z, y, strict=True))
    found = made(f"SPLINE/3, X={str(x)[1:-1]}\n{rows}\nVARIABLE/1, FUNC={function}(DX(22,1),DY(22,1),3)")
    functions = {"min": min, "max": max, **{name: curve(Table(**table)) for name, table in found["tables"].items()}}
    text = found["requests"]["VARIABLE_1"]
    for axis in "xy":
        text = text.replace(f"d{axis}(PART_2.MARKER_22, ground.MARKER_1)", axis)
    kind = {"AKISPL": Akima1DInterpolator, "CUBSPL": CubicSpline}[function]
    for at, beside in ((1.5, 0.0), (2.7, 1.3), (4.0, 2.0), (0.5, -2.0), (3.3, 3.0)):
        across = [float(kind(x, each)(at)) for each in y]
        k = min(max(np.searchsorted(z, beside) - 1, 0), len(z) - 2)
        wanted = across[k] + (across[k + 1] - across[k]) * (beside - z[k]) / (z[k + 1] - z[k])
        value = evaluate(ast.parse(text, mode="eval").body, {"x": at, "y": beside}.__getitem__, functions)
        assert value == pytest.approx(wanted, rel=1e-12)


@pytest.mark.parametrize(
    ("more", "words"),
    [
        (", Y=0, 1,2,3,4\n, Y=0, 1,2,3,4", "increasing z of a family"),
        (", Y=0, 1,2,3,4", "found 4 X and 5 Y"),
        (", Y=0, 1,2,3,4\n, Y=1, 2,3,4,5\nVARIABLE/1, FUNC=INTERP(TIME,1,3)\nSFORCE/1, TRANS, I=22, J=1, FUNC=VARVAL(1)", "several curves in INTERP"),
    ],
)  # fmt: skip
def test_families_that_are_none_are_refused(more, words):
    with pytest.raises(InputError, match=words):
        made(f"SPLINE/3, X=0,1,2,3\n{more}")


@pytest.mark.parametrize(
    "text, words",
    [
        ("AKISPL(TIME,0,4)", "found the spline 4 in 'AKISPL"),
        ("AKISPL(TIME,0,3,1)", "expected the value of a cubic or linear spline"),
        ("INTERP(TIME,2,3)", "expected the value of a cubic or linear spline"),
    ],
)
def test_splines_that_are_not_there_are_told(text, words):
    with pytest.raises(InputError, match=words):
        made(f"{SPLINE}SFORCE/1, TRANS, I=22, J=1, FUNC={text}")
