"""Cost model of explicit and implicit steps, for the choice between the integrators.

Costs are in microseconds of one machine (``python -m tests.bench.costs``); only their ratios are used. No clock is
read, so that the choice is reproducible.
"""

from __future__ import annotations

from dataclasses import dataclass

from .dynamics import Dynamics

EXPLICIT_STEP = (1.96, 0.002, 0.139)
"""Cost of a DOP853 step: fixed, per operation of the acceleration kernels, per constraint equation."""
BY_ELIMINATION, BY_LARGE_BLOCKS = 0.007, (50.0, 0.0022)
"""Cost per multiplication of the elimination; in large blocks, used for many: fixed, and per multiplication."""
BY_LU = 0.007
"""Cost per multiplication of the LU of the full block system, where accelerations are not found by elimination."""
RESIDUAL = (0.34, 0.0131)
"""Cost of a BDF residual with its share of the step: fixed, and per unknown."""
MATRIX = (0.00029, 1.9)
"""Cost per operation of the iteration matrix kernels, and factor on the estimated time of its linear solver."""
LEAST_FACTORS = 0.044
"""Cost of the linear solver per unknown, used before it is chosen: that of a chain, a lower bound."""
RESIDUALS, MATRICES = 1.5, 0.2
"""Average numbers of residuals and iteration matrices per BDF step."""
START = (250.0, 3.5)
"""Cost of consistent initial values and integrator memory at a switch of integrator: fixed, and per unknown."""
STEPS_OF_A_START = 40
"""Small BDF steps from order 1 up to the regular step size."""
STEPS_OF_A_RESTART = 27
"""Explicit steps, including rejected ones, that a breakpoint or an event adds to those that stability requires."""


@dataclass(frozen=True)
class ImplicitCost:
    """Cost of BDF.

    Attributes
    ----------
    residual, matrix : float
        Cost of each, with the solutions of the linear system.
    memory : float
        Cost of a start, excluding its small steps.
    """

    residual: float
    matrix: float
    memory: float

    @classmethod
    def of(cls, dynamics: Dynamics, factors: float | None = None) -> ImplicitCost:
        """Return the cost for a scene; `factors` is the estimated time of the linear solver, None if unknown."""
        n = unknowns(dynamics)
        operation, times = MATRIX
        factors = LEAST_FACTORS * n if factors is None else factors
        return cls(
            RESIDUAL[0] + RESIDUAL[1] * n,
            operation * dynamics.system.n_operations("tangent") + times * factors,
            START[0] + START[1] * n,
        )

    def work(self, residuals: float, matrices: float) -> float:
        """Return the cost of a number of residuals and iteration matrices."""
        return residuals * self.residual + matrices * self.matrix

    @property
    def step(self) -> float:
        """Average cost of a step."""
        return self.work(RESIDUALS, MATRICES)

    @property
    def start(self) -> float:
        """Cost of a start, including its small steps."""
        return self.memory + STEPS_OF_A_START * self.step


def of_explicit_step(dynamics: Dynamics) -> float:
    """Return the cost of a DOP853 step."""
    itself, operation, equation = EXPLICIT_STEP
    system = dynamics.system
    linear = (
        _of_elimination(dynamics.eliminated.multiplications)
        if dynamics.eliminated.serves
        else BY_LU * dynamics.lu_updates
    )
    return itself + operation * system.n_operations("acceleration") + equation * system.n_c + linear


def _of_elimination(multiplications: int) -> float:
    """Return the cost of the multiplications of a step."""
    blocks, each = BY_LARGE_BLOCKS
    return min(BY_ELIMINATION * multiplications, blocks + each * multiplications)


def unknowns(dynamics: Dynamics) -> int:
    """Return the number of unknowns of BDF: coordinates, velocities, and two multipliers per constraint."""
    coordinates = dynamics.coordinates
    solved_for = dynamics.system.active & ~coordinates.satisfied
    free = coordinates.independent.sum() + coordinates.independent_u.sum()
    return int(free) + 2 * int(solved_for.sum())
