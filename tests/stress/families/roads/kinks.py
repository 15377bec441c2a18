"""Forces of springs and dampers over kinks: event functions that are discontinuous at zero, and sliding modes."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from stiffmbs.model.read_scene import read_scene
from stiffmbs.model.scene import Scene
from stiffmbs.results.solution import Solution

from ...case import Outcome
from ...roads.wheel_over_lines import Lines, SprungPoint
from ...simulation import simulation

SOLVERS: dict[str, dict[str, Any]] = {
    "bdf": {"solver": "bdf"},
    "dop853": {"solver": "projected", "scheme": "dop853"},
    "dopri5": {"solver": "projected", "scheme": "dopri5"},
    "auto": {"solver": "auto"},
}
PROFILES = {
    "crest": [[-100, 0], [2, 0], [12, 1], [22, 0], [200, 0]],
    "kerb": [[-100, 0], [5, 0], [5.05, 0.1], [200, 0.1]],
    "pothole": [[-100, 0], [5, 0], [5.1, -0.06], [5.6, -0.06], [5.7, 0], [200, 0]],
    "bump": [[-100, 0], [5, 0], [5.3, 0.05], [5.6, 0.05], [5.9, 0], [200, 0]],
}
"""Height over x of piecewise linear roads, m."""
MASS, RADIUS, STIFFNESS, HEIGHT = 400.0, 0.344, 280e3, 0.33
POINTS, WAY = 151, 30.0
"""Number of outputs, and the distance along the road, m."""


def wheel(profile: str, speed: float, damping: float) -> Scene:
    """Return a wheel in space on a vertical tyre."""
    return read_scene(
        "dimensions: 3\ngravity: [0, 0, -9.81]\n"
        f"roads: {{r: {{type: table, profile: {{table: {PROFILES[profile]}, lines: true}}}}}}\n"
        f"bodies: {{b: {{mass: {MASS}, inertia: [12, 2, 12], position: [0, 0, {HEIGHT}], velocity: [{speed}, 0, 0], "
        f"omega: [0, {speed / HEIGHT}, 0]}}}}\n"
        f"forces: {{f: {{type: vertical_tyre, i: b, road: r, radius: {RADIUS}, stiffness: {STIFFNESS}, damping: {damping}}}}}"
    )


def follower(profile: str, speed: float, damping: float) -> Scene:
    """Return a point in the plane supported by a formula."""
    x, z = np.array(PROFILES[profile], dtype=float).T
    slopes = np.diff(z) / np.diff(x)
    bends = zip(x[1:-1], np.diff(slopes), strict=True)
    slope = " + ".join(
        f"({bend.item()!r})*branch(b.x - {place.item()!r}, 0, 1, 1)" for place, bend in bends if bend != 0.0
    )
    deflection = f"(h(b.x) + {RADIUS} - b.y)"
    load = f"{STIFFNESS}*{deflection} + {damping}*(({slope})*b.vx - b.vy)"
    return read_scene(
        f"gravity: [0, -9.81]\ntables: {{h: {{table: {PROFILES[profile]}, lines: true}}}}\n"
        f"bodies: {{b: {{mass: {MASS}, inertia: 1, position: [0, {HEIGHT}], velocity: [{speed}, 0]}}}}\n"
        f"forces: {{f: {{type: force, i: b, force: [0, 'branch({deflection}, 0, 0, max(0, {load}))']}}}}"
    )


def _off(solution: Solution, profile: str, speed: float, damping: float, upright: bool) -> float:
    lines = Lines(*np.array(PROFILES[profile], dtype=float).T)
    point = SprungPoint(lines, MASS, RADIUS, STIFFNESS, damping, upright)
    motion = point.motion((0.0, HEIGHT, speed, 0.0), solution.t)
    height = solution["b.y" if upright else "b.z"]
    return float(max(np.abs(solution["b.x"] - motion[:, 0]).max(), np.abs(height - motion[:, 1]).max()))


def belts() -> Scene:
    """Return a block that slides on two belts in succession: it enters the second belt slower, and reaches its speed at 4.74 s."""
    return read_scene(
        "gravity: [0, 0]\nbodies: {b: {mass: 1, inertia: 1, velocity: [0.8, 0]}}\n"
        "forces: {f: {type: force, i: b, force: ['-0.1*sign(b.vx - branch(b.x - 1, 0.2, 1, 1))', 0]}}"
    )


CROSSED = float(np.sqrt(0.64 - 0.2))
"""Speed of the block as it reaches the second belt, m/s."""
SLIDES = (0.8 - CROSSED) / 0.1 + (1 - CROSSED) / 0.1
"""Time at which it has the speed of the second belt, s."""


def _before(solution: Solution) -> float:
    """Compare with x = 1 + v t + a t^2/2 on the second belt, up to the stop."""
    late = solution.t - (0.8 - CROSSED) / 0.1
    expected = np.where(late < 0, 0.8 * solution.t - 0.05 * solution.t**2, 1 + CROSSED * late + 0.05 * late**2)
    return float(np.abs(solution["b.x"] - expected)[solution.t < SLIDES].max() + abs(solution.t[-1] - SLIDES) // 0.1)


CASES = (
    *(
        simulation(
            f"{name} over a {profile} at {speed:g} m/s, damping {damping:g}, {solver}, {rtol:g}", "path against the regimes of the motion",
            partial(scene, profile, speed, damping), partial(_off, profile=profile, speed=speed, damping=damping, upright=upright),
            allowed, duration=WAY / speed, points=POINTS, rtol=rtol, quick=solver == "auto", **SOLVERS[solver],
        )
        for name, scene, upright, damping in (
            ("wheel", wheel, False, 50.0), ("wheel", wheel, False, 500.0), ("wheel", wheel, False, 0.0), ("point", follower, True, 50.0),
            ("point", follower, True, 500.0),
        )
        for profile in PROFILES
        for speed, solver, rtol, allowed in (
            (5.0, "bdf", 1e-10, 2e-6), (20.0, "auto", 1e-10, 2e-6), (30.0, "dop853", 1e-10, 2e-6), (30.0, "dopri5", 1e-10, 2e-6),
            (20.0, "bdf", 1e-5, 5e-3), (20.0, "dop853", 1e-5, 5e-3), (10.0, "auto", 1e-4, 3e-2),
        )
    ),
    *(
        simulation(
            f"two belts, {solver}, rtol {rtol:g}", "stops on the second belt, not where it is met", belts, _before, 1e-2,
            names=("t = 4.7", "chatters"), expected=Outcome.TOLD, duration=8.0, points=401, rtol=rtol, **how,
        )
        for solver, how in SOLVERS.items()
        for rtol in (1e-4, 1e-7)
    ),
)  # fmt: skip
