"""Angles over whole turns at any output spacing, and tolerances that their rounding does not allow."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from stiffmbs import spatial
from stiffmbs.elements.body import Body
from stiffmbs.elements.planar_kinds import JOINTS
from stiffmbs.model.model import Model
from stiffmbs.results.solution import Solution

from ...case import Outcome
from ...simulation import simulation

HALF_A_TURN = np.pi + 0.3
"""Error of an angle from which on it has lost a turn: half of one, and the counter's own error."""


def wheel(speed: float, stiffness: float = 0.0, swing: float = 0.0) -> spatial.Model:
    """A wheel of 1 kg m^2 on a hinge, with a torsion spring, or with a torque that swings its speed at 50 rad/s."""
    model = spatial.Model("Wheel")
    model.add("wheel", spatial.Body(mass=1, inertia=(1, 1, 1), omega=(0, 0, speed)))
    model.add("pin", spatial.Revolute(i="wheel", j="ground"))
    if stiffness:
        model.add("spring", spatial.TorsionSpring(i="wheel", j="ground", stiffness=stiffness))
    if swing:
        model.add("push", spatial.AppliedTorque(i="wheel", torque=(0, 0, f"{50 * swing}*cos(50*t)")))
    model.request("turned", "az(wheel)")
    return model


def driven(law: str) -> spatial.Model:
    """Two wheels geared 2 to 1, the first driven by a law of time."""
    model = spatial.Model("Driven wheels")
    for k, name in enumerate(("first", "second")):
        model.add(name, spatial.Body(mass=1, inertia=(1, 1, 1), position=(k, 0, 0)))
        model.add(f"pin_{name}", spatial.Revolute(i=name, j=spatial.Marker(body="ground", point=(k, 0, 0))))
    model.add("mesh", spatial.Gear(joint_1="pin_first", joint_2="pin_second", ratio=-0.5))
    model.add("motor", spatial.Drive(joint="pin_first", position=law))
    model.request("turned", "az(second)")
    return model


def pendulum(speed: float) -> Model:
    """A bar of 1 m in the plane that turns fast."""
    model = Model("Fast pendulum", gravity=(0, -9.81))
    bar = model.add("bar", Body(mass=1, inertia=0.1, position=(1, 0), velocity=(0, speed), omega=speed))
    model.add("hinge", JOINTS["revolute"](i=bar.at(-1, 0), j="ground"))
    return model


def _sprung(solution: Solution, speed: float, stiffness: float) -> float:
    w = np.sqrt(stiffness)
    return float(np.max(np.abs(solution["turned"] - speed / w * np.sin(w * solution.time))))


def _swung(solution: Solution, speed: float, swing: float) -> float:
    t = solution.time
    return float(np.max(np.abs(solution["turned"] - speed * t - swing / 50 * (1 - np.cos(50 * t)))))


def _geared(solution: Solution, law: Any) -> float:
    return float(np.max(np.abs(solution["turned"] - 2 * law(solution.time))))


def _spring(points: int, quick: bool = True, **how: Any):
    return simulation(
        f"az at 3000 rad/s, {points} points, {', '.join(map(str, how.values()))}", "closed form, to half a turn",
        partial(wheel, 3000.0, 1e-3), partial(_sprung, speed=3000.0, stiffness=1e-3), HALF_A_TURN,
        duration=1.0, points=points, quick=quick, **how,
    )  # fmt: skip


def _swing(points: int, **how: Any):
    return simulation(
        f"az at 1000 rad/s swung by 800 rad/s, {points} points, {', '.join(map(str, how.values()))}",
        "closed form, to half a turn", partial(wheel, 1000.0, swing=800.0),
        partial(_swung, speed=1000.0, swing=800.0), HALF_A_TURN, duration=1.0, points=points, **how,
    )  # fmt: skip


def _law(law: str, value: Any, points: int, quick: bool = True):
    return simulation(
        f"az of a geared wheel, drive {law}, {points} points, kinematic", "the law", partial(driven, law),
        partial(_geared, law=value), 1e-8, duration=1.0, points=points, solver="kinematic", quick=quick,
    )  # fmt: skip


CASES = (
    _spring(1001, solver="projected", scheme="rk4", step=1e-3, quick=False),
    _spring(1001, rtol=1e-2),
    _spring(2, rtol=1e-2),
    _spring(11, rtol=1e-6),
    _spring(1001, solver="auto", quick=False),
    _spring(11, solver="projected", step=1e-4, quick=False),
    _swing(2, rtol=1e-2),
    _swing(7, solver="auto"),
    _swing(1001, solver="projected", scheme="rk4", step=1e-3),
    _swing(7, solver="projected", scheme="dopri5", rtol=1e-2),
    _law("3000*t", lambda t: 3000 * t, 2, quick=False),
    _law("300*t + 3*sin(40*t)", lambda t: 300 * t + 3 * np.sin(40 * t), 3),
    _law("100*sin(6*pi*t)", lambda t: 100 * np.sin(6 * np.pi * t), 2),
    simulation(
        "pendulum at 1e4 rad/s, rtol 1e-10", "told, as the angle's rounding does not allow the tolerance", partial(pendulum, 1e4),
        lambda solution: 0.0, 1.0, names=("is below rounding", "bar.angle"), expected=Outcome.TOLD, duration=1.0,
        points=11, rtol=1e-10, quick=False,
    ),
)  # fmt: skip
