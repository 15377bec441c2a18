"""Vehicles over piecewise linear crests, kerbs, potholes and speed bumps: solvers agree within a micrometre."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from stiffmbs.analyses.run import run
from stiffmbs.model.scene import Scene
from stiffmbs.solve.trajectory import Outcome as Ending

from ...case import Case, Outcome, Verdict, measured
from ...roads.vehicles import car, half_car, left_lines, lines, quarter_car
from ...simulation import PATIENCE, patience

SOLVERS: dict[str, dict[str, Any]] = {
    "bdf": {"solver": "bdf"},
    "dop853": {"solver": "projected", "scheme": "dop853"},
    "auto": {"solver": "auto"},
}
PROFILES: dict[str, list[list[float]]] = {
    "crest": [[-100, 0], [2, 0], [6, 0.4], [10, 0], [200, 0]],
    "kerb": [[-100, 0], [5, 0], [5.05, 0.1], [200, 0.1]],
    "pothole": [[-100, 0], [5, 0], [5.1, -0.06], [5.6, -0.06], [5.7, 0], [200, 0]],
    "bump": [[-100, 0], [5, 0], [5.3, 0.05], [5.6, 0.05], [5.9, 0], [200, 0]],
}
"""Height over x, m."""
SPEEDS = 5.0, 10.0, 15.0, 20.0, 25.0, 30.0
"""m/s."""
WAY, LEAST = 12.5, 0.8
"""Path along the road, m, and the shortest duration, s."""
AGREED = 1e-6
"""Bound on the difference of any two positions, m."""
RTOL_CARRIED, RTOL_CARS = 1e-9, 1e-8
"""Relative tolerances of all solvers.  Half a second without contact magnifies the error at the kink."""
CARRIED = {"quarter car": quarter_car, "half car": half_car}
CARS = {
    "car on bushings": (car("bushing"), lines),
    "car on ideal joints": (car("rigid"), lines),
    "car, left wheels": (car("bushing"), left_lines),
}


def _agreement(scene: Callable[[], Scene], speed: float, rtol: float) -> Verdict:
    """Compare the positions of all bodies at 101 output times."""
    found, steps, described = [], [], scene()
    names = [f"{body}.{axis}" for body in described.bodies for axis in "xyz"]
    for name, how in SOLVERS.items():
        solution = run(
            described, duration=max(WAY / speed, LEAST), points=101, rtol=rtol, watch=patience(PATIENCE), **how
        )
        if solution.outcome is not Ending.DONE:
            return Verdict(Outcome.WRONG, detail=f"{name}: {solution.message}")
        found.append(np.array([solution[channel] for channel in names]))
        steps.append(f"{name} {solution.solver['steps']} steps")
    apart = max(float(np.abs(a - b).max()) for a, b in zip(found, (*found[1:], found[0]), strict=True))
    return measured(apart, AGREED, ", ".join(steps))


def _case(
    vehicle: str, profile: str, speed: float, scene: Callable[[], Scene], rtol: float, quick: bool = False
) -> Case:
    name, what = f"{vehicle} over a {profile} at {speed:g} m/s", "positions of bdf, dop853 and auto against each other"
    return Case(name, what, partial(_agreement, scene, speed, rtol), quick=quick)


CASES = (
    *(
        _case(vehicle, profile, speed, partial(scene, lines(points), speed), RTOL_CARRIED, speed == 20.0)
        for vehicle, scene in CARRIED.items()
        for profile, points in PROFILES.items()
        for speed in SPEEDS
    ),
    *(
        _case(vehicle, profile, speed, partial(scene, road(points), speed), RTOL_CARS)
        for vehicle, (scene, road) in CARS.items()
        for profile, points in PROFILES.items()
        for speed in SPEEDS
    ),
)
