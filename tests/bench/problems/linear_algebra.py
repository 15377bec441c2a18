"""`bdf` with the linear solver that it chooses and with the sparse LU, beside what its kernels take alone."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from stiffmbs.analyses.job import Job, prepare
from stiffmbs.compile.equations import Equations
from stiffmbs.compile.machine.routines import TERMS
from stiffmbs.compile.terms import TERM_SETS
from stiffmbs.model.model_data import ModelData
from stiffmbs.solve.bdf import bdf_integrator
from stiffmbs.solve.error_control.error_test import CHOSEN
from stiffmbs.solve.formulations import FORMULATIONS
from stiffmbs.solve.ida.choice import Driven
from stiffmbs.solve.ida.native_engine import NativeEngine
from stiffmbs.solve.linear_solvers.sparse_lu import SparseLU
from stiffmbs.solve.trajectory import Trajectory
from stiffmbs.sparse.elimination_order import elimination_order

from ..benchmark import Row
from ..error_control import scene
from .chain_in_space import chain_in_space

RTOL, ROUNDS = 1e-6, 9
EVALUATIONS = 200
"""Of each set of kernels; the shortest time counts."""


def by_sparse_lu(job: Job) -> Job:
    """The job, to be integrated by `bdf` with the sparse LU."""
    dynamics, control = job.dynamics, CHOSEN[job.dynamics.system.of_body.dimensions]
    equations = Equations(FORMULATIONS[job.settings.formulation](job.settings), dynamics.system, dynamics.coordinates)
    matrix = SparseLU(equations.n, *equations.pattern, elimination_order(equations))
    engine = partial(NativeEngine, equations, dynamics, matrix, job.settings, control)
    dynamics.once(lambda *_: Driven(equations, matrix.cost, engine), job.settings, control, name="bdf")
    return job


def kernel_seconds(job: Job, trajectory: Trajectory) -> float:
    """What the residual and matrix kernels of a run by `bdf` take alone, at the state that it ended with."""
    equations = bdf_integrator(job.dynamics, job.settings).engine.equations
    table = job.dynamics.state.restricted(equations.used())
    form = equations.formulation
    return sum(
        _least(table, list(TERM_SETS).index(term_set), float(trajectory.t[-1])) * int(trajectory.statistics[count])
        for term_set, count in ((form.residual_set, "residuals"), (form.matrix_set, "jacobians"))
    )


def _least(table: np.ndarray, term_set: int, t: float) -> float:
    """The shortest time of an evaluation of a term set, s."""
    evaluate, times = TERMS.call, []
    for _ in range(EVALUATIONS):
        begun = time.perf_counter()
        evaluate(t, term_set, table.ctypes.data)
        times.append(time.perf_counter() - begun)
    return min(times)


@dataclass(frozen=True)
class LinearAlgebra:
    """A scene solved with both linear solvers by turns."""

    scene: str
    make: Callable[[], ModelData]

    @property
    def name(self) -> str:
        return f"linear_algebra_{self.scene}"

    def measured(self) -> list[Row]:
        """Medians of the processor's time of repeated solutions, set-up left out; the error is the difference between both."""
        return self._rows(ROUNDS)

    def glanced(self) -> list[Row]:
        """One solution each."""
        return self._rows(1)

    def _rows(self, rounds: int) -> list[Row]:
        jobs = [
            prepare(self.make(), solver="bdf", rtol=RTOL),
            by_sparse_lu(prepare(self.make(), solver="bdf", rtol=RTOL)),
        ]
        found = [job.integrate() for job in jobs]
        times: list[list[float]] = [[], []]
        for _ in range(rounds):
            for job, own in zip(jobs, times, strict=True):
                begun = time.process_time()
                job.integrate()
                own.append(time.process_time() - begun)
        difference = float(np.max(np.abs(found[0].q - found[1].q)))
        return [self._row(*of, difference) for of in zip(jobs, found, times, strict=True)]

    def _row(self, job: Job, trajectory: Trajectory, times: list[float], difference: float) -> Row:
        seconds, told = statistics.median(times), trajectory.statistics
        solver = str(told["linear_solver"])
        ratio = seconds / kernel_seconds(job, trajectory)
        setting = f"{told['steps']} steps, {told['factorizations']} factors, {ratio:.1f} times its kernels"
        return Row(
            solver.partition(f", {bdf_integrator(job.dynamics, job.settings).engine.equations.n}")[0],
            setting,
            difference,
            seconds,
            False,
        )


BENCHMARKS = (
    LinearAlgebra("front_axle", scene("vehicles/front_axle")),
    *(LinearAlgebra(name, scene(name)) for name in ("governor", "andrews", "spatial_chain")),
    *(LinearAlgebra(f"chain_in_space_{rods}", partial(chain_in_space, rods)) for rods in (10, 100)),
)
