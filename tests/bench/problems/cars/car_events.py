"""What an event costs `bdf` on a car, beside the steps before and after it."""

from __future__ import annotations

import statistics
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from stiffmbs.analyses.run import Job, prepare
from stiffmbs.solve.bdf import bdf_integrator
from stiffmbs.solve.ida.native_engine import NativeEngine, Reached

from ...benchmark import Row
from ...drives import CARS, SOLVERS, Car

RTOL, ROUNDS = 1e-4, 15


@dataclass
class _Watched:
    """An engine, and how long it waits from the end of each stretch of steps to the beginning of the next, s."""

    engine: NativeEngine
    waits: list[float] = field(default_factory=list)
    ended: float | None = None

    def __getattr__(self, name: str) -> Any:
        return getattr(self.engine, name)

    def advance(self, times: np.ndarray | None, stops: Sequence[float]) -> Iterator[Reached]:
        if self.ended is not None:
            self.waits.append(time.process_time() - self.ended)
        for reached in self.engine.advance(times, stops):
            self.ended = time.process_time()
            yield reached


def _wait(job: Job) -> float:
    """The median over the events and breakpoints of one solution."""
    solved = job.subsystems[0] if job.subsystems else job
    solved.dynamics.forget_pivots()
    integrator = bdf_integrator(solved.dynamics, job.settings)
    watched = _Watched(integrator.engine)
    integrator.engine = watched  # type: ignore[assignment]
    for _ in integrator.run(solved.start, job.grid):
        pass
    return statistics.median(watched.waits)


@dataclass(frozen=True)
class Events:
    """A manoeuvre with events: a look at both sides of each, consistent values, and a start of IDA; steps are left out, so that there is no error."""

    car: Car
    manoeuvre: str

    @property
    def name(self) -> str:
        return f"{self.car.name}_{self.manoeuvre}_event"

    def measured(self) -> list[Row]:
        """The least of repeated solutions."""
        return self._rows(ROUNDS)

    def glanced(self) -> list[Row]:
        """One solution."""
        return self._rows(1)

    def _rows(self, rounds: int) -> list[Row]:
        job = prepare(self.car.model(self.manoeuvre), rtol=RTOL, **SOLVERS["bdf"])
        events = job.integrate().statistics["events"]
        return [Row("bdf", f"one of {events} events", 0.0, min(_wait(job) for _ in range(rounds)), False)]


BENCHMARKS = tuple(Events(car, "bump") for car in CARS[2:])
