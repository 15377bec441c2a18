"""`auto` beside `bdf` and `dop853` on a car, over stiffness and damping of its bushings and over short and long runs."""

from __future__ import annotations

import time
from dataclasses import dataclass
from itertools import product

from stiffmbs.analyses.job import Job, prepare
from stiffmbs.comparison.sweep import seconds_of
from stiffmbs.solve.trajectory import Outcome
from stiffmbs.verification.solve_again import Deadline

from ...benchmark import Row
from ...drives import CARS, SOLVERS, Car, converged, seen

RTOL, ROUNDS = 1e-4, 3
STIFFNESSES, DAMPING = ("1e5", "1e6", "1e7", "1e8", "1e9", "1e10"), ("0.01", "0.05", "0.2", "1")
DURATIONS = (1.0, 3.0, 10.0)
"""Seconds."""
GIVEN_UP = 3.0
"""Times the least time of `bdf` from which on `dop853` is left out."""


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
        least: dict[str, float] = {}
        for name in ("bdf", "auto"):
            if jobs[name].integrate().outcome is not Outcome.DONE:
                return []
            least[name] = seconds_of(jobs[name].integrate)[0]
        if self._in_time(jobs["dop853"], GIVEN_UP * least["bdf"]):
            least["dop853"] = float("inf")
        for name in list(least) * rounds:
            least[name] = min(least[name], seconds_of(jobs[name].integrate)[0])
        better = min(least.keys() - {"auto"}, key=least.__getitem__)
        try:
            exact = converged(model, duration=self.duration)
        except RuntimeError:  # a car that shimmies: whether it comes to the end is chance
            return []
        errors = {name: seen(model, jobs[name]).errors(exact)["places"] for name in ("auto", better)}
        ratios = f"{least['auto'] / least[better]:.2f} of {better}, places {errors['auto'] / errors[better]:.2f}"
        setting = f"{stiffness} N/m, damping {damping}, {ratios}"
        return [Row("auto", setting, errors["auto"], least["auto"], False)]

    def _in_time(self, job: Job, allowed: float) -> bool:
        """Whether a run ends within the processor time that is allowed, s; a first run, which loads code, does not decide."""
        for _ in range(2):
            outcome = job.integrate(Deadline(0.0, self.duration, allowed, time.process_time)).outcome
        return outcome is Outcome.DONE


BENCHMARKS = tuple(
    Choice(car, manoeuvre, duration) for car in CARS[:1] for manoeuvre in ("sweep", "bump") for duration in DURATIONS
)
