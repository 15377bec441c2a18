"""What space costs: the planar scenes in the folder ``examples`` of the directory at hand, in the plane and in space."""

from __future__ import annotations

import statistics
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from stiffmbs.analyses.in_space import in_space
from stiffmbs.analyses.job import Job, prepare
from stiffmbs.analyses.load_scene import load_scene
from stiffmbs.compile.bodies import BODY_KINDS
from stiffmbs.model.model import PlanarData

from ..benchmark import Row
from ..scenes.examples import example_scenes

ROUNDS = 9


@dataclass(frozen=True)
class InSpace:
    """One scene as it says that it is to be run, without set-up; errors are the largest distance between places of a body."""

    path: Path

    @property
    def name(self) -> str:
        return f"planar_in_space_{self.path.stem}"

    def measured(self) -> list[Row]:
        """Medians of solutions that take turns."""
        return self._rows(ROUNDS)

    def glanced(self) -> list[Row]:
        """One solution of each."""
        return self._rows(1)

    def _rows(self, rounds: int) -> list[Row]:
        planar = load_scene(self.path)
        assert isinstance(planar, PlanarData)
        jobs = [prepare(scene) for scene in (planar, in_space(planar))]
        places, steps = zip(*(_solved(job) for job in jobs), strict=True)
        times: list[list[float]] = [[], []]
        for _ in range(rounds):
            for job, found in zip(jobs, times, strict=True):
                begun = time.process_time()
                job.integrate()
                found.append(time.process_time() - begun)
        count = min(len(found) for found in places)
        errors = (0.0, float(np.max(np.linalg.norm(places[0][:count] - places[1][:count], axis=-1))))
        return [
            Row(where, f"{n} steps", error, statistics.median(found), where == "plane")
            for where, n, error, found in zip(("plane", "space"), steps, errors, times, strict=True)
        ]


def _solved(job: Job) -> tuple[np.ndarray, int]:
    """x and y of the bodies over time, shape (times, bodies, 2), and how many steps that took."""
    trajectory, of_body = job.integrate(), BODY_KINDS[job.data.dimensions]
    coordinates = of_body.n_q * len(job.data.bodies)
    places = trajectory.q[:, :coordinates].reshape(len(trajectory.t), -1, of_body.n_q)[:, :, :2]
    return places, int(trajectory.statistics["steps"])


def _planar(path: Path) -> bool:
    return "dimensions: 3" not in path.read_text(encoding="utf-8").splitlines()


BENCHMARKS = tuple(InSpace(path) for path in example_scenes() if _planar(path))
