"""Simulations whose inputs jump at every step: compiled starts of the integrator."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs import simulation
from stiffmbs.solve.ida.starting.starts import Starts

TOP = """
parameters: {M: 0 N m}
dimensions: 3
gravity: [0, 0, -9.81]
bodies: {top: {mass: 2, inertia: [0.02, 0.02, 0.01], position: [0, 0.1, 0.2], omega: [0, 0, 30], velocity: [-3, 0, 0], markers: {tip: {point: [0, -0.1, -0.2]}}}}
joints: {ball: {type: spherical, i: top.tip, j: ground}}
forces: {twist: {type: torque, i: top, torque: [M, 0, "0.1*sin(3*t)"]}}
run: {duration: 1, rtol: 1e-8}
"""
CART = "forces.spring.stiffness"
CASES = {
    "in the plane, with a coordinate less": ("cart_pendulum.yaml", CART, lambda k: 270.0 + 40.0 * np.sin(k), {}),
    "without presolve": ("cart_pendulum.yaml", CART, lambda k: 200.0 + 9.0 * k, {"presolve": False}),
    "integrated multipliers": ("cart_pendulum.yaml", CART, lambda k: 200.0 + 9.0 * k, {"formulation": "SI1"}),
    "a road with corners": ("half_car.yaml", "forces.front_bushing.stiffness.0", lambda k: 1e5 * (1 + k % 3), {}),
    "in space, with a torque over time": (TOP, "M", lambda k: 0.3 * (-1) ** k, {}),
}


def stepped(scene, name, value, settings, steps=40):
    """States after each step; what the integrator was started with may be looked at afterwards."""
    sim = simulation(scene, inputs={name: float(value(0))}, rtol=1e-8, **settings)
    states = []
    for k in range(steps):
        sim.step(0.02, inputs={name: float(value(k))})
        states.append(np.concatenate([sim.q, sim.u]))
    return np.array(states)


@pytest.mark.parametrize("case", CASES)
def test_compiled_starts_give_the_states_of_starts_by_python(case, examples, monkeypatch):
    source, name, value, settings = CASES[case]
    scene = stiffmbs.read_scene(source) if "\n" in source else stiffmbs.load_scene(examples / source)
    done, advance = [], Starts.advance

    def counted(*arguments):
        done.append(advance(*arguments))
        return done[-1]

    monkeypatch.setattr(Starts, "advance", counted)
    found = stepped(scene, name, value, settings)
    assert sum(done) > 25, "starts that were compiled"
    monkeypatch.setattr(Starts, "advance", lambda *arguments: False)
    off = (
        1e-8 if "over time" in case else 1e-11
    )  # how long a step may be follows from the stretch of time that is looked at
    np.testing.assert_allclose(found, stepped(scene, name, value, settings), atol=off, rtol=off)


@pytest.mark.long
def test_a_controlled_cart_is_where_its_minimal_equations_have_it():
    """As right as one run at the same tolerance, for all its starts."""
    from tests.bench.problems.stepping import SCENE, control, reference

    sim, places = simulation(stiffmbs.read_scene(SCENE), inputs={"F": 0.0}), []
    for _ in range(500):
        sim.step(1e-3, inputs={"F": control(sim["cart.x"], sim["cart.vx"])})
        places.append(sim["cart.x"])
    np.testing.assert_allclose(places, reference(1e-3, 500), rtol=0, atol=1e-8)


def test_states_are_not_overwritten_by_later_steps(examples):
    sim = simulation(examples / "cart_pendulum.yaml", inputs={CART: 270.0})
    sim.step(0.1, inputs={CART: 200.0})
    q, u = sim.q, sim.u
    sim.step(0.1, inputs={CART: 300.0})
    assert not np.any(q[:1] == sim.q[:1]) and not np.any(u[:1] == sim.u[:1])


def test_a_step_shorter_than_the_rounding_of_time_changes_nothing(examples):
    sim = simulation(examples / "cart_pendulum.yaml", inputs={CART: 270.0})
    sim.step(1.0)
    before = sim.q
    sim.step(1e-18, inputs={CART: 100.0})
    np.testing.assert_array_equal(sim.q, before)
    sim.step(0.01)
    assert sim["cart.x"] != before[0]
