"""Cars on manoeuvres of 10 s, on bushings and on ideal joints, by `bdf`, `dop853` and `auto`; `bdf` beside what its kernels take alone."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

from stiffmbs.analyses.job import prepare
from stiffmbs.comparison.sweep import seconds_of
from stiffmbs.model.model_data import ModelData
from stiffmbs.solve.trajectory import Outcome, ProgressCallback

from ...benchmark import Row
from ...drives import CARS, SOLVERS, Car, Seen, converged, seen
from ..linear_algebra import kernel_seconds

RTOLS, ROUNDS = (1e-4, 1e-6), 3
STIFFNESSES = ("1e6", "1e7", "1e8", "1e9")
"""Radial, of the suspensions' bushings, N/m."""
LONGEST = 30.0
"""Time, s, after which a solution is left out."""


@dataclass(frozen=True)
class Drive:
    """A car on one of its manoeuvres; errors are against `bdf` at a far tighter tolerance.

    Forces are those of all bushings, relative to the largest of them.
    """

    car: Car
    manoeuvre: str

    @property
    def name(self) -> str:
        return f"{self.car.name}_{self.manoeuvre}"

    def measured(self) -> list[Row]:
        """The shortest of repeated solutions, set-up left out."""
        return self._rows(RTOLS, ROUNDS)

    def glanced(self) -> list[Row]:
        """One solution each, at the tighter tolerance."""
        return self._rows(RTOLS[1:], 1)

    def _rows(self, rtols: Sequence[float], rounds: int) -> list[Row]:
        model = self.car.model(self.manoeuvre)
        exact = converged(model)
        return [row for rtol in rtols for solver in SOLVERS for row in _rows(model, solver, rtol, exact, rounds)]


@dataclass(frozen=True)
class OverStiffness:
    """A manoeuvre with stiffer and stiffer bushings, by `bdf`; errors are against a far tighter tolerance."""

    car: Car
    manoeuvre: str

    @property
    def name(self) -> str:
        return f"{self.car.name}_{self.manoeuvre}_over_stiffness"

    def measured(self) -> list[Row]:
        """The shortest of repeated solutions, set-up left out."""
        return [row for stiffness in STIFFNESSES for row in self._rows(stiffness, ROUNDS)]

    def glanced(self) -> list[Row]:
        """One solution with the softest bushings."""
        return list(self._rows(STIFFNESSES[0], 1))

    def _rows(self, stiffness: str, rounds: int) -> Iterator[Row]:
        model = self.car.model(self.manoeuvre, **{self.car.stiffness: stiffness})
        for row in _rows(model, "bdf", RTOLS[0], converged(model), rounds):
            yield Row(row.solver, f"{stiffness} N/m, {row.setting}", row.error, row.seconds, row.peer)


class _TooLong(Exception):
    """A solution takes longer than a table is worth."""


def _limited() -> ProgressCallback:
    """A watch that ends a solution which takes too long."""
    begun = time.process_time()

    def watch(t: float) -> None:
        if time.process_time() > begun + LONGEST:
            raise _TooLong

    return watch


def _rows(model: ModelData, solver: str, rtol: float, exact: Seen, rounds: int) -> Iterator[Row]:
    """A row for each quantity, with the number of steps, and for `bdf` how many times as long as its kernels alone it takes; none where it stops early or takes too long."""
    job = prepare(model, rtol=rtol, **SOLVERS[solver])
    try:
        timed = [seconds_of(partial(job.integrate, _limited())) for _ in range(rounds)]
    except _TooLong:
        return
    seconds, trajectory = min(seconds for seconds, _ in timed), timed[0][1]
    if trajectory.outcome is not Outcome.DONE:
        return
    setting = f"rtol {rtol:.0e}, {trajectory.statistics['steps']} steps"
    if solver == "bdf":
        setting += f", {seconds / kernel_seconds(job, trajectory):.1f} times its kernels"
    for quantity, error in seen(model, job).errors(exact).items():
        yield Row(f"{solver}: {quantity}", setting, error, seconds, False)


IN_STEADY_MOTION = replace(
    CARS[0],
    name="reference_car_bushings_from_steady_motion",
    changes={"start": "{velocity: [V0, 0, 0], speed: found, rolling: [w_fl, w_fr, w_rl, w_rr]}"},
)
"""The car of the package as the example starts: it is drawn in balance on bushings of one stiffness, and rings at the start on others."""

BENCHMARKS = (
    *(Drive(car, manoeuvre) for car in reversed(CARS) for manoeuvre in car.manoeuvres),
    *(OverStiffness(car, "sweep") for car in (*CARS, IN_STEADY_MOTION) if car.stiffness),
)
