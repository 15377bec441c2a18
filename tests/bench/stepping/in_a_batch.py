"""Many simulations of one model that are stepped together, each with inputs of its own."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from importlib.util import find_spec
from pathlib import Path

import numpy as np

import stiffmbs

from ..benchmark import Row
from .in_the_loop import SCHEMES


@dataclass(frozen=True)
class InABatch:
    """A model whose inputs are all new at each step, in `count` simulations.

    Attributes
    ----------
    name : str
    model : Path
        File of a scene, or an MJCF file, which MuJoCo steps too if it is installed.
    inputs : tuple of str
    size : float
        Largest input.
    schemes : tuple of str
    count, steps, rounds : int
    workers : tuple of int
        Numbers of threads.
    step : float
        s.
    """

    name: str
    model: Path
    inputs: tuple[str, ...]
    size: float
    schemes: tuple[str, ...] = ("rk4", "euler_cromer")
    count: int = 1000
    steps: int = 20
    rounds: int = 5
    workers: tuple[int, ...] = (1, 2)
    step: float = 1e-3

    def measured(self) -> list[Row]:
        """Medians of the time on the clock over rounds; errors are the differences from single simulations."""
        values = self.size * np.random.default_rng(0).random((self.steps, self.count, len(self.inputs)))
        inputs, rows = dict.fromkeys(self.inputs, 0.0), []
        for scheme in self.schemes:
            how = {**SCHEMES[scheme], "step": self.step}
            one = stiffmbs.simulation(self.model, inputs, **how)
            one.steps(self.steps, values[:, 0])
            for workers in self.workers:
                sims = stiffmbs.simulations(self.model, self.count, inputs, workers=workers, **how)

                def take(sims: stiffmbs.Simulations = sims) -> None:
                    sims.reset()
                    for each in values:
                        sims.step(self.step, each)
                        sims.joint_coordinates, sims.joint_rates  # noqa: B018

                row = self._row(scheme, f"{workers} workers", take)
                rows.append(replace(row, error=float(np.abs(sims.q[0] - one.q).max())))
        if self.model.suffix == ".xml" and find_spec("mujoco"):
            rows += [
                self._row("mujoco", f"{workers} workers", self._rollout(values, workers), True)
                for workers in self.workers
            ]
        return rows

    def glanced(self) -> list[Row]:
        """A few steps."""
        return replace(self, count=10, steps=2, rounds=1).measured()

    def _row(self, solver: str, how: str, take: Callable[[], object], peer: bool = False) -> Row:
        spent = []
        for _ in range(self.rounds):
            begun = time.perf_counter()
            take()
            spent.append(time.perf_counter() - begun)
        seconds = statistics.median(spent)
        each = 1e3 * seconds / self.steps
        return Row(solver, f"{how}: {each:.2f} ms for a step of {self.count}", 0.0, seconds, peer)

    def _rollout(self, values: np.ndarray, workers: int) -> Callable[[], object]:
        """Return a function that takes all steps by MuJoCo."""
        import mujoco
        from mujoco import rollout

        model = mujoco.MjModel.from_xml_path(str(self.model))
        data = [mujoco.MjData(model) for _ in range(workers)]
        spec = mujoco.mjtState.mjSTATE_FULLPHYSICS
        start = np.empty(mujoco.mj_stateSize(model, spec))
        mujoco.mj_getState(model, data[0], start, spec)
        starts, controls = np.tile(start, (self.count, 1)), np.ascontiguousarray(values.transpose(1, 0, 2))
        return lambda: rollout.rollout(model, data, starts, controls)
