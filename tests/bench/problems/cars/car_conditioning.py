"""How far a car's places may be off for its tolerance: what an error of one tolerance at the start alone makes of them, beside the errors of `bdf`."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from stiffmbs.analyses.job import Job, prepare
from stiffmbs.dynamics.dynamics import Dynamics
from stiffmbs.dynamics.initial import InitialValues
from stiffmbs.solve.bdf import solve
from stiffmbs.solve.error_control.tolerances import absolute_tolerances
from stiffmbs.solve.events.restart import restarted

from ...benchmark import Row
from ...drives import CARS, SOLVERS, Car

RTOLS, STARTS = (1e-4, 1e-3, 1e-5, 1e-6), 5
"""Tolerances, the first of which is also that of the errors at the start; their number."""
CONVERGED = 1e-7
"""The tolerance at which motions after an error at the start are computed, and the motion that all are compared with."""
POINTS = 101


def _job(car: Car, rtol: float) -> Job:
    return prepare(car.model("sweep"), rtol=rtol, points=POINTS, **SOLVERS["bdf"])


def _car(job: Job) -> tuple[Dynamics, InitialValues]:
    """Dynamics and start of what is integrated: one mechanism, whose wheels spin by coordinates of their own."""
    solved = job.subsystems[0] if job.subsystems else job
    return solved.dynamics, solved.start


def _places(job: Job, u: np.ndarray | None = None) -> np.ndarray:
    """Places of bodies, one a column, from the start or from other velocities there."""
    dynamics, start = _car(job)
    if u is not None:
        start = restarted(dynamics, job.grid.start, start.q.copy(), u)
    trajectory = solve(dynamics, start, job.grid, job.settings, lambda t: None)
    return trajectory.q[:, dynamics.system.per_coordinate(1.0, 0.0) == 1.0]


def _off_by_the_tolerance(job: Job, rtol: float, seed: int) -> np.ndarray:
    """Velocities at the start, each off by one tolerance up or down, on the constraints."""
    dynamics, start = _car(job)
    system, state, u = dynamics.system, dynamics.state, start.u
    absolute = absolute_tolerances(system, job.settings)[system.n_q :]  # in proportion to rtol
    tolerances = rtol / job.settings.rtol * absolute + rtol * np.abs(u)
    state.q[:] = start.q
    state.u[:] = u + np.random.default_rng(seed).choice([-1.0, 1.0], len(u)) * tolerances
    dynamics.correct_velocities(job.grid.start)
    moved: np.ndarray = state.u.copy()
    return moved


@dataclass(frozen=True)
class Conditioning:
    """The sweep of a car."""

    car: Car

    @property
    def name(self) -> str:
        return f"{self.car.name}_sweep_conditioning"

    def measured(self) -> list[Row]:
        """All tolerances, and errors at the start by chance."""
        return list(self._rows(RTOLS, STARTS))

    def glanced(self) -> list[Row]:
        """One of each, at the tightest."""
        return list(self._rows(RTOLS[-1:], 1))

    def _rows(self, rtols: Sequence[float], starts: int) -> Iterator[Row]:
        job = _job(self.car, CONVERGED)
        exact = _places(job)
        for seed in range(starts):
            begun = time.process_time()
            moved = _places(job, _off_by_the_tolerance(job, rtols[0], seed))
            yield _row(f"start {seed + 1} off by", rtols[0], moved - exact, begun)
        for rtol in rtols:
            job = _job(self.car, rtol)
            begun = time.process_time()
            yield _row("bdf", rtol, _places(job) - exact, begun)


def _row(what: str, rtol: float, difference: np.ndarray, begun: float) -> Row:
    """The largest difference of places, m, and how many times `rtol` that is."""
    error = float(np.max(np.abs(difference)))
    return Row(what, f"rtol {rtol:.0e}, {error / rtol:.3g} times", error, time.process_time() - begun, False)


BENCHMARKS = tuple(Conditioning(car) for car in CARS)
