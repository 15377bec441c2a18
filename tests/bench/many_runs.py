"""Many runs of one compiled system with other numbers, on one thread and on two."""

from __future__ import annotations

import statistics
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from stiffmbs.analyses.job import prepare
from stiffmbs.analyses.renumber import with_numbers
from stiffmbs.model.model_data import ModelData

from .benchmark import Row

Work = Callable[[np.ndarray], np.ndarray]
"""Solves for each value of a parameter; the last coordinates of each."""


@dataclass(frozen=True)
class ManyRuns:
    """Runs that differ by one number of a force.

    Attributes
    ----------
    name : str
    scene : callable
    force, field : str
        What is changed.
    values : ndarray
        One for each run.
    by_hand : callable
        The same runs by the yardstick.
    rtol : float
    rounds : int
    """

    name: str
    scene: Callable[[], ModelData]
    force: str
    field: str
    values: np.ndarray
    by_hand: Work
    rtol: float = 1e-6
    rounds: int = 3

    def measured(self) -> list[Row]:
        """All runs on one and two threads, taking turns; times are those of a clock on the wall."""
        return self._rows(self.values, self.rounds)

    def glanced(self) -> list[Row]:
        """A few runs."""
        return self._rows(self.values[:: len(self.values) // 10], 1)

    def _rows(self, values: np.ndarray, rounds: int) -> list[Row]:
        scene, rows = self.scene(), []
        expected = self.by_hand(values)

        def own(part: np.ndarray) -> np.ndarray:
            job, ends = prepare(scene, rtol=self.rtol), []
            for value in part:
                job = with_numbers(job, self.force, **{self.field: float(value)})
                ends.append(job.integrate().q[-1])
            return np.array(ends)

        for solver, work in (("bdf", own), ("yardstick", self.by_hand)):
            times: dict[int, list[float]] = {1: [], 2: []}
            for _ in range(rounds):
                for threads, spent in times.items():
                    begun = time.perf_counter()
                    found = on_threads(work, values, threads)
                    spent.append(time.perf_counter() - begun)
            error = float(np.max(np.abs(found - expected)))
            for threads, spent in times.items():
                setting = f"{len(values)} runs, {threads} thread{'s' * (threads > 1)}"
                rows.append(Row(solver, setting, error, statistics.median(spent), solver == "yardstick"))
        return rows


def on_threads(work: Work, values: np.ndarray, threads: int) -> np.ndarray:
    """Work on the values in so many threads at once; results in the order of the values."""
    parts = np.array_split(values, threads)
    found: list[np.ndarray] = [np.empty(0)] * threads

    def at(k: int) -> None:
        found[k] = work(parts[k])

    started = [threading.Thread(target=at, args=(k,)) for k in range(threads)]
    for thread in started:
        thread.start()
    for thread in started:
        thread.join()
    return np.concatenate(found)
