"""Many output points within one long step of a solver: all are there, and right."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from stiffmbs.elements.body import Body
from stiffmbs.elements.planar_kinds import FORCES, JOINTS
from stiffmbs.model.model import Model
from stiffmbs.results.solution import Solution

from ...mechanisms.pendulum import GRAVITY
from ...simulation import simulation


def flying(**body: Any) -> Model:
    """1 kg in free flight."""
    model = Model("Flight", gravity=(0, -GRAVITY))
    model.add("stone", Body(mass=1, inertia=1, velocity=(3, 4), **body))
    return model


def swinging() -> Model:
    """1 kg on a rail, held by 1 N/m."""
    model = Model("Oscillator")
    model.add("stone", Body(mass=1, inertia=1, position=(1, 0)))
    model.add("rail", JOINTS["prismatic"](i="stone", j="ground"))
    model.add("spring", FORCES["force"](i="stone", force=("-stone.x", 0)))
    return model


def stiffened() -> Model:
    """1 kg on a rail whose soft spring becomes a stiff, damped one about where it is from 0.3 s on."""
    model = swinging()
    model.add("damper", FORCES["force"](i="stone", force=("-1e5*step5(t, 0.3, 0, 0.5, 1)*stone.vx", 0)))
    return model


def _flight(solution: Solution, start: float = 0.0) -> float:
    t = solution.t - start
    return float(np.max(np.abs(solution["stone.y"] - 4 * t + GRAVITY / 2 * t**2)))


def _cosine(solution: Solution) -> float:
    return float(np.max(np.abs(solution["stone.x"] - np.cos(solution.t))))


def _spacing(solution: Solution, output: float) -> float:
    """Largest deviation of the output points' spacing, relative to it."""
    return float(np.max(np.abs(np.diff(solution.t) / output - 1)))


def _case(name: str, scene: Any, error: Any, allowed: float, **how: Any):
    solver = how.get("scheme", how["solver"])
    return simulation(f"{name}, {solver}", "all output points; way in closed form", scene, error, allowed, **how)


WAYS: tuple[dict[str, Any], ...] = ({"solver": "auto"}, {"solver": "bdf"}, {"solver": "projected", "scheme": "dop853"})
CASES = (
    *(_case("flight of 1 s each 10 us", flying, _flight, 1e-6, duration=1.0, output=1e-5, **how) for how in WAYS),
    *(_case("oscillation of 10 s each 0.1 ms", swinging, _cosine, 1e-4, duration=10.0, output=1e-4, rtol=1e-7, **how) for how in WAYS),
    *(_case("flight of 1 ns", flying, _flight, 1e-15, duration=1e-9, points=1001, **how) for how in WAYS),
    *(
        _case("flight from t = 1e6 s on", flying, partial(_flight, start=1e6), 1e-6, start=1e6, duration=1.0, points=100_001, **how)
        for how in WAYS
    ),
    *(_case("flight far shorter than its output spacing", flying, _flight, 1e-15, duration=1e-12, output=0.1, **how) for how in WAYS),
    *(
        _case("change of integrator each 2 us", stiffened, partial(_spacing, output=2e-6), 1e-6, duration=1.0, output=2e-6, rtol=1e-4, **how)
        for how in WAYS[:1]
    ),
)  # fmt: skip
