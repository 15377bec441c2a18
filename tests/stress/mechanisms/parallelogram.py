"""The parallelogram of equal cranks, which moves like a pendulum, as a scene and in closed form."""

from __future__ import annotations

import numpy as np

from stiffmbs.elements.body import Body
from stiffmbs.elements.planar_kinds import JOINTS
from stiffmbs.model.model import Model
from stiffmbs.reading.marker import Marker
from stiffmbs.results.solution import Solution

from .pendulum import GRAVITY, swing


def parallelogram(cranks: int = 2, angle: float = -np.pi / 4, omega: float = 0.0) -> Model:
    """A coupler of 1 m and 1 kg on cranks of 1 m and 1 kg, at an angle of the cranks from the x axis, turning at omega.

    At 0 and 180 degrees all links lie on one line: there the parallelogram could fold over.
    """
    model = Model("Parallelogram", gravity=(0, -GRAVITY))
    c, s = float(np.cos(angle)), float(np.sin(angle))
    across = (-omega * s, omega * c)
    coupler = model.add("coupler", Body(mass=1, inertia=1 / 12, position=(0.5 + c, s), velocity=across))
    for k in range(cranks):
        foot = k / (cranks - 1)
        place, velocity = (foot + c / 2, s / 2), (across[0] / 2, across[1] / 2)
        crank = model.add(
            f"crank{k}", Body(mass=1, inertia=1 / 12, position=place, angle=angle, velocity=velocity, omega=omega)
        )
        model.add(f"crank{k}_base", JOINTS["revolute"](i=crank.at(-0.5, 0), j=Marker(body="ground", point=(foot, 0))))
        model.add(f"crank{k}_top", JOINTS["revolute"](i=crank.at(0.5, 0), j=coupler.at(foot - 0.5, 0)))
    return model


def swing_error(solution: Solution) -> float:
    """Largest error of the first crank's angle on the branch on which cranks stay parallel.

    The inertia about the feet is n/3 + 1 and the weight's arm n/2 + 1, of n cranks and the coupler.
    """
    n = sum(name.startswith("crank") and name.endswith(".omega") for name in solution)
    rate = np.sqrt(GRAVITY * (n / 2 + 1) / (n / 3 + 1))
    start, speed = solution["crank0.angle"][0] + np.pi / 2, solution["crank0.omega"][0]
    expected = swing(solution.t - solution.t[0], start, rate, speed)
    return float(np.max(np.abs(solution["crank0.angle"] + np.pi / 2 - expected)))
