"""Runs of one Adams dataset in many units: results are in SI."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs.adams.load import read_adams

G = 9.80665
PENDULUM = """title
UNITS/{units}
PART/1, GROUND
MARKER/1, PART=1, REULER=0,90D,0
PART/2, MASS={m}, CM=20, IP={i},{j},{j}
MARKER/20, PART=2, QP={a},0,0
MARKER/21, PART=2, REULER=0,90D,0
JOINT/1, REVOLUTE, I=21, J=1
ACCGRAV/KGRAV=-{g}
SFORCE/1, ROT, I=21, J=1, FUNCTION=-{c}*WZ(21,1,1) - {k}*AZ(21,1)
SFORCE/2, TRANS, I=20, J=1, FUNCTION=-{s}*DM(20,1)*STEP(TIME, 0, 0, {half}, 1)
REQUEST/1, V, I=20, J=1
VARIABLE/1, FUNCTION=DX(20,1)
END
"""
LBF, FT = 4.4482216152605, 0.3048
SLUG = LBF / FT


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.parametrize(
    "units, force, mass, length, time",
    [
        ("FORCE=NEWTON, MASS=KILOGRAM, LENGTH=MILLIMETER, TIME=SECOND", 1, 1, 1e-3, 1),
        pytest.param(
            "FORCE=KNEWTON, MASS=TONNE, LENGTH=CENTIMETER, TIME=MILLISECOND",
            1e3,
            1e3,
            1e-2,
            1e-3,
            marks=pytest.mark.long,
        ),
        ("FORCE=POUND_FORCE, MASS=SLUG, LENGTH=FOOT, TIME=SECOND", LBF, SLUG, FT, 1),
        ("SYSTEM=CGS", 1e-5, 1e-3, 1e-2, 1),
    ],
)
def test_results_are_in_si_whatever_the_units(units, force, mass, length, time):
    def solved(units, force, mass, length, time):
        moment, torque = mass * length**2, force * length
        numbers = {
            "m": 2 / mass, "i": 0.01 / moment, "j": 0.02 / moment, "a": 0.3 / length, "g": G / (length / time**2),
            "c": 0.05 / (torque * time), "k": 1.5 / torque, "s": 7 / (force / length), "half": 0.5 / time,
        }  # fmt: skip
        text = PENDULUM.format(units=units, **{name: repr(value) for name, value in numbers.items()})
        return stiffmbs.run(read_adams(text), duration=2.0, rtol=1e-9)

    found = solved(units, force, mass, length, time)
    expected = solved("SYSTEM=MKS", 1, 1, 1, 1)
    for channel in (
        "PART_2.x",
        "PART_2.vz",
        "JOINT_1.fz",
        "SFORCE_1.ty",
        "SFORCE_2.fx",
        "REQUEST_1.vz",
        "REQUEST_1.wy",
    ):
        np.testing.assert_allclose(found[channel], expected[channel], atol=2e-6, err_msg=channel)
    np.testing.assert_allclose(found["VARIABLE_1"] * length, expected["VARIABLE_1"], atol=1e-6)
