"""The double pendulum of two bars: as a scene, and by its two Euler-Lagrange equations."""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp

from stiffmbs.elements.body import Body
from stiffmbs.elements.planar_kinds import JOINTS
from stiffmbs.model.model import Model
from stiffmbs.reading.marker import Marker

from .pendulum import GRAVITY


def double_pendulum(length: float = 1.0, masses: tuple[float, float] = (1.0, 1.0)) -> Model:
    """Two bars of one length, hinged to the ground and to each other, let go from the horizontal."""
    model = Model("Double pendulum", gravity=(0, -GRAVITY))
    end: Marker | str = "ground"
    for k, (name, mass) in enumerate(zip(("inner", "outer"), masses, strict=True)):
        bar = model.add(name, Body(mass=mass, inertia=mass * length**2 / 12, position=((k + 0.5) * length, 0)))
        model.add(("shoulder", "elbow")[k], JOINTS["revolute"](i=bar.at(-length / 2, 0), j=end))
        end = bar.at(length / 2, 0)
    return model


def angles(t: np.ndarray, length: float = 1.0, masses: tuple[float, float] = (1.0, 1.0)) -> np.ndarray:
    """The bars' angles from the horizontal, shape (len(t), 2), by scipy's DOP853 at rtol 1e-13.

    M(a, b) (a'', b'') = Q with the masses at their centres: Goldstein, Classical Mechanics, ch. 1.6.
    """
    m, n = np.array(masses) / max(masses)
    g = GRAVITY / length

    def rates(_: float, y: np.ndarray) -> list[float]:
        """The rates of both angles and of their speeds."""
        a, b, v, w = y
        c, s = np.cos(a - b), np.sin(a - b)
        mass = np.array([[m / 3 + n, n / 2 * c], [n / 2 * c, n / 3]])
        force = [-n / 2 * s * w * w - (m / 2 + n) * g * np.cos(a), n / 2 * s * v * v - n / 2 * g * np.cos(b)]
        return [v, w, *np.linalg.solve(mass, force)]

    solution = solve_ivp(rates, (0, t[-1] or 1.0), np.zeros(4), "DOP853", t_eval=t, rtol=1e-13, atol=1e-13)
    return solution.y[:2].T
