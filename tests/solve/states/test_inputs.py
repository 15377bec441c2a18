"""Inputs of a model: constants, functions, tables; in runs and linear responses."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs import AppliedForce, Body, Model, Prismatic
from stiffmbs.errors import InputError

SCENE = """
inputs: {push: 2 N, way: 0 m}
bodies: {cart: {mass: 2, inertia: 1}, slide: {mass: 1, inertia: 1, position: [0, 1]}}
joints:
  rail: {type: prismatic, i: cart, j: ground}
  guide: {type: prismatic, i: slide, j: {body: ground, point: [0, 1]}}
  follow: {type: drive, joint: guide, position: way}
forces: {motor: {type: force, i: cart, force: [push, 0]}}
requests: {twice: 2*push}
run: {duration: 1, points: 11, rtol: 1e-10}
"""
T = np.linspace(0, 1, 11)


@pytest.mark.parametrize(
    ("push", "x"),
    [(None, T**2 / 2), (6, 1.5 * T**2), (lambda t: 6 * t, T**3 / 2), (([0, 2], [0, 12]), T**3 / 2)],
    ids=["described", "constant", "function", "times and values"],
)
def test_an_input_is_what_a_run_gives(push, x):
    given = {} if push is None else {"inputs": {"push": push}}
    solution = stiffmbs.run(stiffmbs.read_scene(SCENE), **given)
    assert solution["cart.x"] == pytest.approx(x, abs=1e-9)
    assert solution["twice"] == pytest.approx(2 * solution["push"], abs=1e-12)


def test_a_drive_follows_an_input():
    solution = stiffmbs.run(stiffmbs.read_scene(SCENE), inputs={"way": ([0, 1], [0, 0.3])})
    assert solution["slide.x"] == pytest.approx(0.3 * T, abs=1e-9)


def test_a_model_of_python_has_inputs():
    model = Model("pushed")
    model.add("cart", Body(mass=2, inertia=1))
    model.add("rail", Prismatic(i="cart", j="ground"))
    model.add_input("push", "2 N")
    model.add("motor", AppliedForce(i="cart", force=("push", 0)))
    again = stiffmbs.read_scene(model.to_scene())
    for made in (model, again):
        solution = stiffmbs.run(made, duration=1.0, points=11, inputs={"push": 4.0})
        assert solution["cart.x"] == pytest.approx(T**2, abs=1e-6)


def test_the_response_to_an_input():
    text = SCENE.replace("[push, 0]", '["push - 8*cart.x - cart.vx", 0]')
    found = stiffmbs.transfer(stiffmbs.read_scene(text), ["push"], ["cart.x"])
    s = 2j * np.pi * np.array([0.1, 0.3, 2.0])
    assert found.response(s.imag / (2 * np.pi))[:, 0, 0] == pytest.approx(1 / (2 * s**2 + s + 8), rel=1e-7)


@pytest.mark.parametrize(
    ("inputs", "message"),
    [
        ({"pull": 1}, "found no input 'pull', expected one of push, way"),
        ({"push": np.nan}, "expected a finite number"),
        ({"push": ([0, 1], [1])}, "expected as many values as times"),
    ],
)
def test_faults_are_told_in_a_sentence(inputs, message):
    with pytest.raises(InputError, match=message):
        stiffmbs.run(stiffmbs.read_scene(SCENE), inputs=inputs)


@pytest.mark.sampled(4)
@pytest.mark.parametrize(
    ("law", "push"),
    [
        ("step(t, push, 0, push + 1e-4, 1) - step(t, push + 2e-4, 0, push + 3e-4, 1)", 0.5),
        ("step(push, 0.5, 0, 0.5001, 1) - step(push, 0.5002, 0, 0.5003, 1)", ([0, 1], [0, 1])),
        ("step(push, 0.5, 0, 0.5001, 1) - step(push, 0.5002, 0, 0.5003, 1)", lambda t: t),
    ],
    ids=["time as a number", "table of time", "function of time"],
)
@pytest.mark.parametrize("solver", ["bdf", "radau", "projected"])
def test_a_pulse_that_an_input_determines_is_not_missed(solver, law, push):
    """A force of 2e4 N for 2e-4 s in the mean changes the velocity of 2 kg by 2 m/s."""
    text = SCENE.replace("push: 2 N", "push: 0").replace("force: [push, 0]", f'force: ["2e4*({law})", 0]')
    solution = stiffmbs.run(stiffmbs.read_scene(text), inputs={"push": push}, solver=solver)
    assert solution["cart.vx"][-1] == pytest.approx(2.0, abs=1e-6)
