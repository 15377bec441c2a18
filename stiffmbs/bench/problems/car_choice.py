"""`auto` beside `bdf` and `dop853` on a car, over stiffness and damping of its bushings and over short and long runs."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

from ...jobs.run import prepare
from ...solve.trajectory import Outcome
from ..benchmark import Row
from ..drives import CARS, SOLVERS, Car, converged, seen
from ..turns import seconds_of

RTOL, ROUNDS = 1e-4, 3
STIFFNESSES, DAMPING = ("1e5", "1e6", "1e7", "1e8", "1e9", "1e10"), ("0.01", "0.05", "0.2", "1")
DURATIONS = (1.0, 3.0, 10.0)
"""Seconds."""
GIVEN_UP = 3.0
"""Times the time of `bdf`, both in their first runs, from which on `dop853` is not repeated."""


@dataclass(frozen=True)
class Choice:
    """A manoeuvre for some seconds; a row for each stiffness and damping ratio on which all three come to the end."""

    car: Car
    manoeuvre: str
    duration: float

    @property
    def name(self) -> str:
        return f"{self.car.name}_{self.manoeuvre}_choice_{self.duration:g}"

    def measured(self) -> list[Row]:
        """The shortest of repeated solutions, first ones left out, and how it compares with the better of the two."""
        return [row for numbers in product(STIFFNESSES, DAMPING) for row in self._rows(*numbers, ROUNDS)]

    def glanced(self) -> list[Row]:
        """One solution more than the first on bushings of middle stiffness."""
        return self._rows(STIFFNESSES[1], DAMPING[2], 1)

    def _rows(self, stiffness: str, damping: str, rounds: int) -> list[Row]:
        model = self.car.model(self.manoeuvre, **{self.car.stiffness: stiffness, "zeta": damping})
        jobs = {name: prepare(model, rtol=RTOL, duration=self.duration, **how) for name, how in SOLVERS.items()}
        first: dict[str, float] = {}
        for name, job in jobs.items():
            first[name], trajectory = seconds_of(job.integrate)
            if trajectory.outcome is not Outcome.DONE:
                return []
        repeated = [name for name in jobs if name != "dop853" or first[name] < GIVEN_UP * first["bdf"]]
        least = dict.fromkeys(jobs, float("inf"))
        for name in repeated * rounds:
            least[name] = min(least[name], seconds_of(jobs[name].integrate)[0])
        try:
            exact = converged(model, duration=self.duration)
        except RuntimeError:  # a car that shimmies: whether it comes to the end is chance
            return []
        better = min(("bdf", "dop853"), key=lambda name: least[name])
        setting = f"{stiffness} N/m, damping {damping}, {least['auto'] / least[better]:.2f} of {better}"
        return [Row("auto", setting, seen(model, jobs["auto"]).errors(exact)["places"], least["auto"], False)]


BENCHMARKS = tuple(
    Choice(car, manoeuvre, duration) for car in CARS[:1] for manoeuvre in ("sweep", "bump") for duration in DURATIONS
)
