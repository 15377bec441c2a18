"""The benchmark bicycle of Meijaard, Papadopoulos, Ruina and Schwab, Proc. R. Soc. A 463, 2007: two knife-edged wheels, a rear
frame with a rigid rider, and a front fork; x ahead, z down.
"""

from __future__ import annotations

import math

import numpy as np

from stiffmbs.model.read_scene import read_scene
from stiffmbs.model.scene import Scene

GRAVITY = 9.81
MASS = np.array([[80.81722, 2.31941332208709], [2.31941332208709, 0.29784188199686]])
DAMPING = np.array([[0.0, 33.86641391492494], [-0.85035641456978, 1.68540397397560]])
"""Damping matrix divided by the speed."""
STIFFNESS = np.array([[-80.95, -2.59951685249872], [-2.59951685249872, -0.80329488458618]])
"""Stiffness matrix divided by gravity."""
STIFFNESS_BY_SPEED = np.array([[0.0, 76.59734589573222], [0.0, 2.65431523794604]])
"""Stiffness matrix divided by the square of the speed."""

WHEEL = """
  {name}_touch: {{type: equation, zero: "dz({name}) + {radius} m*{across}"}}
  {name}_grip:
    type: velocity_equation
    zero:
      - "vx({name}) + {radius} m*(wy({name})*{across} + wz({name})*dy({name}.axis, {name})/(1 m)*{down}/{across})"
      - "vy({name}) - {radius} m*(wx({name})*{across} + wz({name})*dx({name}.axis, {name})/(1 m)*{down}/{across})"
"""
BICYCLE = """
dimensions: 3
parameters: {{v: {speed!r} m/s, c: {cosine!r}, s: {sine!r}}}
gravity: [0, 0, 9.81]
bodies:
  rear:
    mass: 2
    inertia: [0.0603, 0.12, 0.0603]
    position: [0, 0, -0.3]
    velocity: [v, 0, 0]
    omega: [0, "-v/(0.3 m)", 0]
    markers: {{axis: {{point: [0, 1, 0]}}}}
  frame: {{mass: 85, inertia: [[9.2, 0, 2.4], [0, 11, 0], [2.4, 0, 2.8]], position: [0.3, 0, -0.9], velocity: [v, 0, 0]}}
  fork:
    mass: 4
    inertia: [[0.05892, 0, -0.00756], [0, 0.06, 0], [-0.00756, 0, 0.00708]]
    position: [0.9, 0, -0.7]
    velocity: [v, 0, 0]
  front:
    mass: 3
    inertia: [0.1405, 0.28, 0.1405]
    position: [1.02, 0, -0.35]
    velocity: [v, 0, 0]
    omega: [0, "-v/(0.35 m)", 0]
    markers: {{axis: {{point: [0, 1, 0]}}}}
joints:
  rear_hub:
    type: revolute
    i: {{body: rear, orientation: {{z: [0, 1, 0]}}}}
    j: {{body: frame, point: [-0.3, 0, 0.6], orientation: {{z: [0, 1, 0]}}}}
  front_hub:
    type: revolute
    i: {{body: front, orientation: {{z: [0, 1, 0]}}}}
    j: {{body: fork, point: [0.12, 0, 0.35], orientation: {{z: [0, 1, 0]}}}}
  head: # its axis meets the road at x = 1.1
    type: revolute
    i: {{body: fork, point: [0.2, 0, 0.7], orientation: {{z: [s, 0, c]}}}}
    j: {{body: frame, point: [0.8, 0, 0.9], orientation: {{z: [s, 0, c]}}}}
"""


def bicycle(speed: float) -> Scene:
    """Return the bicycle rolling upright and straight ahead.

    Parameters
    ----------
    speed : float
        m/s.
    """
    text = BICYCLE.format(speed=speed, cosine=math.cos(math.pi / 10), sine=math.sin(math.pi / 10))
    for name, radius in (("rear", 0.3), ("front", 0.35)):
        down = f"(dz({name}.axis, {name})/(1 m))"
        text += WHEEL.format(name=name, radius=radius, down=down, across=f"sqrt(1 - {down}^2)")
    return read_scene(text)


def published(speed: float) -> np.ndarray:
    """Return the eigenvalues of lean and steer from the published matrices, 1/s.

    Parameters
    ----------
    speed : float
        m/s.
    """
    stiffness = GRAVITY * STIFFNESS + speed**2 * STIFFNESS_BY_SPEED
    rates = -np.linalg.solve(MASS, np.hstack([stiffness, speed * DAMPING]))
    return np.asarray(np.linalg.eigvals(np.vstack([np.eye(2, 4, 2), rates])))
