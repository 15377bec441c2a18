"""One kind of problem in many sizes: time of a body and step, and memory of a body."""

from __future__ import annotations

import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from stiffmbs.analyses.job import prepare
from stiffmbs.model.model_data import ModelData

from .benchmark import Row
from .by_hand.ida import Equations, Run

RTOL = 1e-6
SOLVERS: dict[str, dict[str, Any]] = {"bdf": {"solver": "bdf"}, "dop853": {"solver": "projected", "scheme": "dop853"}}


@dataclass(frozen=True)
class Size:
    """A problem of one size.

    Attributes
    ----------
    bodies : int
    scene, by_hand, reference : callables
        The scene, its equations by hand, and converged coordinates.
    rounds : int
        How often it is solved.
    """

    bodies: int
    scene: Callable[[], ModelData]
    by_hand: Callable[[], Equations]
    reference: Callable[[], np.ndarray]
    rounds: int


@dataclass(frozen=True)
class Scaling:
    """Sizes of one problem, from small to large, each at rtol 1e-6.

    Attributes
    ----------
    name : str
    sizes : sequence of Size
    times : ndarray
        Output times.
    memory_of : str
        A Python statement that solves the problem of size ``n``, run in a process of its own to see its memory.
    """

    name: str
    sizes: Sequence[Size]
    times: np.ndarray
    memory_of: str

    def measured(self) -> list[Row]:
        """Both integrators and the yardstick for every size; memory too."""
        return [row for size in self.sizes for row in self._rows(size)]

    def glanced(self) -> list[Row]:
        """The smallest size."""
        return list(self._rows(self.sizes[0]))

    def _rows(self, size: Size) -> Iterator[Row]:
        scene, reference = size.scene(), size.reference()
        memory = f", {self._memory(size.bodies):.0f} kB a body"
        for name, settings in SOLVERS.items():
            job = prepare(scene, rtol=RTOL, **settings)
            spent = _Spent(size.rounds, job.integrate)
            trajectory = spent.last
            told = memory if name == "bdf" else ""
            yield spent.row(name, size.bodies, int(trajectory.statistics["steps"]), trajectory.q - reference, told)
        run = Run(size.by_hand(), RTOL)
        spent = _Spent(1, lambda: run.rows(self.times))
        q = spent.last[:, : reference.shape[1]]
        yield spent.row("yardstick", size.bodies, run.steps(), q - reference, "")
        run.close()

    def _memory(self, bodies: int) -> float:
        """Growth of a process' largest memory by solving the problem after one of ten bodies, kB for each body."""
        program = (
            "import resource\n"
            "def largest():\n"
            "    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss\n"
            f"n = 10\n{self.memory_of}\nbefore = largest()\nn = {bodies}\n{self.memory_of}\nprint(largest() - before)"
        )
        found = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
        return float(found.stdout) / bodies if found.returncode == 0 else float("nan")


class _Spent:
    """Times of repeated solutions and the last of them."""

    def __init__(self, rounds: int, solve: Callable) -> None:
        self.times = []
        for _ in range(rounds):
            begun = time.process_time()
            self.last = solve()
            self.times.append(time.process_time() - begun)

    def row(self, solver: str, bodies: int, steps: int, difference: np.ndarray, told: str) -> Row:
        """The row of a size."""
        seconds = statistics.median(self.times)
        each = seconds / bodies / steps
        setting = f"{bodies} bodies, {steps} steps of {each * 1e6:.2f} us a body{told}"
        return Row(solver, setting, float(np.max(np.abs(difference))), seconds, solver == "yardstick")
