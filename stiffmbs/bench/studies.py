"""A study beside bare integrations of the same cases, on one thread and on two."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..studies.case_solver import CaseSolver
from ..studies.sweep import Study, study_of
from .benchmark import Row


@dataclass(frozen=True)
class StudyRuns:
    """Cases of a study.

    Attributes
    ----------
    name : str
    scene : callable
    varied : mapping
        As for `stiffmbs.sweep`, with settings.
    output : str
        What is kept.
    rounds : int
    """

    name: str
    scene: Callable[[], Any]
    varied: Mapping[str, Any]
    output: str
    rounds: int = 3

    def measured(self) -> list[Row]:
        """All ways taking turns."""
        return self._rows(self.varied, self.rounds)

    def glanced(self) -> list[Row]:
        """A few cases."""
        return self._rows(
            {name: values[::100] if np.ndim(values) else values for name, values in self.varied.items()}, 1
        )

    def _rows(self, varied: Mapping[str, Any], rounds: int) -> list[Row]:
        study = study_of(self.scene(), {}, None, 0, [self.output], varied)
        times: dict[str, list[float]] = {name: [] for name in ("bare", "processor", "1", "2")}
        expected = study.solve()[self.output].values
        off = 0.0
        for _ in range(rounds):
            times["bare"].append(_bare(study))
            for workers in (1, 2):
                begun, used = time.perf_counter(), time.process_time()
                found = study.solve(workers)[self.output].values
                times[str(workers)].append(time.perf_counter() - begun)
                if workers == 1:
                    times["processor"].append(time.process_time() - used)
                off = max(off, float(np.max(np.abs(found - expected))))
        median, cases = {name: statistics.median(spent) for name, spent in times.items()}, f"{len(study.cases)} cases"
        return [
            Row("integration", f"{cases} alone, processor's time", 0.0, median["bare"], True),
            Row("study", f"{cases}, processor's time", off, median["processor"], False),
            *(
                Row("study", f"{cases}, {n} thread{'s' * (n > 1)}, by the clock", off, median[str(n)], False)
                for n in (1, 2)
            ),
        ]


def _bare(study: Study) -> float:
    """Time of the integrations of all cases, and of nothing else, by the processor's time, s."""
    solver, spent = CaseSolver(study.task), 0.0
    for values in study.cases:
        job = solver.job(solver.scene(values))
        begun = time.process_time()
        job.integrate()
        spent += time.process_time() - begun
    return spent
