"""Functions of Adams datasets as formulas of a scene."""

import ast
import math

import numpy as np
import pytest

from stiffmbs.errors import InputError
from stiffmbs.reading.formula.text import evaluate

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
        ("IMPACT(TIME, 2, 1, 100, 1.5, 0.3, 0.1)", lambda t: max(0, impact(1 - t, 2)) if t < 1 else 0),
        ("BISTOP(TIME, 2, 0.5, 1, 100, 1.5, 0.3, 0.1)", lambda t: bistop(t, 2)),
        ("SIGN(3, TIME-1)", lambda t: math.copysign(3, t - 1)),
        ("DIM(TIME, 1)", lambda t: max(t - 1, 0)),
        ("LOG10(TIME+1)", lambda t: math.log10(t + 1)),
    ],
)
def test_special_functions(text, expected):
    tree = ast.parse(formula(text), mode="eval").body
    for t in (0.0, 0.3, 0.6, 0.95, 1.3, 2.0):
        assert evaluate(tree, {"t": t}.__getitem__, FUNCTIONS) == pytest.approx(expected(t), abs=1e-12)


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
