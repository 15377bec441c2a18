"""Cost model of explicit and implicit steps, for the choice between the integrators.

Costs are in microseconds of one machine (``python -m tests.bench.costs``); only their ratios are used. No clock is
read, so that the choice is reproducible.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

from ..dynamics.dynamics import Dynamics
from ..tuning import tuned
from .explicit.dop853 import DOP853


@dataclass(frozen=True)
class CostParameters:
    """Costs of the parts of steps and starts, in microseconds.

    Source: least-squares fit of processor times of 20 scenes by ``python -m tests.bench.costs``.

    - `explicit_step`: DOP853 step, without the following items.
    - `explicit_operation`: operation of the acceleration kernels in such a step.
    - `explicit_equation`: constraint equation in such a step.
    - `multiplication`: multiplication of the elimination in such a step, or of the LU of the full block system.
    - `large_blocks`, `large_block_multiplication`: elimination by large blocks, which many multiplications have:
      fixed, and per multiplication.
    - `residual`, `residual_unknown`: BDF residual with its share of the step: fixed, and per unknown.
    - `matrix_operation`: operation of the kernels of the iteration matrix.
    - `matrix_solver`: factor on the estimated time of the linear solver.
    - `least_solver`: linear solver per unknown, before it is chosen: that of a chain, a lower bound.
    - `step_residuals`, `step_matrices`: average numbers of residuals and of iteration matrices in a BDF step.
    - `start`, `start_unknown`: consistent initial values and integrator memory at a switch of integrator: fixed, and
      per unknown.
    - `start_steps`: small BDF steps from order 1 up to the regular step size, per digit of the relative tolerance.
    - `restart_steps`: explicit steps, including rejected ones, that a breakpoint or an event adds to those that
      stability requires.
    """

    explicit_step: float = 1.96
    explicit_operation: float = 0.002
    explicit_equation: float = 0.139
    multiplication: float = 0.007
    large_blocks: float = 50.0
    large_block_multiplication: float = 0.0022
    residual: float = 0.34
    residual_unknown: float = 0.0131
    matrix_operation: float = 0.00029
    matrix_solver: float = 1.9
    least_solver: float = 0.044
    step_residuals: float = 1.5
    step_matrices: float = 0.2
    start: float = 250.0
    start_unknown: float = 3.5
    start_steps: float = 10.0
    restart_steps: int = 27


COSTS = tuned("cost", CostParameters())
"""Costs of every run."""


@dataclass(frozen=True)
class ImplicitCost:
    """Cost of implicit steps.

    - `residual`, `matrix`: cost of each, with the solutions of the linear system.
    - `memory`: cost of a start, excluding its small steps.
    - `step_residuals`, `step_matrices`: average numbers of residuals and of real iteration matrices in a step; those
      of BDF by default.
    - `start_steps`: small steps up to the regular step size, per digit of the relative tolerance.
    """

    residual: float
    matrix: float
    memory: float
    step_residuals: float = field(default_factory=lambda: COSTS.step_residuals)
    step_matrices: float = field(default_factory=lambda: COSTS.step_matrices)
    start_steps: float = field(default_factory=lambda: COSTS.start_steps)

    @classmethod
    def of(cls, dynamics: Dynamics, factors: float | None = None) -> ImplicitCost:
        """Return the cost for a scene; `factors` is the estimated time of the linear solver, None if unknown."""
        n = unknowns(dynamics)
        factors = least_solver(dynamics) if factors is None else factors
        return cls(
            COSTS.residual + COSTS.residual_unknown * n,
            COSTS.matrix_operation * dynamics.system.n_operations("tangent") + COSTS.matrix_solver * factors,
            COSTS.start + COSTS.start_unknown * n,
        )

    def work(self, residuals: float, matrices: float) -> float:
        """Return the cost of a number of residuals and iteration matrices."""
        return residuals * self.residual + matrices * self.matrix

    @property
    def step(self) -> float:
        """Average cost of a step."""
        return self.work(self.step_residuals, self.step_matrices)


def of_explicit_step(dynamics: Dynamics) -> float:
    """Return the cost of a DOP853 step."""
    system = dynamics.system
    kernels = COSTS.explicit_operation * system.n_operations("acceleration")
    linear = (
        _of_elimination(dynamics.eliminated.multiplications)
        if dynamics.eliminated.serves
        else COSTS.multiplication * dynamics.lu_updates
    )
    return COSTS.explicit_step + kernels + COSTS.explicit_equation * system.n_c + linear


def _of_elimination(multiplications: int) -> float:
    """Return the cost of the multiplications of a step."""
    by_large_blocks = COSTS.large_blocks + COSTS.large_block_multiplication * multiplications
    return min(COSTS.multiplication * multiplications, by_large_blocks)


def of_evaluation(dynamics: Dynamics) -> float:
    """Return the cost of a residual without solutions: kernels, as in a stage of DOP853, and vectors."""
    return of_kernels(dynamics) + COSTS.residual_unknown * unknowns(dynamics)


def of_kernels(dynamics: Dynamics) -> float:
    """Return the cost of the kernels of a stage of DOP853, which that of another set of terms is about as high as."""
    return COSTS.explicit_operation * dynamics.system.n_operations("acceleration") / DOP853.stages


def least_solver(dynamics: Dynamics) -> float:
    """Return a lower bound of the cost of a linear solver that is not yet chosen."""
    return COSTS.least_solver * unknowns(dynamics)


def unknowns(dynamics: Dynamics) -> int:
    """Return the number of unknowns of BDF: coordinates, velocities, and two multipliers per constraint."""
    coordinates = dynamics.coordinates
    solved_for = dynamics.system.active & ~coordinates.satisfied
    free = coordinates.independent.sum() + coordinates.independent_u.sum()
    return int(free) + 2 * int(solved_for.sum())


class Counted(NamedTuple):
    """Count of steps, or those since an earlier count.

    `time`: time of the motion, s. `cost`: that of all attempts. Of explicit steps, `accepted` ones, `limited` of which were
    limited by stability. Of implicit ones, `restarts` at breakpoints and events, and `long` ones: those of `radau`, which
    steps of DOP853, of similar order, do not exceed in length.
    """

    time: float
    cost: float
    accepted: int = 0
    limited: int = 0
    restarts: int = 0
    long: int = 0

    def since(self, before: Counted) -> Counted:
        """Return the steps taken after an earlier count."""
        return Counted._make(now - then for now, then in zip(self, before, strict=True))

    @property
    def rate(self) -> float:
        """Cost per second of the motion."""
        return self.cost / self.time
