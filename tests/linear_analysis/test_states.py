"""Equilibrium, modes and frequency response with states of the user's own."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs import AlgebraicState, AppliedForce, Body, Model, Prismatic, State
from stiffmbs.errors import SolverError

MASS, KP, KI, KD, LOAD, TARGET = 2.0, 50.0, 30.0, 12.0, 7.0, 0.4


def controlled_cart():
    """A cart under a constant load, held at its target by a controller whose integral is a state."""
    model = Model("controlled cart")
    model.add("cart", Body(mass=MASS, inertia=1))
    model.add("rail", Prismatic(i="cart", j="ground"))
    model.add("sum", State(rate=f"{TARGET} - cart.x", start=0))
    law = f"{KP}*({TARGET} - cart.x) + {KI}*sum - {KD}*cart.vx - {LOAD}"
    model.add("control", AppliedForce(i="cart", force=(law, 0)))
    return model


def test_in_equilibrium_states_stay_as_they_are():
    found = stiffmbs.equilibrium(controlled_cart())
    assert found.channels["cart.x"] == pytest.approx(TARGET, abs=1e-10)
    assert found.channels["sum"] == pytest.approx(LOAD / KI, abs=1e-10)
    assert not found.notes


@pytest.mark.long
def test_a_state_that_cannot_come_to_rest_is_named(few_moves):
    model = controlled_cart()
    model.add("clock", State(rate=1, start=0))
    with pytest.raises(SolverError, match="the rate of the state clock stays"):
        stiffmbs.equilibrium(model)


def test_an_unstable_loop_is_told():
    model = controlled_cart()
    model.replace("sum", State(rate=f"20*({TARGET} - cart.x)", start=0))
    assert "unstable" in stiffmbs.equilibrium(model).notes[0]


def test_eigenvalues_are_the_roots_of_the_closed_loop():
    found = stiffmbs.modes(controlled_cart())
    values = sorted((v for mode in found.modes for v in mode.eigenvalues), key=lambda v: (v.real, v.imag))
    roots = sorted(np.roots([MASS, KD, KP, KI]), key=lambda v: (v.real, v.imag))
    assert values == pytest.approx(roots, rel=1e-9)
    assert found.degrees_of_freedom == 1
    assert [len(mode.eigenvalues) for mode in found.modes] == [1, 2]
    assert "1, 2" not in str(found.as_dict("scene"))


def test_the_frequency_response_goes_through_states():
    found = stiffmbs.transfer(controlled_cart(), ["cart.fx"], ["cart.x", "sum", "sum.rate"])
    frequencies = np.array([0.1, 1.0, 5.0])
    s = 2j * np.pi * frequencies
    compliance = 1 / (MASS * s**2 + KD * s + KP + KI / s)
    x, total, rate = found.response(frequencies)[:, :, 0].T
    assert x == pytest.approx(compliance, rel=1e-8)
    assert total == pytest.approx(-compliance / s, rel=1e-8)
    assert rate == pytest.approx(-compliance, rel=1e-8)


def test_algebraic_states_pass_on_states_to_rates_and_forces():
    """p = 2 w - 5 x - 3 v; w' = p - 6 w and m x'' = 4 p + 7 w - k x: the eigenvalues of the three equations without p."""
    model = Model()
    model.add("cart", Body(mass=2, inertia=1))
    model.add("rail", Prismatic(i="cart", j="ground"))
    model.add("w", State(rate="-w"))
    model.add("p", AlgebraicState(zero="2*p - 4*w + 10*cart.x + 6*cart.vx"))
    model.add("push", AppliedForce(i="cart", force=("4*p + 7*w - 50*cart.x", 0)))
    model.replace("w", State(rate="p - 6*w"))
    found = stiffmbs.modes(model)
    matrix = [[0, 1, 0], [(-20 - 50) / 2, -12 / 2, 15 / 2], [-5, -3, -4]]
    values = sorted((v for mode in found.modes for v in mode.eigenvalues), key=lambda v: (v.real, v.imag))
    assert values == pytest.approx(sorted(np.linalg.eigvals(matrix), key=lambda v: (v.real, v.imag)), rel=1e-8)


@pytest.mark.parametrize("K", [5, 9, -9])
def test_a_state_that_reads_a_reaction_comes_to_rest(K):
    """A push of K p on a pad whose reaction sets p: p = m g/(F0 - K)."""
    scene = stiffmbs.read_scene(f"""
gravity: [0, -9.81]
bodies: {{b: {{mass: 2, inertia: 1}}}}
joints: {{rail: {{type: prismatic, i: b, j: ground}}}}
states: {{p: {{rate: "fy(rail)/10 - p", start: 0}}}}
forces: {{f: {{type: force, i: b, force: ["3 - 50*b.x", "-({K})*p"]}}}}
""")
    found = stiffmbs.equilibrium(scene)
    assert found.channels["p"] == pytest.approx(2 * 9.81 / (10 - K), rel=1e-9)
    assert found.channels["rail.fy"] == pytest.approx(10 * 2 * 9.81 / (10 - K), rel=1e-9)
