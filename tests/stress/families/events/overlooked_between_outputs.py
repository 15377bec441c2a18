"""Features of laws that are far narrower than a step, with no output between the start and the end of the run, against closed forms."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from stiffmbs.elements.body import Body
from stiffmbs.elements.forces.python_force import PythonForce
from stiffmbs.elements.planar_kinds import FORCES
from stiffmbs.model.model import Model
from stiffmbs.model.read_scene import read_scene
from stiffmbs.model.scene import Scene
from stiffmbs.results.solution import Solution

from ...case import Case
from ...simulation import simulation

SOLVERS: dict[str, dict[str, Any]] = {
    "bdf": {"solver": "bdf"},
    "dop853": {"solver": "projected", "scheme": "dop853"},
    "dopri5": {"solver": "projected", "scheme": "dopri5"},
    "auto": {"solver": "auto"},
}
SPEED, HEIGHT, WIDTH = 10.0, 1e4, 1e-3
"""Of a body of 1 kg, m/s, and of a needle in a force on its way, N and m."""
AREA = np.sqrt(np.pi)
"""Below exp(-z^2)."""
PLACES = 1.2337, 5.0031, 8.7771
"""Of needles, m."""
SPIN = 20.0
"""Of a wheel of 1 kg m^2, rad/s."""
PUSH, PART, AT_SPEED, SPEEDS = 10.0, 0.01, 4.9991, 1e-3
"""A constant force on 1 kg from rest, N, and what part of it is left in a narrow range of speeds, m/s."""


@dataclass(frozen=True)
class Feature:
    """What is passed between two outputs.

    Attributes
    ----------
    what : str
    scene : callable
        Describes it.
    channel, expected : str, float
        What shows it at the end of the run.
    quick : bool
        Whether it is solved within a tenth of a second.
    """

    what: str
    scene: Callable[[], Model | Scene]
    channel: str
    expected: float
    quick: bool = True


def moving(*forces: str, dimensions: int = 2) -> Scene:
    """1 kg at 10 m/s along x, under forces along x."""
    zeros = ", 0" * (dimensions - 1)
    inertia = "1" if dimensions == 2 else "[1, 1, 1]"
    return read_scene(
        f"dimensions: {dimensions}\ngravity: [0{zeros}]\n"
        f"bodies: {{b: {{mass: 1, inertia: {inertia}, velocity: [{SPEED}{zeros}]}}}}\nforces:\n"
        + "".join(f"  f{k}: {{type: force, i: b, force: ['{force}'{zeros}]}}\n" for k, force in enumerate(forces))
    )


def needle(place: float) -> str:
    """A force over x."""
    return f"{HEIGHT}*exp(-((b.x - {place})/{WIDTH})^2)"


def table() -> Scene:
    """A spring from x = -10 m whose law has a tooth of straight lines."""
    points = [[0, 0], [15, 0], [15 + WIDTH, -HEIGHT], [15 + 2 * WIDTH, 0], [40, 0]]
    return read_scene(
        f"gravity: [0, 0]\nbodies: {{b: {{mass: 1, inertia: 1, velocity: [{SPEED}, 0]}}}}\nforces:\n"
        "  f: {type: spring_damper, i: b, j: {body: ground, point: [-10, 0]}, "
        f"spring_law: {{table: {points}, lines: true}}}}\n"
    )


def function(of_x: Callable[[float], float]) -> Model:
    """1 kg at 10 m/s under a force by a Python function of x, N."""
    model = Model("Function", gravity=(0, 0))
    model.add("b", Body(mass=1, inertia=1, velocity=(SPEED, 0)))
    model.add("f", PythonForce(i="b", of=("b.x",), function=lambda x: (of_x(x[0]), 0, 0)))
    return model


def beads() -> Scene:
    """Two equal elastic beads of 1 mm, one at rest in the way of the other: they are in contact for some microseconds."""
    return read_scene(
        "gravity: [0, 0]\nbodies:\n"
        f"  a: {{mass: 0.01, inertia: 1e-8, velocity: [{SPEED}, 0]}}\n"
        "  b: {mass: 0.01, inertia: 1e-8, position: [5, 0]}\n"
        "forces: {c: {type: contact, i: a, j: b, radius: 0.5 mm, surface: circle, surface_radius: 0.5 mm, stiffness: 1e9}}"
    )


def wheel() -> Model:
    """A wheel that passes a needle in a torque over its angle."""
    model = Model("Wheel", gravity=(0, 0))
    model.add("wheel", Body(mass=1, inertia=1, omega=SPIN))
    law = f"{HEIGHT}*exp(-((wheel.angle - {PLACES[1]})/{WIDTH})^2)"
    model.add("torque", FORCES["torque"](i="wheel", torque=law))
    return model


def driven() -> Scene:
    """1 kg from rest under a force that nearly ends in a narrow range of speeds."""
    law = f"{PUSH}*(1 - {1 - PART}*branch(abs(b.vx - {AT_SPEED}) - {SPEEDS}, 1, 0, 0))"
    return read_scene(
        f"gravity: [0, 0]\nbodies: {{b: {{mass: 1, inertia: 1}}}}\nforces: {{f: {{type: force, i: b, force: ['{law}', 0]}}}}"
    )


def _window(x: float) -> float:
    return HEIGHT if abs(x - PLACES[1]) < WIDTH else 0.0


def _gaussian(x: float) -> float:
    return float(HEIGHT * np.exp(-(((x - PLACES[1]) / WIDTH) ** 2)))


def _after(work: float, speed: float = SPEED) -> float:
    return float(np.sqrt(speed**2 + 2 * work))


NEEDLE = HEIGHT * WIDTH * AREA
FEATURES: dict[str, Feature] = {
    "a needle": Feature("work of a Gaussian of 1 mm", lambda: moving(needle(PLACES[1])), "b.vx", _after(NEEDLE)),
    "three needles": Feature("work of three", lambda: moving(*map(needle, PLACES)), "b.vx", _after(3 * NEEDLE)),
    "a needle in space": Feature("as in the plane", lambda: moving(needle(PLACES[1]), dimensions=3), "b.vx", _after(NEEDLE)),
    "a tooth of a table": Feature("work of a tooth of 2 mm", table, "b.vx", _after(HEIGHT * WIDTH)),
    "a needle of damping": Feature(
        "dv/dx = -c(x)", lambda: moving(f"-1000*exp(-((b.x - {PLACES[1]})/{WIDTH})^2)*b.vx"), "b.vx", SPEED - 1000 * WIDTH * AREA,
    ),
    "two beads": Feature("equal masses change their speeds", beads, "b.vx", SPEED),
    "a stop": Feature("the body comes back as fast", lambda: moving(f"-1e10*max(0, b.x - {PLACES[1]})"), "b.vx", -SPEED),
    "a needle over an angle": Feature("work of a torque", wheel, "wheel.omega", _after(NEEDLE, SPIN)),
    "a range of speeds": Feature(
        "time that is lost in it", driven, "b.vx", PUSH - 2 * SPEEDS * (1 / PART - 1),
    ),
    "a needle by a Python function": Feature("work of it", partial(function, _gaussian), "b.vx", _after(NEEDLE), quick=False),
    "a window by a Python function": Feature("work of it", partial(function, _window), "b.vx", _after(2 * HEIGHT * WIDTH), quick=False),
}  # fmt: skip


def _off(feature: Feature, solution: Solution) -> float:
    return float(abs(solution[feature.channel][-1] / feature.expected - 1))


def _case(name: str, feature: Feature, solver: str) -> Case:
    return simulation(
        f"{name}, {solver}", f"{feature.what}; 2 outputs", feature.scene, partial(_off, feature), 1e-3,
        quick=feature.quick and solver == "bdf", duration=1.0, points=2, rtol=1e-6, **SOLVERS[solver],
    )  # fmt: skip


CASES = tuple(_case(name, feature, solver) for name, feature in FEATURES.items() for solver in SOLVERS)
