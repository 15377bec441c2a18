"""What steps of the explicit and of the implicit integrator cost, for the choice between them.

Microseconds on one machine, as ``python -m tests.bench.costs`` measures them; their ratios alone are used.  They are
no clock, so that a scene is solved the same way each time.
"""

from __future__ import annotations

from dataclasses import dataclass

from .dynamics import Dynamics

EXPLICIT_STEP = (1.96, 0.002, 0.139)
"""Of order 8, with 12 accelerations: for itself, for an operation of the kernels of accelerations, and for a constraint equation."""
BY_ELIMINATION, BY_LARGE_BLOCKS = 0.007, (50.0, 0.0022)
"""More for a multiplication of the elimination that finds accelerations; where these are many, they are in large blocks: for what each
block costs beside them, and for one of them."""
BY_LU = 0.007
"""More for a multiplication of the LU of the whole where accelerations are not found by elimination (0.004 on a hub with 60 arms, 0.010 on
cars on ideal joints)."""
RESIDUAL = (0.34, 0.0131)
"""Of BDF, with what else a step consists of: for itself, and for an unknown."""
MATRIX = (0.00029, 1.9)
"""For an operation of the kernels of the iteration matrix, and times as long as its linear solver is estimated to take."""
LEAST_FACTORS = 0.044
"""Of the linear solver for an unknown, before it is chosen: those of a chain; others take up to six times as long."""
RESIDUALS, MATRICES = 1.5, 0.2
"""Of a step of BDF on average."""
START = (250.0, 3.5)
"""Consistent values and the integrators' memory, when a run switches integrator: for itself, and for an unknown."""
STEPS_OF_A_START = 40
"""Of BDF, from order 1 on to where its own steps are."""
STEPS_OF_A_RESTART = 27
"""Explicit ones, rejected ones among them, more than stability asks for at a breakpoint or an event: 5 to 23 on cars, where one takes up to
two starts, each as dear as two steps."""


@dataclass(frozen=True)
class ImplicitCost:
    """What BDF costs.

    Attributes
    ----------
    residual, matrix : float
        One of each, with the solutions by the matrix.
    memory : float
        Of a start, but for its first steps.
    """

    residual: float
    matrix: float
    memory: float

    @classmethod
    def of(cls, dynamics: Dynamics, factors: float | None = None) -> ImplicitCost:
        """That of a scene; `factors` is what a matrix' factors and solutions are estimated to take, None where that is not known."""
        n = unknowns(dynamics)
        operation, times = MATRIX
        factors = LEAST_FACTORS * n if factors is None else factors
        return cls(
            RESIDUAL[0] + RESIDUAL[1] * n,
            operation * dynamics.system.n_operations("tangent") + times * factors,
            START[0] + START[1] * n,
        )

    def work(self, residuals: float, matrices: float) -> float:
        """So many residuals and iteration matrices."""
        return residuals * self.residual + matrices * self.matrix

    @property
    def step(self) -> float:
        """A step, as they are on average."""
        return self.work(RESIDUALS, MATRICES)

    @property
    def start(self) -> float:
        """A start, with its small steps."""
        return self.memory + STEPS_OF_A_START * self.step


def of_explicit_step(dynamics: Dynamics) -> float:
    """A step of DOP853."""
    itself, operation, equation = EXPLICIT_STEP
    system = dynamics.system
    linear = (
        _of_elimination(dynamics.eliminated.multiplications)
        if dynamics.eliminated.serves
        else BY_LU * dynamics.lu_updates
    )
    return itself + operation * system.n_operations("acceleration") + equation * system.n_c + linear


def _of_elimination(multiplications: int) -> float:
    """Those of a step."""
    blocks, each = BY_LARGE_BLOCKS
    return min(BY_ELIMINATION * multiplications, blocks + each * multiplications)


def unknowns(dynamics: Dynamics) -> int:
    """Of the implicit integrator: coordinates, velocities, and multipliers for both."""
    coordinates = dynamics.coordinates
    solved_for = dynamics.system.active & ~coordinates.satisfied
    free = coordinates.independent.sum() + coordinates.independent_u.sum()
    return int(free) + 2 * int(solved_for.sum())
