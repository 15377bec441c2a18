"""PINPUT and POUTPUT: variables that another program gives and reads."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs import InputError
from stiffmbs.adams.load import read_adams

CART = """a cart that is pushed
UNITS/FORCE=NEWTON, MASS=KILOGRAM, LENGTH=MILLIMETER, TIME=SECOND
PART/1, GROUND
MARKER/11, PART=1
PART/2, MASS=2, CM=21, IP=1,1,1
MARKER/21, PART=2
JOINT/1, TRANSLATIONAL, I=21, J=11
VARIABLE/1, FUNCTION=3*2
VARIABLE/2, FUNCTION=TIME
VARIABLE/3, FUNCTION=DZ(21, 11)
PINPUT/5, VARIABLES=1,2
POUTPUT/6, VARIABLES=3
SFORCE/1, TRANSLATIONAL, ACTIONONLY, I=21, J=11, FUNCTION=VARVAL(1) + PINVAL(5, 2) + 0*POUVAL(6, 1)
REQUEST/1, F2=VARVAL(1)\\, F3=PINVAL(5, 1)\\, F4=POUVAL(6, 1)
END
"""


@pytest.mark.long
def test_an_input_is_given_and_an_output_read():
    scene = read_adams(CART)
    usual = stiffmbs.run(scene, duration=1, points=11, rtol=1e-9)
    t = usual.time
    np.testing.assert_allclose(usual["PART_2.z"], (6 * t**2 / 2 + t**3 / 6) / 2, atol=1e-8)
    np.testing.assert_allclose(usual["VARIABLE_3"], usual["PART_2.z"] * 1000, atol=1e-8)
    np.testing.assert_allclose(usual["REQUEST_1.f4"], usual["VARIABLE_3"])
    given = stiffmbs.run(scene, duration=1, points=11, rtol=1e-9, inputs={"VARIABLE_1": lambda t: 6 * t})
    np.testing.assert_allclose(given["PART_2.z"], (t**3 + t**3 / 6) / 2, atol=1e-8)
    for name in ("REQUEST_1.f2", "REQUEST_1.f3"):
        np.testing.assert_allclose(given[name], 6 * t, atol=1e-9)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("PINPUT/5, VARIABLES=1,2", "PINPUT/5", "PINPUT/5: found no VARIABLES, expected the numbers of VARIABLE statements"),
        ("VARIABLES=3", "VARIABLES=4", "POUTPUT/6: found VARIABLES = 4, expected the number of a VARIABLE"),
        ("0*POUVAL(6, 1)", "POUVAL(6, 2)", r"found POUVAL\(6, 2\), expected a POUTPUT and the position of one of its variables"),
    ],
)  # fmt: skip
def test_what_is_wrong_with_inputs_and_outputs_is_said(old, new, message):
    with pytest.raises(InputError, match=message):
        read_adams(CART.replace(old, new))
