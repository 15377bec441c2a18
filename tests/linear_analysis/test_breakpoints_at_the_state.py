"""Linearisations at states where forces bend or jump."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs.analyses.linearised.transfer import transfer
from stiffmbs.errors import SolverError
from tests.stress.families.analyses.breakpoints_at_the_state import ball, slider


def test_a_damper_of_one_direction_has_both_sides():
    found = stiffmbs.modes(slider("-20*max(b.vx, 0)"))
    assert "breakpoint of a force on b.vx" in found.notes[-1]
    assert sorted(np.linalg.eigvals(side.matrix).real.min() for side in found.sides) == pytest.approx([-10, 0])
    with pytest.raises(SolverError, match=r"breakpoint of a force on b\.vx"):
        transfer(slider("-20*max(b.vx, 0)"), ["b.fx"], ["b.vx"])


@pytest.mark.long
def test_a_ball_that_just_touches_has_both_sides():
    found = stiffmbs.modes(ball(0.1))
    rates = sorted(np.abs(np.linalg.eigvals(side.matrix)).max() for side in found.sides)
    assert rates == pytest.approx([5, np.sqrt(125)])
    assert not stiffmbs.modes(ball(0.11)).sides


def test_a_moving_damper_of_one_direction_has_one_side():
    found = stiffmbs.modes(slider("-20*max(b.vx, 0)", speed=0.1))
    assert not found.sides
    response = transfer(slider("-20*max(b.vx, 0)", speed=0.1), ["b.fx"], ["b.vx"]).response(np.array([1.0]))
    assert response[0, 0, 0] == pytest.approx(1 / (2 * 2j * np.pi + 20))


@pytest.mark.parametrize("law", ["-5*sign(b.vx)", "-5*sign(b.x) - b.x"])
def test_a_jump_is_refused(law):
    with pytest.raises(SolverError, match=r"b\.vx is discontinuous at the state at t = 0 s"):
        stiffmbs.modes(slider(law))


@pytest.mark.parametrize(
    "law", ["-b.x*abs(b.x) - b.x", "-5*tanh(b.vx/0.001)", "-50*max(b.x - 1e-3, 0)", "0", "-1e9*b.x"]
)
def test_smooth_laws_have_no_note(law):
    assert not stiffmbs.modes(slider(law)).sides
