"""What radau and bdf would gain from matrices that turn with the bodies: an upper bound.

    python -m tests.bench.solvers.corotation [SCENE...]

The matrix of a step is compared with that of the step before, as it is and with its rows and columns turned with the
bodies. Equations of joints are turned by the best orthogonal matrix of each joint. The measure is the spectral radius of
I - A_old^-1 A_new, the rate of convergence of Newton's iteration with the old matrix and the new step.
"""

from __future__ import annotations

import itertools
import sys
import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from stiffmbs.analyses.job import prepare
from stiffmbs.compile.equations import ABSENT, Equations
from stiffmbs.compile.machine.routines import TERMS
from stiffmbs.compile.terms import TERM_SETS
from stiffmbs.dynamics.dynamics import Dynamics
from stiffmbs.model.model_data import ModelData
from stiffmbs.model.settings import RunSettings
from stiffmbs.solve.bdf import bdf_integrator
from stiffmbs.solve.ida.native_engine import NativeEngine
from stiffmbs.solve.radau.collocation import radau
from stiffmbs.solve.radau.radau import radau_integrator

from ...by_callbacks import Callbacks
from ..costs import SCENES
from ..error_control import scene
from .complex_factors import factors_of, least

CHOSEN: dict[str, Callable[[], ModelData]] = {
    **{name: scene(name) for name in ("governor", "rolling_disc", "heavy_top", "dzhanibekov")},
    "reference_car": SCENES["reference_car_bushings"],
}
RTOL, LONGEST, MOST, RUNS = 1e-6, 5.0, 60, 5
"""Relative tolerance, longest motion, s, largest number of pairs of steps that are compared, and timed runs."""
KEPT = 0.05
"""Rate below which an old matrix serves."""


def turning(equations: Equations, before: np.ndarray, after: np.ndarray) -> np.ndarray:
    """Return the orthogonal matrix that turns the coordinates and velocities of all bodies from one state to another."""
    turn, system = np.eye(equations.n), equations.system
    q_at, u_at = equations.at["q"], equations.at["u"]
    for body in range(system.n_q // 7):
        place, turned = q_at[7 * body : 7 * body + 3], q_at[7 * body + 3 : 7 * body + 7]
        moving = u_at[6 * body : 6 * body + 3]
        if np.any(np.concatenate([place, turned, moving]) == ABSENT):
            continue
        old, new = (y[turned] / np.linalg.norm(y[turned]) for y in (before, after))
        p = product(new) @ (old * [1, -1, -1, -1])
        by_left = product(p)
        rotation = 2 * np.outer(p[1:], p[1:]) + (2 * p[0] ** 2 - 1) * np.eye(3) + 2 * p[0] * by_left[1:, 1:] - 2 * p[0] ** 2 * np.eye(3)  # fmt: skip
        turn[np.ix_(turned, turned)] = by_left
        for at in (place, moving):
            turn[np.ix_(at, at)] = rotation
    return turn


def product(p: np.ndarray) -> np.ndarray:
    """Return the matrix of the product of a quaternion with another one."""
    a, x, y, z = p
    return np.array([[a, -x, -y, -z], [x, a, -z, y], [y, z, a, -x], [z, -y, x, a]])


def with_joints(equations: Equations, turn: np.ndarray, old: np.ndarray, new: np.ndarray) -> np.ndarray:
    """Turn the equations of each joint by the best orthogonal matrix (Procrustes)."""
    turn, start = turn.copy(), equations.system.joint_start
    half = turn @ old @ turn.T
    for name in ("lam", "mu"):
        for first, end in itertools.pairwise(start):
            at = equations.at[name][first:end]
            at = at[at != ABSENT]
            if len(at):
                left, _, right = np.linalg.svd(new[at] @ half[at].T + new[:, at].T @ half[:, at])
                turn[np.ix_(at, at)] = left @ right
    return turn


def rate(old: np.ndarray, new: np.ndarray) -> float:
    """Return the spectral radius of I - A_old^-1 A_new."""
    return float(np.abs(np.linalg.eigvals(np.eye(len(old)) - np.linalg.solve(old, new))).max())


def states(job: Any, settings: Any, solver: str, grid: Any) -> tuple[Equations, np.ndarray]:
    """Return the equations of an integrator, and the time, order, unknowns and derivatives of each of its steps."""
    create = radau_integrator if solver == "radau" else bdf_integrator
    integrator = create(job.dynamics, settings)
    engine = integrator.engine
    assert isinstance(engine, NativeEngine)
    engine.ida.keep_steps(True)
    kept = []
    for _ in integrator.run(job.start, grid):
        kept.append(engine.ida.kept_steps())
    engine.ida.keep_steps(False)
    return integrator.engine.equations, np.concatenate(kept)


def rates(job: Any, settings: Any, solver: str, grid: Any) -> tuple[np.ndarray, np.ndarray]:
    """Return the rates of convergence with the matrix of the step before, as it is and turned."""
    equations, steps = states(job, settings, solver, grid)
    callbacks, n = Callbacks(equations, job.dynamics.state), equations.n
    chosen = np.unique(np.linspace(2, len(steps) - 1, MOST).astype(int))

    def matrix(row: np.ndarray, cj: float) -> np.ndarray:
        a = np.zeros((n, n))
        y, yp = row[2 : 2 + n].copy(), row[2 + n :].copy()
        callbacks.jacobian(row[0], y, yp, np.zeros(n), cj, a)
        return a

    plain, turned = [], []
    for k in chosen:
        before, after = steps[k - 1], steps[k]
        stages = (int(after[1]) + 1) // 2
        factor = radau(stages).gamma if solver == "radau" else sum(1 / j for j in range(1, int(after[1]) + 1))
        cj = factor / (after[0] - before[0])
        old, new = matrix(before, cj), matrix(after, cj)
        turn = with_joints(equations, turning(equations, before[2 : 2 + n], after[2 : 2 + n]), old, new)
        plain.append(rate(old, new))
        turned.append(rate(turn @ old @ turn.T, new))
    return np.array(plain), np.array(turned)


def share(make: Callable[[], ModelData], solver: str, duration: float) -> tuple[float, Any]:
    """Return the share of matrices and factors in the time of a run, and its counters."""
    whole = prepare(make(), solver=solver, rtol=RTOL, duration=duration)
    times = []
    for _ in range(RUNS):
        begun = time.process_time()
        found = whole.integrate()
        times.append(time.process_time() - begun)
    by_radau = prepare(make(), solver="radau", rtol=RTOL, duration=duration)  # has real and complex factors
    by_radau.integrate()
    costs = [matrix_times(part.dynamics, by_radau.settings) for part in by_radau.subsystems or [by_radau]]
    real, pair, kernels = np.mean(costs, axis=0)
    counted = found.statistics
    sets, factors = int(counted["jacobians"]), int(counted["factorizations"])
    work = sets * kernels + factors * ((real + 2 * pair) / 3 if solver == "radau" else real)
    return 1e-6 * work / min(times), counted


def matrix_times(dynamics: Dynamics, settings: RunSettings) -> tuple[float, float, float]:
    """Return the times of a real and of a complex factorisation, and of the kernels of a matrix, us."""
    formula, (factors, _) = factors_of(dynamics, settings)
    table = dynamics.state.restricted(formula._equations.used())
    kernels = least(
        TERMS.call, 0.0, list(TERM_SETS).index(formula._equations.formulation.matrix_set), table.ctypes.data
    )
    return factors[0], factors[1], kernels


def rows(name: str, make: Callable[[], ModelData]) -> Iterator[str]:
    """Yield a line for each solver."""
    duration = min(LONGEST, prepare(make()).grid.end)
    for solver in ("radau", "bdf"):
        part, counted = share(make, solver, duration)
        job = prepare(make(), solver=solver, rtol=RTOL, duration=duration, presolve=False)
        plain, turned = rates(job, job.settings, solver, job.grid)
        served = [100 * np.mean(found < KEPT) for found in (plain, turned)]
        yield f"{name:14} {solver:6} {counted['steps']:6d} {counted['jacobians']:8d} {100 * part:8.0f} {np.median(plain):9.1e} {np.median(turned):9.1e} {served[0]:8.0f} {served[1]:8.0f}"


def main() -> None:
    """Print the table."""
    print("scene          solver  steps matrices  share, %  rate: as it is, turned   below 0.05, %: as it is, turned")
    for name in sys.argv[1:] or CHOSEN:
        for row in rows(name, CHOSEN[name]):
            print(row, flush=True)


if __name__ == "__main__":
    main()
