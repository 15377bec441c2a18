"""This package's own solvers on a problem: each formulation and scheme, errors of positions, velocities and reactions."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from stiffmbs.analyses.job import prepare
from stiffmbs.comparison.sweep import TIMING, seconds_of
from stiffmbs.model.model_data import ModelData
from stiffmbs.solve.explicit.projected import TRAITS
from stiffmbs.solve.formulations import FORMULATIONS
from stiffmbs.solve.trajectory import Outcome, Trajectory

from .benchmark import Row
from .decades import LONGEST, TARGETS, at_errors
from .peers.scipy import explicit, states
from .problem import Problem
from .task import Task

TOLERANCES = tuple(float(f"{10.0**-k:.2g}") for k in np.arange(3, 12.1, 0.5))
STEPS = tuple(10.0**-k for k in np.arange(2, 5.6, 0.25))
"""Of the fixed schemes, relative to the duration."""
ROUNDS = 3
CONVERGED = 1e-13
DIFFERENCE = 1e-3
"""Largest change of a coordinate in the differences by which velocities follow from minimal coordinates."""


@dataclass(frozen=True)
class Exact:
    """Converged positions, velocities, and the multipliers that belong to them."""

    q: np.ndarray
    u: np.ndarray
    lam: np.ndarray

    def errors(self, q: np.ndarray, u: np.ndarray, lam: np.ndarray) -> Iterator[tuple[str, float]]:
        """Largest errors: m or rad, m/s or rad/s, N or N m."""
        for name, found, right in (("positions", q, self.q), ("velocities", u, self.u), ("reactions", lam, self.lam)):
            if right.size:
                yield name, float(np.max(np.abs(found - right)))


@dataclass(frozen=True)
class OwnSolvers:
    """All of the package's solvers on a problem that other tools have a task in: that gives the reference."""

    problem: Problem

    @property
    def name(self) -> str:
        return self.problem.name

    def measured(self) -> list[Row]:
        """A row for each solver, setting and quantity; and times at errors."""
        assert self.problem.task is not None
        task = self.problem.task()
        exact, duration = exact_of(task), float(task.times[-1] - task.times[0])
        rows = [
            row
            for name, fixed, settings in _solvers()
            for row in _swept(task.scene, exact, name, duration * fixed, settings)
        ]
        names = dict.fromkeys(row.solver for row in rows)
        return [*rows, *(row for name in names for row in at_errors(name, False, rows, TARGETS))]

    def glanced(self) -> list[Row]:
        """Each solver at its loosest setting."""
        assert self.problem.task is not None
        task = self.problem.task()
        exact, duration = exact_of(task), float(task.times[-1] - task.times[0])
        return [
            row
            for name, fixed, settings in _solvers()
            for row in _measured(task.scene, exact, name, *_settings(duration * fixed)[0], settings)
        ]


def exact_of(task: Task) -> Exact:
    """From minimal coordinates by SciPy's DOP853; reactions follow from the states by the block system."""
    y = states(task, explicit, CONVERGED)
    minimal = task.minimal
    rates = np.array([minimal.rates(t, row) for t, row in zip(task.times, y, strict=True)])
    h = DIFFERENCE / np.maximum(np.max(np.abs(rates), axis=1, keepdims=True), 1e-30)
    near, far = (minimal.places(y + d * rates) - minimal.places(y - d * rates) for d in (h, 2 * h))
    q, u = minimal.places(y), (8 * near - far) / (12 * h)
    report = prepare(task.scene).dynamics.report(task.times, q, u, project=False)
    return Exact(q, u, report.lam)


def _solvers() -> Iterator[tuple[str, bool, dict[str, Any]]]:
    """Name, whether its steps are fixed, and its settings."""
    for formulation in FORMULATIONS:
        yield f"bdf {formulation}", False, {"solver": "bdf", "formulation": formulation}
    for scheme, traits in TRAITS.items():
        yield scheme, traits.fixed_steps, {"solver": "projected", "scheme": scheme}


def _settings(duration: float) -> list[tuple[str, float]]:
    """What is tried: steps in a duration, tolerances without one."""
    return [("step", duration * part) for part in STEPS] if duration else [("rtol", rtol) for rtol in TOLERANCES]


def _swept(scene: ModelData, exact: Exact, name: str, duration: float, settings: dict[str, Any]) -> Iterator[Row]:
    """From loose to tight until it takes too long."""
    for kind, value in _settings(duration):
        rows = list(_measured(scene, exact, name, kind, value, settings))
        yield from rows
        if rows and rows[0].seconds > LONGEST:
            return


def _measured(
    scene: ModelData, exact: Exact, name: str, kind: str, value: float, settings: dict[str, Any]
) -> Iterator[Row]:
    """A row for each quantity; none where the solver stops early."""
    job = prepare(scene, **(settings | {kind: value}))
    times: list[float] = []
    found: Trajectory | None = None
    while len(times) <= ROUNDS and (not times or times[0] < TIMING.once):
        seconds, found = seconds_of(job.integrate)
        times.append(seconds)
    if found is None or found.outcome is not Outcome.DONE:
        return
    report = job.dynamics.report(found.t, found.q, found.u, project=False)
    for quantity, error in exact.errors(found.q, found.u, report.lam):
        yield Row(f"{name}: {quantity}", f"{kind} {value:.3g}", error, min(times), False)
