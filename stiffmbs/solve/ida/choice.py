"""Choice of the linear solver with the least estimated cost."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np

from ...compile.equations import Equations
from ...dynamics.dynamics import Dynamics
from ...model.settings import RunSettings
from ...sparse.blocks import QUAD
from ...sparse.elimination_order import EliminationOrder, elimination_order
from ...tuning import tuned
from ..error_control.error_test import ErrorControl
from ..formulations import FORMULATIONS
from ..linear_solvers.block_lu import BlockLU
from ..linear_solvers.fixed_order import FixedOrder
from .native_engine import NativeEngine


@dataclass(frozen=True)
class LinearSolverCosts:
    """Times of one factorisation with its eight solutions, ns.

    Source: measured on examples with 10 to 1000 unknowns (`tests.bench`, problem ``linear_algebra``).
    """

    fixed: tuple[float, float, float] = (0.36, 6.05, 8.0)
    """For an update of full blocks, an entry of their factors, an unknown, in a fixed order."""
    blocks: tuple[float, float, float, float] = (0.05, 0.32, 40.0, 138.0)
    """The same, and for a node."""
    cached_nodes: int = 3000
    """Number of nodes whose blocks fit into a processor's own cache."""
    far_node: float = 450.0
    """Additional time for each further node."""
    worth_compiling: float = 200.0
    """Time that blocks must save to be worth compiling on a machine's first run."""


COSTS = tuned("linear_solver", LinearSolverCosts())
"""Costs of every run."""
MOST_STORED = 2 * QUAD
"""Upper bound of the numbers stored in the blocks, relative to the entries of a triangle of full blocks: in both panels,
a line of one unknown takes a whole quad."""


def sparse_cost(n: int, order: EliminationOrder, costs: tuple[float, float, float]) -> float:
    """Return the estimated cost of a sparse matrix without blocks."""
    update, entry, unknown = costs
    return update * order.updates + entry * order.fill + unknown * n


def block_cost(n: int, order: EliminationOrder, n_nodes: int) -> float:
    """Return the estimated cost of an elimination by blocks; infinite if they are too many for 32-bit indices."""
    if MOST_STORED * order.fill > np.iinfo(np.int32).max:
        return np.inf
    *costs, node = COSTS.blocks
    far = COSTS.far_node * max(n_nodes - COSTS.cached_nodes, 0)
    return sparse_cost(n, order, (costs[0], costs[1], costs[2])) + node * n_nodes + far


def cost_of(matrix: FixedOrder) -> float:
    """Return the estimated cost of a linear solver."""
    if isinstance(matrix, BlockLU):
        return block_cost(matrix.n, matrix.order, len(matrix.nodes))
    return sparse_cost(matrix.n, matrix.order, COSTS.fixed)


def chosen(equations: Equations) -> tuple[FixedOrder, float]:
    """Return the linear solver of the least estimated cost, and that cost, ns."""
    n, order = equations.n, elimination_order(equations)
    blocks, of_entries = BlockLU.of(equations, order), sparse_cost(n, order, COSTS.fixed)
    of_blocks = block_cost(n, order, len(blocks.nodes)) + COSTS.worth_compiling
    if of_entries <= of_blocks:
        return FixedOrder(n, *equations.pattern, order), of_entries
    return blocks, of_blocks


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


def driven_natively(dynamics: Dynamics, settings: RunSettings, control: ErrorControl) -> Driven:
    """Return the equations with their engine."""
    equations = natural(dynamics, settings)
    matrix, cost = chosen(equations)
    return Driven(equations, cost, partial(NativeEngine, equations, dynamics, matrix, settings, control))


def natural(dynamics: Dynamics, settings: RunSettings) -> Equations:
    """Return the equations with their unknowns in the natural order."""
    return Equations(FORMULATIONS[settings.formulation](settings), dynamics.system, dynamics.coordinates)
