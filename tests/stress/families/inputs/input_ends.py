"""Inputs over time that end within the run: poles, and formulas that leave their domain, by every solver, against the formulas."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from stiffmbs.results.solution import Solution

from ...case import Outcome
from ...simulation import simulation
from .inputs import driven, sled

SOLVERS: dict[str, dict[str, Any]] = {
    "bdf": {"solver": "bdf"}, "auto": {"solver": "auto"}, "dop853": {"solver": "projected", "scheme": "dop853"},
    "dopri5": {"solver": "projected", "scheme": "dopri5"}, "rk4": {"solver": "projected", "scheme": "rk4", "step": 1e-5},
    "kinematic": {"solver": "kinematic"},
}  # fmt: skip
DRIVES: dict[str, tuple[float, Callable[[np.ndarray], np.ndarray]]] = {
    "1/(t - 0.5) + 2": (0.5, lambda t: 1 / (t - 0.5) + 2), "tan(t)": (np.pi / 2, np.tan), "log(1 - t)": (1.0, lambda t: np.log(1 - t)),
    "(1 - t)^-3 - 1": (1.0, lambda t: (1 - t) ** -3.0 - 1), "sqrt(1 - t) - 1": (1.0, lambda t: np.sqrt(1 - t) - 1),
    "asin(2*t)": (0.5, lambda t: np.arcsin(2 * t)),
}  # fmt: skip
FORCES_WITH_ENDS: dict[str, tuple[float, Callable[[np.ndarray], np.ndarray]]] = {
    "1/(1 - t)^2": (1.0, lambda t: t / (1 - t)), "(1 - t)^-0.5": (1.0, lambda t: 2 - 2 * np.sqrt(1 - t)),
    "tan(2*t)": (np.pi / 4, lambda t: -np.log(np.cos(2 * t)) / 2), "sqrt(1 - t)": (1.0, lambda t: 2 / 3 * (1 - (1 - t) ** 1.5)),
    "1/(t^2 - 1)": (1.0, lambda t: 0.5 * np.log((1 - t) / (1 + t))),
}  # fmt: skip


def _way(solution: Solution, law: Callable[[np.ndarray], np.ndarray], channel: str) -> float:
    """Up to 1 % before the last row, against the law, relative to its largest value."""
    before = solution.t <= 0.97 * solution.t[-1]
    expected = law(solution.t[before])
    return float(np.max(np.abs(solution[channel][before] - expected)) / max(1.0, np.max(np.abs(expected))))


def _case(kind: str, law: str, end: float, expected: Callable[[np.ndarray], np.ndarray], solver: str):
    channel = "sled.x" if kind == "drive" else "sled.vx"
    scene = partial(driven, position=law) if kind == "drive" else partial(sled, law)
    return simulation(
        f"{kind} {law}, {solver}", "told where the input ends; the motion before against its integral", scene,
        partial(_way, law=expected, channel=channel), 1e-3, names=(f"t = {end:.9g} s", "has no finite value there"),
        expected=Outcome.TOLD, duration=2.0, points=201, **SOLVERS[solver],
    )  # fmt: skip


CASES = (
    *(_case("drive", law, *end, solver) for law, end in DRIVES.items() for solver in SOLVERS),
    *(_case("force", law, *end, solver) for law, end in FORCES_WITH_ENDS.items() for solver in SOLVERS if solver != "kinematic"),
    simulation(
        "force sin(t - 1)/(t - 1)", "a gap that closes is no pole; speed against the sine integral", partial(sled, "sin(t - 1)/(t - 1)"),
        lambda solution: float(abs(solution["sled.vx"][-1] - 2 * 0.946083070367183)), 1e-5, duration=2.0, points=22,
    ),
)  # fmt: skip
