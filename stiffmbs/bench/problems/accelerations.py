"""One evaluation of accelerations with all reactions, as explicit steps take it, of chains in space and in the plane."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ...compile.machine.routines import Routine
from ...describe.model_data import ModelData
from ...jobs.job import prepare
from ..benchmark import Row
from ..by_hand.chain_minimal import accelerations
from ..by_hand.loop import fast
from .chain import chain
from .chain_in_space import chain_in_space

OFTEN = Routine("stiffmbs.bench.native.accelerations", "accelerate_often", "int64(int64, float64, float64*, int64*)")
LENGTH = 1.0
ROUNDS, EVALUATIONS = 300, 1000
"""How often the time is taken, and how many rods are evaluated each time; the shortest time counts."""


@dataclass(frozen=True)
class Accelerations:
    """A chain of so many rods, in the middle of its motion; errors are against the LU of the whole block system."""

    rods: int
    where: str

    @property
    def name(self) -> str:
        return f"accelerations_{self.where}_{self.rods}"

    def measured(self) -> list[Row]:
        """Shortest times of many."""
        return self._rows(ROUNDS)

    def glanced(self) -> list[Row]:
        """Of a few."""
        return self._rows(3)

    def _scene(self) -> ModelData:
        return chain_in_space(self.rods) if self.where == "in_space" else chain(self.rods, LENGTH)

    def _rows(self, rounds: int) -> list[Row]:
        job = prepare(self._scene(), solver="projected", rtol=1e-4)
        dynamics, trajectory = job.dynamics, job.integrate()
        middle = len(trajectory.t) // 2
        dynamics.state.q[:], dynamics.state.u[:] = trajectory.q[middle], trajectory.u[middle]
        found = np.empty(dynamics.system.n_u)
        repeats = max(1, EVALUATIONS // self.rods)
        given = repeats, trajectory.t[middle], found.ctypes.data, dynamics.eliminated.table.ctypes.data
        seconds = _shortest(lambda: OFTEN.call(*given), rounds, 1) / repeats
        error = float(np.max(np.abs(found - dynamics.accelerate(trajectory.t[middle])[1])))
        rows = [Row("elimination", f"{seconds / self.rods * 1e9:.0f} ns a rod", error, seconds, False)]
        if self.where == "in_plane":
            phi, w, h = trajectory.q[middle][2::3], trajectory.u[middle][2::3], LENGTH / 2
            spin, force = np.empty(self.rods), np.empty((self.rods + 1, 2))
            _recursions(1, phi, w, h, spin, force)
            seconds = _shortest(lambda: _recursions(repeats, phi, w, h, spin, force), rounds, 1) / repeats
            off = float(np.max(np.abs(spin - found[2::3])))
            rows.append(Row("recursion by hand", f"{seconds / self.rods * 1e9:.0f} ns a rod", off, seconds, True))
        return rows


@fast
def _recursions(count, phi, w, h, spin, force):
    """The recursion in the angles, so many times."""
    for _ in range(count):
        accelerations(phi, w, h, spin, force)


def _shortest(work: Callable[[], object], rounds: int, repeats: int) -> float:
    """The shortest time of a call, s: each is short enough to run between other programs."""
    times = []
    for _ in range(rounds):
        begun = time.perf_counter()
        for _ in range(repeats):
            work()
        times.append(time.perf_counter() - begun)
    return min(times) / repeats


BENCHMARKS = tuple(Accelerations(rods, where) for where in ("in_plane", "in_space") for rods in (10, 100, 1000))
