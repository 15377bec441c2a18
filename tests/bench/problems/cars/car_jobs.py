"""Many jobs of a car at once: the memory that each holds beyond its results, and their runs on one thread and on two."""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np

from stiffmbs.analyses.job import Job, prepare
from stiffmbs.model.model_data import ModelData

from ...benchmark import Row
from ...drives import CARS, Car
from ...many_runs import on_threads
from ...processes import largest_memory

MANOEUVRE = "step"


@dataclass(frozen=True)
class CarJobs:
    """So many jobs of a car, each prepared anew and run; then all are run again, on one thread and on two."""

    car: Car
    jobs: int

    @property
    def name(self) -> str:
        return f"jobs_of_{self.car.name}"

    def measured(self) -> list[Row]:
        """All jobs; times are those of a clock on the wall."""
        return self._rows(self.jobs, 3)

    def glanced(self) -> list[Row]:
        """Two."""
        return self._rows(2, 1)

    def _rows(self, count: int, rounds: int) -> list[Row]:
        model = self.car.model(MANOEUVRE)
        first = [_run_once(model) for _ in range(2)]  # after which what all jobs share is there
        before, begun = largest_memory(), time.perf_counter()
        jobs = [_run_once(model) for _ in range(count)]
        held, seconds = (largest_memory() - before) / count, (time.perf_counter() - begun) / count
        first.clear()
        rows = [Row("memory", f"{held:.1f} MB a job beyond its results", 0.0, seconds, False)]
        times: dict[int, list[float]] = {1: [], 2: []}
        for _ in range(rounds):
            for threads, spent in times.items():
                begun = time.perf_counter()
                on_threads(lambda part: np.array([jobs[k].integrate().q[-1] for k in part]), np.arange(count), threads)
                spent.append(time.perf_counter() - begun)
        for threads, spent in times.items():
            setting = f"{count} runs, {threads} thread{'s' * (threads > 1)}"
            rows.append(Row("bdf", setting, 0.0, min(spent), False))
        return rows


def _run_once(model: ModelData) -> Job:
    """A new job, whose results are dropped."""
    job = prepare(model)
    job.integrate()
    return job


BENCHMARKS = tuple(CarJobs(car, 24) for car in CARS if car.name == "example_car_bushings")
