"""A ball between two walls that it meets every millisecond, in closed form: free flight and half sines."""

from __future__ import annotations

import numpy as np

from stiffmbs.elements.body import Body
from stiffmbs.elements.planar_kinds import FORCES, JOINTS
from stiffmbs.model.model import Model
from stiffmbs.reading.marker import Marker
from stiffmbs.results.solution import Solution

from ...simulation import simulation

SPEED, GAP, STIFFNESS = 1.0, 0.5e-3, 1e9
RATE = np.sqrt(STIFFNESS)
FLIGHT, CONTACT = 2 * GAP / SPEED, np.pi / RATE
"""Of 1 kg: time from wall to wall, and time at a wall, s."""


def ball_between_walls() -> Model:
    """1 kg at 1 m/s in the middle between two elastic walls 1 mm apart, on a rail."""
    model = Model("Ball between walls")
    model.add("ball", Body(mass=1, inertia=1, velocity=(SPEED, 0)))
    model.add("rail", JOINTS["prismatic"](i="ball", j="ground"))
    for name, x, angle in (("right", GAP, np.pi / 2), ("left", -GAP, -np.pi / 2)):
        wall = Marker(body="ground", point=(x, 0), angle=angle)
        model.add(name, FORCES["contact"](i="ball", j=wall, stiffness=STIFFNESS, exponent=1.0))
    return model


def _place(t: np.ndarray) -> np.ndarray:
    """Where the ball is: to the right wall, a half sine there, back, and the same on the left."""
    half, phase = np.divmod(t + FLIGHT / 2, FLIGHT + CONTACT)
    flying = -GAP + SPEED * phase
    pressing = GAP + SPEED / RATE * np.sin(RATE * (phase - FLIGHT))
    return np.where(phase < FLIGHT, flying, pressing) * np.where(half % 2 == 0, 1.0, -1.0)


def _error(solution: Solution) -> float:
    return float(np.max(np.abs(solution["ball.x"] - _place(solution.t))) / GAP)


def dropped() -> Model:
    """A ball let go 1 mm above a floor of Hertz's law that keeps half its speed: its bounces grow ever shorter."""
    model = Model("Dropped ball", gravity=(0, -9.81))
    model.add("ball", Body(mass=1, inertia=1, position=(0, 1e-3)))
    model.add("floor", FORCES["contact"](i="ball", j="ground", stiffness=1e9, dissipation=5.0))
    return model


def _at_rest(solution: Solution) -> float:
    """Sag m g = k delta^1.5 at the end, relative to it, and a floor that carries the weight."""
    sag = (9.81 / 1e9) ** (2 / 3)
    return float(max(abs(solution["ball.y"][-1] / sag + 1), abs(solution["floor.fy"][-1] / 9.81 - 1)))


CASES = (
    *(
        simulation(
            f"{impacts} impacts, one a millisecond, rtol {rtol:.0e}", "the ball's place relative to the gap",
            ball_between_walls, _error, 1e-2, duration=impacts * (FLIGHT + CONTACT), points=2 * impacts + 1, rtol=rtol,
            quick=impacts <= 100,
        )
        for impacts, rtol in ((100, 1e-8), (1000, 1e-10))
    ),
    simulation(
        "bounces that come ever faster", "sag and force at rest, against k delta^1.5 = m g",
        dropped, _at_rest, 1e-3, duration=5.0, points=501, rtol=1e-8,
    ),
)  # fmt: skip
