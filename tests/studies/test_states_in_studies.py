"""Studies over values that stand in states and inputs: each case is that of a run by itself."""

import numpy as np
import pytest

import stiffmbs

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


@pytest.mark.parametrize(
    ("name", "values"), [("tau", [0.1, 0.5, 1.0, 0.1]), ("inputs.push", [0.0, 5.0, 0.0]), ("first", [0.0, 0.2])]
)
def test_a_sweep_gives_what_single_runs_give(name, values):
    scene = stiffmbs.read_scene(SCENE)
    found = stiffmbs.sweep(scene, {name: values}, outputs={"end": "final(cart.x)"}, workers=1)["end"].values
    single = [stiffmbs.run(stiffmbs.read_scene(SCENE, [(name, str(value))]))["cart.x"][-1] for value in values]
    assert found == pytest.approx(single, abs=1e-12)
    assert np.ptp(single) > 1e-3


def test_a_sweep_over_what_a_drive_follows():
    text = SCENE.replace("joints: {rail", "joints: {motor: {type: drive, joint: rail, position: push*lag}, rail")
    text = text.replace("first: 0.0", "first: 0.3").replace("push: 0.0", "push: 1.0")
    found = stiffmbs.sweep(
        stiffmbs.read_scene(text), {"inputs.push": [1.0, 0.5]}, outputs={"end": "final(cart.x)"}, workers=1
    )
    single = [stiffmbs.run(stiffmbs.read_scene(text, [("inputs.push", v)]))["cart.x"][-1] for v in ("1.0", "0.5")]
    assert found["end"].values == pytest.approx(single, abs=1e-12)
