"""Choice of the linear solver with the least estimated cost."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial

from ...compile.equations import Equations
from ...dynamics.dynamics import Dynamics
from ...model.settings import RunSettings
from ...sparse.elimination_order import elimination_order
from ..error_control.error_test import CHOSEN, ErrorControl
from ..formulations import FORMULATIONS
from ..linear_solvers.block_lu import BlockLU
from ..linear_solvers.linear_solver import COSTS, LinearSolver
from ..linear_solvers.sparse_lu import SparseLU
from .native_engine import NativeEngine


def chosen(equations: Equations) -> tuple[LinearSolver, float]:
    """Return the linear solver of the least estimated cost, and that cost, ns, with what blocks must save to be compiled."""
    order = elimination_order(equations)
    blocks, sparse = BlockLU.of(equations, order), SparseLU(equations.n, *equations.pattern, order)
    of_blocks = blocks.cost + COSTS.worth_compiling
    return (sparse, sparse.cost) if sparse.cost <= of_blocks else (blocks, of_blocks)


@dataclass(frozen=True)
class Driven:
    """Equations, the estimated cost of a linear solver, ns, and the engine that solves them, made when it is needed."""

    equations: Equations
    cost: float
    make: Callable[[], NativeEngine]

    @cached_property
    def engine(self) -> NativeEngine:
        """Engine, made at its first use: its memory and its routines take time."""
        return self.make()


Driver = Callable[[Dynamics, RunSettings, ErrorControl], Driven]


def driven(
    dynamics: Dynamics, settings: RunSettings, control: ErrorControl | None = None, memory: str = "bdf",
    driver: Driver | None = None,
) -> Driven:  # fmt: skip
    """Return the equations with their engine, which the dynamics keep under the name `memory`; with BDF by default."""
    chosen = control or CHOSEN[dynamics.system.of_body.dimensions]
    return dynamics.once(driver or driven_natively, settings, chosen, name=memory)


def driven_natively(dynamics: Dynamics, settings: RunSettings, control: ErrorControl) -> Driven:
    """Return the equations with their engine."""
    equations = natural(dynamics, settings)
    matrix, cost = chosen(equations)
    return Driven(equations, cost, partial(NativeEngine, equations, dynamics, matrix, settings, control))


def natural(dynamics: Dynamics, settings: RunSettings) -> Equations:
    """Return the equations with their unknowns in the natural order."""
    return Equations(FORMULATIONS[settings.formulation](settings), dynamics.system, dynamics.coordinates)
