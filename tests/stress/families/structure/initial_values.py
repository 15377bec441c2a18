"""Starts that miss their joints by 1e-1 to 1e-12: moved to the nearest pose, and told."""

from __future__ import annotations

from functools import partial

import numpy as np
from scipy.optimize import minimize

from stiffmbs.elements.body import Body
from stiffmbs.elements.planar_kinds import JOINTS
from stiffmbs.model.model import Model
from stiffmbs.results.solution import Solution

from ...case import Outcome
from ...mechanisms.pendulum import GRAVITY, bar_rate, swing
from ...simulation import refusal, simulation

TOLD_FROM = 1e-9


def invalid_placement(gap: float) -> Model:
    """A pendulum whose bar is drawn off its hinge, to the side and above."""
    model = Model("Misplaced", gravity=(0, -GRAVITY))
    bar = model.add("bar", Body(mass=1, inertia=1 / 12, position=(0.5 + gap, gap)))
    model.add("hinge", JOINTS["revolute"](i=bar.at(-0.5, 0), j="ground"))
    return model


def _nearest(gap: float) -> float:
    """The angle of the pose on the hinge that is nearest to the one drawn, with 1 rad as far as 1 m."""

    def distance(phi: np.ndarray) -> float:
        x, y = 0.5 * np.cos(phi[0]), 0.5 * np.sin(phi[0])
        return (x - 0.5 - gap) ** 2 + (y - gap) ** 2 + phi[0] ** 2

    return float(minimize(distance, [0.0], method="Nelder-Mead", options={"xatol": 1e-12, "fatol": 1e-24}).x[0])


def _error(solution: Solution, gap: float) -> float:
    """Motion from where it was put, the joint closed, and a place next to the nearest one.

    Newton's smallest moves end beside the nearest point, off by the square of the gap.
    """
    start = float(solution["bar.angle"][0])
    expected = swing(solution.t, start + np.pi / 2, bar_rate(1.0))
    motion = np.max(np.abs(solution["bar.angle"] + np.pi / 2 - expected))
    off = max(abs(start - _nearest(gap)) - gap**2, 0.0)
    return float(max(motion, off, np.max(solution["constraint.position"]) * 1e4))


def wrong_speed(speed: float) -> Model:
    """A pendulum whose bar is drawn moving along itself, which its hinge doesn't allow."""
    model = Model("Wrong speed", gravity=(0, -GRAVITY))
    bar = model.add("bar", Body(mass=1, inertia=1 / 12, position=(0.5, 0), velocity=(speed, 0)))
    model.add("hinge", JOINTS["revolute"](i=bar.at(-0.5, 0), j="ground"))
    return model


CASES = (
    *(
        simulation(
            f"off by {gap:.0e} m", "told; place against the nearest pose, motion against elliptic functions",
            partial(invalid_placement, gap), partial(_error, gap=gap), 1e-5,
            noted=("assembly changed bar",) if gap > TOLD_FROM else (),
            expected=Outcome.TOLD if gap > TOLD_FROM else Outcome.RIGHT, duration=2.0, points=101, rtol=1e-8,
        )
        for gap in (1e-1, 1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12)
    ),
    *(
        simulation(
            f"off by {speed:.0e} m/s", "told; motion against elliptic functions",
            partial(wrong_speed, speed), partial(_error, gap=0.0), 1e-5,
            noted=("assembly changed bar.vx",) if speed > TOLD_FROM else (),
            expected=Outcome.TOLD if speed > TOLD_FROM else Outcome.RIGHT, duration=2.0, points=101, rtol=1e-8,
        )
        for speed in (1e-1, 1e-6, 1e-12)
    ),
    refusal("off by 1e300 m", "too far for numbers", partial(invalid_placement, 1e300), ("position", "below 1e+100 m"), duration=2.0),
)  # fmt: skip
