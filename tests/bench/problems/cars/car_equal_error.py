"""`bdf` beside `dop853` on cars on stiff bushings: the time at an error of 1e-4 of places, m, and of the bushings' forces, relative."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from stiffmbs.analyses.job import prepare
from stiffmbs.comparison.sweep import seconds_of

from ...benchmark import Row
from ...decades import at_errors
from ...drives import CARS, SOLVERS, Car, converged, seen

TARGET = 1e-4
STIFFNESSES = ("1e8", "1e9")
"""Radial, of the suspensions' bushings, N/m."""
DURATION = 1.0
"""Seconds: the start, at which the bushings ring."""
RTOLS = {"bdf": (1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 3e-6, 1e-6), "dop853": (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)}


@dataclass(frozen=True)
class EqualError:
    """The sweep of a car; errors are against `bdf` at a far tighter tolerance."""

    car: Car
    stiffness: str

    @property
    def name(self) -> str:
        return f"{self.car.name}_{self.stiffness}_equal_error"

    def measured(self) -> list[Row]:
        """The second solution at each tolerance, and the times that are read at the error."""
        rows = list(self._rows(RTOLS))
        solvers = dict.fromkeys(row.solver for row in rows)
        return [*rows, *(row for solver in solvers for row in at_errors(solver, False, rows, (TARGET,)))]

    def glanced(self) -> list[Row]:
        """One tolerance of `bdf`."""
        return list(self._rows({"bdf": RTOLS["bdf"][-2:-1]}))

    def _rows(self, rtols: dict[str, tuple[float, ...]]) -> Iterator[Row]:
        model = self.car.model("sweep", **{self.car.stiffness: self.stiffness})
        exact = converged(model, duration=DURATION)
        for solver, tolerances in rtols.items():
            for rtol in tolerances:
                job = prepare(model, rtol=rtol, duration=DURATION, **SOLVERS[solver])
                errors = seen(model, job).errors(exact)
                seconds, _ = seconds_of(job.integrate)
                for quantity, error in errors.items():
                    yield Row(f"{solver}: {quantity}", f"rtol {rtol:.0e}", error, seconds, False)


BENCHMARKS = tuple(EqualError(car, stiffness) for car in reversed(CARS) if car.stiffness for stiffness in STIFFNESSES)
