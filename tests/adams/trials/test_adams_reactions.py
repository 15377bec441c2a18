"""Reactions of joints in the functions of forces: JOINT(id, jflag, comp, rm) and JPRIM."""

import numpy as np
import pytest

from stiffmbs import InputError
from stiffmbs.adams.load import read_adams

from .adams_oracle import Marker, Mechanism, Part, euler, tensor
from .adams_trials import moves_alike, played

BAR = """ACCGRAV/KGRAV=-9.80665
MARKER/11, PART=1, REULER=30D,70D,0D
PART/2, MASS=2, CM=21, IP=0.05,0.04,0.06, REULER=30D,70D,0D, WZ=3
MARKER/21, PART=2, QP=0.3,0.1,0
MARKER/22, PART=2
MARKER/23, PART=2, QP=0.2,0,0.1, REULER=10D,20D,30D
JOINT/1, REVOLUTE, I=22, J=11
DIFF/1, IC=0, FUNCTION=JOINT(1, {on_j}, {component}, {axes})
REQUEST/1, F2=JOINT(1, {on_j}, {component}, {axes})
"""


@pytest.mark.parametrize(
    ("on_j", "component", "axes"),
    [(0, 1, 0), (0, 3, 23), *(pytest.param(*c, marks=pytest.mark.long) for c in ((1, 4, 11), (0, 6, 23), (1, 5, 0), (1, 8, 23)))],
)  # fmt: skip
def test_a_state_and_a_request_see_the_same_reaction(tmp_path, on_j, component, axes):
    found = played(tmp_path, BAR.format(on_j=on_j, component=component, axes=axes), 0.2)
    assert np.ptp(found["REQUEST_1.f2"]) > 0
    np.testing.assert_allclose(found["DIFF_1.rate"], found["REQUEST_1.f2"], rtol=1e-7, atol=1e-8)


@pytest.mark.long
def test_a_brake_that_its_own_hinge_presses(tmp_path):
    """A torque of -0.02 m times the component of the hinge's force along the bar, which a third marker measures."""
    text = BAR.format(on_j=0, component=1, axes=0) + (
        "VARIABLE/4, FUNCTION=0.02*JOINT(1,1,2,21)\nSFORCE/1, ROTATIONAL, I=22, J=11, FUNCTION=VARVAL(4)\n"
    )
    found = played(tmp_path, text, 0.4, rtol=1e-9)
    turn = euler(30, 70, 0)
    part = Part(
        2,
        tensor(0.05, 0.04, 0.06),
        tuple(turn @ [0.3, 0.1, 0]),
        turn,
        tuple(turn @ [-0.3, 0.9, 0]),
        tuple(turn @ [0, 0, 3]),
    )
    pin, base = Marker(0, (0, 0, 0), turn), Marker(-1, (0, 0, 0), turn)

    def hinge(view):
        axis = view.axis(pin, "z")
        return np.column_stack(
            [view.point(pin).second, (axis @ view.axis(base, "x")).second, (axis @ view.axis(base, "y")).second]
        ).T

    size = [0.0]

    def brake(view):
        view.push(pin, view.point(pin).value, np.zeros(3), size[0] * view.axes(pin)[:, 2])

    class Pressed(Mechanism):
        def solve(self, t, y):
            for _ in range(15):
                view, accelerations, pulls = super().solve(t, y)
                size[0] = -0.02 * pulls["hinge"][0, 0] @ view.axes(Marker(0, (0, 0, 0), turn))[:, 0]
            return view, accelerations, pulls

    history = Pressed([part], {"hinge": hinge}, [brake]).run(found.time, 1e-9)
    moves_alike(found, "PART_2", history.part(0), 2e-6)


@pytest.mark.parametrize(
    ("function", "message"),
    [
        ("JOINT(3,0,1,0)", r"found JOINT\(3, ...\), expected the number of a JOINT"),
        ("JOINT(1,0,9,0)", "found the component 9 of JOINT, expected 1 to 8"),
        ("SFORCE(1,0,5,0)", "found the force of SFORCE/1 in its own law"),
        ("BUSH(1,0,1,0)", r"found BUSH\(1, ...\), expected the number of a BUSHING"),
        ("CONTACT(1,0,1,0)", "found CONTACT in .*, a force that depends on others at the same time, expected it in a REQUEST"),
    ],
)  # fmt: skip
def test_what_forces_cannot_use_is_said(function, message):
    text = BAR.format(on_j=0, component=1, axes=0) + f"SFORCE/1, ROTATIONAL, I=22, J=11, FUNCTION={function}\n"
    with pytest.raises(InputError, match=message):
        read_adams(f"a\nPART/1, GROUND\n{text}END\n")
