"""Studies over values that stand in states and inputs: each case is that of a run by itself."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import stiffmbs
from stiffmbs import AppliedForce, Body, Model, Prismatic, State

SCENE = """
parameters: {tau: 0.1, k: 20, first: 0.0}
bodies: {cart: {mass: 2, inertia: 1, position: [0.3, 0]}}
states:
  lag: {rate: (cart.x - lag)/tau, start: first}
  twice: {numerator: [1], denominator: [tau, 1], input: 2*cart.x}
  alg: {zero: alg + tau*alg^3 - lag}
inputs: {push: 0.0}
joints: {rail: {type: prismatic, i: cart, j: ground}}
forces: {f: {type: force, i: cart, force: ["push - k*alg - twice", 0]}}
run: {duration: 0.5 s, points: 3}
"""


@pytest.mark.long
@pytest.mark.parametrize(
    ("name", "values"), [("tau", [0.1, 0.5, 1.0, 0.1]), ("inputs.push", [0.0, 5.0, 0.0]), ("first", [0.0, 0.2])]
)
def test_a_sweep_gives_what_single_runs_give(name, values):
    scene = stiffmbs.read_scene(SCENE)
    found = stiffmbs.sweep(scene, {name: values}, outputs={"end": "final(cart.x)"}, workers=1)["end"].values
    single = [stiffmbs.run(stiffmbs.read_scene(SCENE, [(name, str(value))]))["cart.x"][-1] for value in values]
    assert found == pytest.approx(single, abs=1e-12)
    assert np.ptp(single) > 1e-3


@pytest.mark.long
def test_a_sweep_over_what_a_drive_follows():
    text = SCENE.replace("joints: {rail", "joints: {motor: {type: drive, joint: rail, position: push*lag}, rail")
    text = text.replace("first: 0.0", "first: 0.3").replace("push: 0.0", "push: 1.0")
    found = stiffmbs.sweep(
        stiffmbs.read_scene(text), {"inputs.push": [1.0, 0.5]}, outputs={"end": "final(cart.x)"}, workers=1
    )
    single = [stiffmbs.run(stiffmbs.read_scene(text, [("inputs.push", v)]))["cart.x"][-1] for v in ("1.0", "0.5")]
    assert found["end"].values == pytest.approx(single, abs=1e-12)


@pytest.mark.parametrize("solver", ["bdf", "projected"])
def test_a_simulation_takes_the_inputs_of_its_model(solver):
    """Inputs that jump, in a force and in a state, against pieces that SciPy integrates; zero again in between."""
    model = Model("stepped")
    model.add("cart", Body(mass=2, inertia=1))
    model.add("rail", Prismatic(i="cart", j="ground"))
    model.add_input("push", 0.0)
    model.add_input("goal", 1.0)
    model.add("lag", State(rate="(goal*cart.x - lag)/0.2"))
    law = "push + 0.1*push^2 - 30*lag - 0.5*cart.vx - 4*cart.x^3"
    model.add("force", AppliedForce(i="cart", force=(law, 0)))
    simulation = stiffmbs.simulation(model, rtol=1e-10, solver=solver)
    exact = np.zeros(3)
    for push, goal in ((0.0, 1.0), (3.0, 1.0), (3.0, 1.3), (0.0, 1.0), (-2.0, 0.7), (0.0, 1.0)):
        simulation.step(0.25, inputs={"push": push, "goal": goal})
        simulation.step(0.125)
        piece = solve_ivp(
            lambda t, y, p=push, g=goal: [
                y[1],
                (p + 0.1 * p * p - 30 * y[2] - 0.5 * y[1] - 4 * y[0] ** 3) / 2,
                (g * y[0] - y[2]) / 0.2,
            ],
            (0, 0.375), exact, rtol=1e-12, atol=1e-13, method="DOP853",
        )  # fmt: skip
        exact = piece.y[:, -1]
        assert [simulation["cart.x"], simulation["cart.vx"], simulation["lag"]] == pytest.approx(exact, abs=1e-8)


@pytest.mark.parametrize(
    "push",
    [lambda t: 5 * np.sin(7 * t) + 3 * np.exp(-t), lambda t: 3.0 if t > 0.6543210 else 0.0],
    ids=["smooth", "jumps"],
)
def test_a_function_as_an_input_is_followed_between_the_output_instants(push):
    model = Model("pushed")
    model.add("cart", Body(mass=2, inertia=1))
    model.add("rail", Prismatic(i="cart", j="ground"))
    model.add_input("push", 0.0)
    model.add("force", AppliedForce(i="cart", force=("push - 30*cart.x - 4*cart.x^3", 0)))
    solution = model.run(duration=1.0, points=21, rtol=1e-10, solver="projected", inputs={"push": push})
    exact = np.zeros(2)
    for piece in ((0, 0.6543210), (0.6543210, 1.0)):
        inside = (piece[0] + 1e-12, piece[1] - 1e-12)
        exact = solve_ivp(
            lambda t, y, inside=inside: [y[1], (push(np.clip(t, *inside)) - 30 * y[0] - 4 * y[0] ** 3) / 2],
            piece, exact, rtol=1e-12, atol=1e-13, method="DOP853",
        ).y[:, -1]  # fmt: skip
    assert solution["cart.x"][-1] == pytest.approx(exact[0], abs=1e-9)
