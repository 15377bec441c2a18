"""Chains of 10 to 1000 rods of 1 m in space, on hinges with upright and level axes by turns; 2 s at rtol 1e-6."""

from __future__ import annotations

import statistics
import time
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from stiffmbs.analyses.job import prepare
from stiffmbs.model.model_data import ModelData
from stiffmbs.model.read_scene import read_scene

from ..benchmark import Row

SCENE = """
name: Chain in space
dimensions: 3
parameters: {{N: {rods}, L: 1 m, m: 0.1 kg, width: 20 mm}}
gravity: [0, 1, -9.81]
bodies:
  link{{k}}:
    for: k in 1..N
    mass: m
    inertia: [m*width^2/6, m*(L^2 + width^2)/12, m*(L^2 + width^2)/12]
    position: [(k - 0.5)*L, 0, 0]
    markers:
      left: {{point: [-L/2, 0, 0], orientation: {{z: [0, (1 - (-1)^k)/2, (1 + (-1)^k)/2]}}}}
      right: {{point: [L/2, 0, 0], orientation: {{z: [0, (1 + (-1)^k)/2, (1 - (-1)^k)/2]}}}}
joints:
  pin1: {{type: revolute, i: link1.left, j: {{body: ground, orientation: {{z: [0, 1, 0]}}}}}}
  pin{{k}}: {{for: k in 2..N, type: revolute, i: "link{{k}}.left", j: "link{{k-1}}.right"}}
run: {{duration: 2, points: 201}}
"""
RTOL, CONVERGED = 1e-6, 1e-11
SOLVERS: dict[str, dict[str, Any]] = {"bdf": {"solver": "bdf"}, "dop853": {"solver": "projected", "scheme": "dop853"}}


def chain_in_space(rods: int) -> ModelData:
    """The chain of so many rods, let go from the horizontal, gravity slanted a little so that all hinges turn."""
    return read_scene(SCENE.format(rods=rods))


@dataclass(frozen=True)
class Chain:
    """A chain of one size, solved by both integrators; errors are against dop853 at a far tighter tolerance."""

    rods: int
    rounds: int

    @property
    def name(self) -> str:
        return f"chain_in_space_{self.rods}"

    def measured(self) -> list[Row]:
        """Medians of repeated solutions, set-up left out."""
        return list(self._rows(self.rounds))

    def glanced(self) -> list[Row]:
        """One solution each."""
        return list(self._rows(1))

    def _rows(self, rounds: int) -> Iterator[Row]:
        scene = chain_in_space(self.rods)
        reference = prepare(scene, rtol=CONVERGED, **SOLVERS["dop853"]).integrate().q
        for solver, settings in SOLVERS.items():
            job = prepare(scene, rtol=RTOL, **settings)
            times = []
            for _ in range(rounds):
                begun = time.process_time()
                trajectory = job.integrate()
                times.append(time.process_time() - begun)
            steps, seconds = int(trajectory.statistics["steps"]), statistics.median(times)
            setting = f"{self.rods} bodies, {steps} steps of {seconds / self.rods / steps * 1e6:.2f} us a body"
            yield Row(solver, setting, float(np.max(np.abs(trajectory.q - reference))), seconds, False)


BENCHMARKS = (Chain(10, 9), Chain(100, 5), Chain(1000, 3))
