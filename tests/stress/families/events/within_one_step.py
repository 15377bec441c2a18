"""Events that begin and end within one step of an integrator that nothing else holds back, against closed forms."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

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
SPEED, HEIGHT, WIDTH = 10.0, 500.0, 0.02
"""Of a body of 1 kg, m/s, and of the bump in a force that it passes, N and m."""
BUMPS: dict[str, tuple[str, float]] = {
    "exp(-z^2)": ("exp(-z^2)", np.sqrt(np.pi)),
    "tanh up and down": ("0.5*(tanh(z + 3) - tanh(z - 3))", 6.0),
    "1/(1 + z^2)": ("1/(1 + z^2)", 2 * np.arctan(250.0)),
    "1/cosh(z)": ("1/cosh(z)", np.pi),
    "max(0, 1 - z^2)": ("max(0, 1 - z^2)", 4 / 3),
    "branch by abs": ("branch(abs(z) - 1, 1, 0, 0)", 2.0),
    "step up and down": ("step(z, -2, 0, -1, 1)*step(z, 1, 1, 2, 0)", 3.0),
    "cos^20000": ("cos(z/100)^20000", 100 * np.sqrt(2 * np.pi / 20000.5)),
    "straight lines": ("lines(z)", 1.0),
    "Akima's cubics": ("akima(z)", 1.0),
}
"""Bumps of height 1 over z, in which WIDTH is 1, and the area below each."""
TABLES = """
tables:
  lines: {table: [[-1000, 0], [-1, 0], [0, 1], [1, 0], [1000, 0]], lines: true}
  akima: {table: [[-1000, 0], [-3, 0], [-2, 0], [-1, 0], [0, 1], [1, 0], [2, 0], [3, 0], [1000, 0]], akima: true}
"""


def passing(bump: str) -> Scene:
    """1 kg at 10 m/s that passes a bump in a force at x = 5 m."""
    law = f"{HEIGHT}*({bump.replace('z', f'((b.x - 5)/{WIDTH})')})"
    return read_scene(
        f"gravity: [0, 0]\n{TABLES}\nbodies: {{b: {{mass: 1, inertia: 1, velocity: [{SPEED}, 0]}}}}\n"
        f"forces: {{f: {{type: force, i: b, force: ['{law}', 0]}}}}"
    )


def _faster(solution: Solution, area: float) -> float:
    return float(abs(solution["b.vx"][-1] / np.sqrt(SPEED**2 + 2 * HEIGHT * WIDTH * area) - 1))


def balls(dimensions: int) -> Scene:
    """Two equal elastic balls, one at rest."""
    zero, contact, more = ("", "contact", "") if dimensions == 2 else (", 0", "sphere_contact", ", 5e-5, 5e-5")
    inertia = f"[5e-5{more}]" if more else "5e-5"
    surface = "circle" if dimensions == 2 else "sphere"
    return read_scene(
        f"dimensions: {dimensions}\ngravity: [0, 0{zero}]\nbodies:\n"
        f"  a: {{mass: 0.17, inertia: {inertia}, velocity: [2, 0{zero}]}}\n"
        f"  b: {{mass: 0.17, inertia: {inertia}, position: [1, 0{zero}]}}\n"
        f"forces: {{c: {{type: {contact}, i: a, j: b, radius: 28 mm, surface: {surface}, surface_radius: 28 mm, stiffness: 1e8}}}}"
    )


def ceiling(stop: str) -> Scene:
    """A ball thrown at 20 m/s at a ceiling 20 m above it."""
    return read_scene(
        f"gravity: [0, -9.81]\nbodies: {{b: {{mass: 1, inertia: 0.1, velocity: [0, 20]}}}}\nforces: {{c: {stop}}}"
    )


CEILING = "{type: contact, i: b, j: {body: ground, point: [0, 20], angle: 180 deg}, stiffness: 1e8}"
STOP = "{type: force, i: b, force: [0, '-1e8*max(0, b.y - 20)^1.5']}"
HOLE = "{type: contact, i: b, j: {body: ground, point: [0, 0]}, surface: hole, surface_radius: 20, stiffness: 1e8}"
UPWARD = (20 - np.sqrt(400 - 2 * 9.81 * 20)) / 9.81
"""Time of the way up, s."""
IMPACT = float(np.sqrt(400 - 2 * 9.81 * 20))
"""Speed at the ceiling, m/s."""
TOUCH = 2.9432 * (1.25 * IMPACT**2 / 1e8) ** 0.4 / IMPACT
"""Time that a ball of 1 kg is in contact by k delta^1.5, s (Johnson, Contact Mechanics, 1985, ch. 11.4)."""


def _thrown_back(solution: Solution) -> float:
    """The ball comes back as it went, but for the time of contact."""
    t = solution.t[-1] - UPWARD - TOUCH
    return float(abs(solution["b.y"][-1] - (20 - IMPACT * t - 9.81 / 2 * t**2)))


def _exchanged(solution: Solution) -> float:
    return float(max(abs(solution["b.vx"][-1] - 2), abs(solution["a.vx"][-1])))


def spinning() -> Scene:
    """A bar that turns 30 times a second and moves slowly along a wall it touches with a tip."""
    return read_scene(
        "gravity: [0, 0]\nbodies: {b: {mass: 1, inertia: 0.1, velocity: [1, 0], omega: 200, markers: {tip: {point: [0.2, 0]}}}}\n"
        "forces: {c: {type: contact, i: b.tip, j: {body: ground, point: [0.7, 0], angle: 90 deg}, stiffness: 1e7}}"
    )


def _spun(solution: Solution) -> float:
    """After a frictionless elastic blow J at the tip: omega changes by -arm J/I where vx changes by -J/m; energy stays."""
    vx, omega = solution["b.vx"][-1], solution["b.omega"][-1]
    energy = abs((vx**2 + 0.1 * omega**2) / (1 + 0.1 * 200**2) - 1)
    return float(energy if vx < 0.9 else 1.0)


def _each(
    name: str, what: str, scene: Callable[[], Scene], error: Callable[[Solution], float], allowed: float, **how: Any
) -> tuple[Case, ...]:
    """A case for each solver."""
    return tuple(
        simulation(f"{name}, {solver}", what, scene, error, allowed, **settings, **how)
        for solver, settings in SOLVERS.items()
    )


CASES = (
    *_each("two balls", "speeds exchanged", partial(balls, 2), _exchanged, 1e-3, duration=1.0, points=11),
    *_each("two balls in space", "speeds exchanged", partial(balls, 3), _exchanged, 1e-3, duration=1.0, points=11),
    *(
        case
        for name, stop in (("contact", CEILING), ("max(0, ...)", STOP), ("hole", HOLE))
        for case in _each(
            f"ball and ceiling by {name}", "height at the end against an elastic bounce", partial(ceiling, stop), _thrown_back,
            0.01, duration=4.08, points=2,
        )
    ),
    *(
        case
        for name, (bump, area) in BUMPS.items()
        for case in _each(
            f"bump {name} of 20 mm at 10 m/s", "speed behind it against the work in it", partial(passing, bump),
            partial(_faster, area=float(area)), 1e-3, duration=1.0, points=2,
        )
    ),
    *_each("spinning bar and wall", "energy, and that it bounced", spinning, _spun, 1e-3, duration=1.0, points=2),
)  # fmt: skip
