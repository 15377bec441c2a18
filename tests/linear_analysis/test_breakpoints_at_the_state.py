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


def test_the_note_lists_the_eigenvalues_that_differ():
    """Bodies without forces have six eigenvalues of zero on both sides."""
    idle = ", ".join(f"idle_{k}: {{mass: 1, inertia: 1}}" for k in range(2))
    text = f'bodies: {{b: {{mass: 2, inertia: 1}}, {idle}}}\nforces: {{pull: {{type: force, i: b, force: ["-20*max(b.vx, 0)", 0]}}}}\n'
    (note,) = (each for each in stiffmbs.modes(stiffmbs.read_scene(text)).notes if "breakpoint" in each)
    assert "eigenvalues: -10" in note or "on one side, -10" in note


@pytest.mark.parametrize("law", ["-8*max(b.vx, 0) - 8*min(b.vx, 0)", "-branch(b.vx, 8*b.vx, 0, 8*b.vx)"])
def test_laws_whose_breakpoints_cancel_have_the_derivatives_of_both_sides(law):
    """On the breakpoint itself those of max and min are 1, and that of branch is of its middle value."""
    found = stiffmbs.modes(slider(law))
    assert not found.sides
    assert np.linalg.eigvals(found.state.matrix).real.min() == pytest.approx(-4)
    response = transfer(slider(law), ["b.fx"], ["b.vx"]).response(np.array([1.0]))
    assert response[0, 0, 0] == pytest.approx(1 / (2 * 2j * np.pi + 8))


def test_the_modes_at_a_breakpoint_are_those_of_a_side():
    found = stiffmbs.modes(slider("-8*max(b.vx, 0) - 20*min(b.vx, 0)"))
    rates = [np.linalg.eigvals(matrix).real.min() for matrix in (found.state.matrix, *(s.matrix for s in found.sides))]
    assert sorted(rates[1:]) == pytest.approx([-10, -4])
    assert min(abs(rates[0] - rate) for rate in rates[1:]) < 1e-9


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
    "law",
    [
        "-b.x*abs(b.x) - b.x",
        "-1e3*(b.x - 3e-7)*abs(b.x - 3e-7) - b.x",
        "-5*tanh(b.vx/0.001)",
        "-50*max(b.x - 1e-3, 0)",
        "0",
        "-1e9*b.x",
    ],
)
def test_smooth_laws_have_no_note(law):
    assert not stiffmbs.modes(slider(law)).sides


HANGING = """
dimensions: 3
gravity: [0, 0, -9.81]
bodies:
  b:
    mass: 2.4
    inertia: [[0.46, 0.04, -0.02], [0.04, 0.44, 0.01], [-0.02, 0.01, 0.47]]
    center_of_mass: [0.01, 0.2, -0.06]
    position: [0.3, 0.1, 1]
forces:
  spring:
    type: spring_damper
    i: {body: b, point: [-0.2, -0.3, -0.2]}
    j: {body: ground, point: [0.3, 0.5, 0.1]}
    stiffness: 15
    damping: 0.8
    free_length: 0.9
"""


@pytest.mark.long
def test_a_body_hanging_on_a_spring_is_at_no_breakpoint():
    """No stiffness acts on the rotation about the spring's line, only rounding of that on the other rotations."""
    scene = stiffmbs.read_scene(HANGING)
    rest = stiffmbs.equilibrium(scene).solution
    assert not stiffmbs.modes(scene, start_from=rest).sides
    response = transfer(scene, ["b.fz"], ["b.z"], start_from=rest).response(np.array([0.05]))
    s = 2j * np.pi * 0.05
    assert response[0, 0, 0] == pytest.approx(1 / (2.4 * s**2 + 0.8 * s + 15), rel=1e-6)
