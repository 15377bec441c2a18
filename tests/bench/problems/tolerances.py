"""Errors of `bdf` for the tolerance that is asked for: the half car and cars, places and forces of bushings."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

from stiffmbs.analyses.job import prepare
from stiffmbs.comparison.sweep import seconds_of
from stiffmbs.model.model_data import ModelData
from stiffmbs.model.read_scene import read_scene

from ..benchmark import Row
from ..drives import CARS, SOLVERS, Seen, converged, seen
from .half_car import SCENE

OF_HALF_CAR = (1e-6, 1e-3, 1e-4, 1e-5, 1e-7, 1e-8, 1e-9)
OF_CARS = (1e-6, 1e-3, 1e-4, 1e-5, 1e-7)
"""Tolerances; a quick look takes the first."""
STIFFNESSES = ("1e5", "1e6", "1e7", "1e8", "1e9")
"""Of bushings, N/m; the softest makes a car unstable, so it is left out there."""
CAR_DURATION = 3.0
"""Seconds, from the start on, at which the bushings ring; nothing else of a drive is as stiff."""
TIGHT: dict[str, Any] = {"solver": "projected", "scheme": "dop853", "rtol": 1e-12}


@dataclass(frozen=True)
class Tolerances:
    """A scene, its solution at a far tighter tolerance, and the tolerances at which `bdf` is compared with it."""

    name: str
    model: Callable[[], ModelData]
    exact: Callable[[ModelData], Seen]
    rtols: Sequence[float]
    run: Mapping[str, Any]

    def measured(self) -> list[Row]:
        """A row for each tolerance and quantity."""
        return self._rows(self.rtols)

    def glanced(self) -> list[Row]:
        """One tolerance."""
        return self._rows(self.rtols[:1])

    def _rows(self, rtols: Sequence[float]) -> list[Row]:
        model = self.model()
        exact = self.exact(model)
        found = []
        for rtol in sorted(rtols, reverse=True):
            job = prepare(model, rtol=rtol, **SOLVERS["bdf"], **self.run)
            errors = seen(model, job).errors(exact)
            seconds, trajectory = seconds_of(job.integrate)
            for quantity, error in errors.items():
                setting = f"rtol {rtol:.0e}, {trajectory.statistics['steps']} steps, {error / rtol:.2g} rtol"
                found.append(Row(f"bdf: {quantity}", setting, error, seconds, False))
        return found


def _half_car(stiffness: str) -> ModelData:
    return read_scene(SCENE.replace("STIFFNESS", stiffness))


def _by_dop853(model: ModelData) -> Seen:
    return seen(model, prepare(model, **TIGHT))


BENCHMARKS = (
    *(Tolerances(f"tolerances_half_car_{k}", partial(_half_car, k), _by_dop853, OF_HALF_CAR, {}) for k in STIFFNESSES),
    *(
        Tolerances(
            f"tolerances_{car.name}_{k}",
            partial(car.model, "sweep", **{car.stiffness: k}),
            partial(converged, duration=CAR_DURATION),
            OF_CARS,
            {"duration": CAR_DURATION},
        )
        for car in CARS
        if car.stiffness
        for k in STIFFNESSES[1:]
    ),
)
