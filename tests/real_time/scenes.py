"""A scene with an input, for steps in real time."""

import stiffmbs

DRIVEN = """
name: Driven cart
bodies:
  cart: {mass: 2 kg, inertia: 1 kg m^2}
inputs: {F: 1.0}
parameters: {c: 0.5 N s/m}
joints:
  rail: {type: prismatic, i: cart, j: ground}
forces:
  push: {type: force, i: cart, force: [F - c*vx(cart), 0]}
run: {duration: 0.2 s, output: 10 ms}
"""


def driven():
    return stiffmbs.read_scene(DRIVEN)
