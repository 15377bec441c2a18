"""A study beside bare integrations of the same cases, on one thread, on two, and on two processes."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context
from typing import Any

import numpy as np

from stiffmbs.solve.missing_rows import reported
from stiffmbs.studies.case_solver import CaseSolver
from stiffmbs.studies.sweep import Study, study_of

from .benchmark import Row
from .processes import largest_memory

WAYS = ("1 thread", "2 threads", "2 processes")


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
        """All ways taking turns; the best round of each counts, as other work on the machine makes the others slower."""
        return self._rows(self.varied, self.rounds)

    def glanced(self) -> list[Row]:
        """A few cases."""
        return self._rows(
            {name: values[::100] if np.ndim(values) else values for name, values in self.varied.items()}, 1
        )

    def _rows(self, varied: Mapping[str, Any], rounds: int) -> list[Row]:
        study = study_of(self.scene(), {}, None, 0, [self.output], varied)
        expected = study.solve()[self.output].values
        before = largest_memory()
        off, alone = 0.0, []
        by_case = [_by_case(study) for _ in range(rounds)]
        clock: dict[str, list[float]] = {name: [] for name in WAYS}
        with ProcessPoolExecutor(2, get_context("spawn")) as processes:
            study.solve(executor=processes)  # which start, and compile
            for _ in range(rounds):
                for way, spent in clock.items():
                    begun, used = time.perf_counter(), time.process_time()
                    found = study.solve(2 if way == "2 threads" else None, processes if way == "2 processes" else None)
                    spent.append(time.perf_counter() - begun)
                    if way == "1 thread":
                        alone.append(time.process_time() - used)
                    off = max(off, float(np.max(np.abs(found[self.output].values - expected))))
        integration, evaluation, _ = np.min([spent.sum(axis=0) for spent in by_case], axis=0).tolist()
        each = 1e3 * evaluation / len(study.cases)
        rest = 1e3 * min(float(np.median(spent[:, 2])) for spent in by_case)
        whole = min(alone)
        ratio = whole / integration
        best = {way: min(spent) for way, spent in clock.items()}
        gains = {way: best["1 thread"] / spent for way, spent in best.items()}
        return [
            Row("integration", f"{len(study.cases)} cases alone, processor's time", 0.0, integration, True),
            Row("evaluation", f"forces and accelerations at output instants, {each:.2f} ms a case", 0.0, evaluation, True),
            Row("study", f"processor's time; {ratio:.2f} of the integration; {rest:.2f} ms a case besides both", off, whole, False),
            *(
                Row("study", f"{way}, by the clock; {gains[way]:.2f} times as fast as one", off, spent, False)
                for way, spent in best.items()
            ),
            Row("memory", f"{largest_memory() - before:.0f} MB more after {(2 * rounds) * len(study.cases)} cases", 0.0, sum(alone), False),
        ]  # fmt: skip


def _by_case(study: Study) -> np.ndarray:
    """A row for each case, s of processor's time: its integration, its forces and accelerations at output instants, all else.

    All else is the difference of two solutions of a case, one right after the other: of whole studies it is lost in the noise.
    """
    solver, rows = CaseSolver(study.task), []
    for number, values in enumerate(study.cases):
        begun = time.process_time()
        solver.row(number, values)
        solved = time.process_time()
        job = solver.job(solver.scene(values))
        ready = time.process_time()
        found = job.integrate()
        integrated = time.process_time()
        reported(job.dynamics, found, job.on_constraints, job.settings.rtol)
        alone = integrated - ready, time.process_time() - integrated
        rows.append((*alone, solved - begun - sum(alone)))
    return np.array(rows)
