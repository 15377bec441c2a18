"""What the presolve saves on the scenes in the folder ``examples`` of the directory at hand: whole runs with and without it."""

from __future__ import annotations

import statistics
import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from stiffmbs.analyses.job import prepare
from stiffmbs.analyses.load_scene import load_scene
from stiffmbs.analyses.run import run
from stiffmbs.redundancy.messages.presolve_report import unknowns

from ..benchmark import Row
from ..scenes.examples import example_scenes

ROUNDS = 21


@dataclass(frozen=True)
class Presolved:
    """One scene, from its description to its channels; errors are the largest difference of a body's coordinates."""

    path: Path

    @property
    def name(self) -> str:
        return f"presolve_{self.path.stem}"

    def measured(self) -> list[Row]:
        """Medians of runs that take turns."""
        return self._rows(ROUNDS)

    def glanced(self) -> list[Row]:
        """One run of each."""
        return self._rows(1)

    def _rows(self, rounds: int) -> list[Row]:
        scene = load_scene(str(self.path))
        choices = (True, False)
        places = [self._places(run(scene, presolve=presolve)) for presolve in choices]
        times: dict[bool, list[float]] = {presolve: [] for presolve in choices}
        for _ in range(rounds):
            for presolve in choices:
                begun = time.process_time()
                run(scene, presolve=presolve)
                times[presolve].append(time.process_time() - begun)
        rows = min(len(found) for found in places)
        error = float(np.max(np.abs(places[0][:rows] - places[1][:rows])))
        return [
            Row("with presolve" if presolve else "without", self._unknowns(presolve), error * presolve,
                statistics.median(times[presolve]), not presolve)
            for presolve in choices
        ]  # fmt: skip

    def _places(self, solution: Mapping[str, np.ndarray]) -> np.ndarray:
        return np.column_stack(
            [values for name, values in solution.items() if name.rpartition(".")[2] in ("x", "y", "angle")]
        )

    def _unknowns(self, presolve: bool) -> str:
        job = prepare(load_scene(str(self.path)), presolve=presolve)
        before, after = unknowns(job.dynamics.system, job.subsystems, job.dynamics)
        return f"{after} of {before} unknowns"


BENCHMARKS = tuple(Presolved(path) for path in example_scenes())
