"""Choice of the driver of IDA, and of the linear solver with the least estimated cost."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...compile.equations import Equations
from ...dynamics.dynamics import Dynamics
from ...model.settings import RunSettings
from ...sparse.elimination_order import EliminationOrder, elimination_order
from ...tuning import tuned
from ..error_control.error_test import ErrorControl
from ..formulations import FORMULATIONS
from ..linear_solvers.block_lu import BlockLU
from ..linear_solvers.fixed_order import FixedOrder
from .engine import Engine
from .libraries import Unavailable, ida_libraries
from .matrices import Dense, Matrix, Sparse
from .native_engine import NativeEngine
from .operations import replaceable
from .sundae import SundaeEngine


@dataclass(frozen=True)
class LinearSolverCosts:
    """Times of one factorisation with its eight solutions, ns.

    Source: measured on examples with 10 to 1000 unknowns (`tests.bench`, problem ``linear_algebra``).
    """

    dense: tuple[float, float, float] = (0.045, 2.92, 80.0)
    """For a multiplication of the LU, an entry, an unknown."""
    superlu: tuple[float, float, float] = (0.15, 6.6, 664.0)
    """For an update of full blocks, an entry of their factors, an unknown, of SuperLU_MT."""
    fixed: tuple[float, float, float] = (0.36, 6.05, 8.0)
    """The same in a fixed order."""
    blocks: tuple[float, float, float, float] = (0.05, 0.32, 40.0, 138.0)
    """The same, and for a node."""
    cached_nodes: int = 3000
    """Number of nodes whose blocks fit into a processor's own cache."""
    far_node: float = 450.0
    """Additional time for each further node."""
    worth_compiling: float = 200.0
    """Time that blocks must save to be worth compiling on a machine's first run."""
    with_zeros: int = 8
    """Upper bound of the numbers stored in the blocks, relative to the entries of a triangle of full blocks."""


COSTS = tuned("linear_solver", LinearSolverCosts())
"""Costs of every run."""


def dense_cost(n: int) -> float:
    """Return the estimated cost of a dense matrix."""
    update, entry, unknown = COSTS.dense
    return update * n**3 / 3 + entry * n**2 + unknown * n


def sparse_cost(n: int, order: EliminationOrder, costs: tuple[float, float, float]) -> float:
    """Return the estimated cost of a sparse matrix without blocks."""
    update, entry, unknown = costs
    return update * order.updates + entry * order.fill + unknown * n


def block_cost(n: int, order: EliminationOrder, n_nodes: int) -> float:
    """Return the estimated cost of an elimination by blocks; infinite if they are too many for 32-bit indices."""
    if COSTS.with_zeros * order.fill > np.iinfo(np.int32).max:
        return np.inf
    *costs, node = COSTS.blocks
    far = COSTS.far_node * max(n_nodes - COSTS.cached_nodes, 0)
    return sparse_cost(n, order, (costs[0], costs[1], costs[2])) + node * n_nodes + far


def cost_of(matrix: Matrix) -> float:
    """Return the estimated cost of a linear solver."""
    match matrix:
        case BlockLU():
            return block_cost(matrix.n, matrix.order, len(matrix.nodes))
        case FixedOrder():
            return sparse_cost(matrix.n, matrix.order, COSTS.fixed)
        case Dense():
            return dense_cost(matrix.n)
        case Sparse():
            entries = len(matrix.rows)
            return sparse_cost(matrix.n, EliminationOrder(np.arange(matrix.n), entries, entries), COSTS.superlu)
    raise TypeError(f"found {matrix.sentence()}, expected one of the linear solvers of this module")


def chosen(equations: Equations) -> tuple[Equations, Matrix, float]:
    """Return the equations, the linear solver of the least estimated cost, and that cost, ns."""
    n, pattern, order = equations.n, equations.pattern, elimination_order(equations)
    offers: list[tuple[float, Matrix]] = [
        (dense_cost(n), Dense(n, *pattern)),
        (sparse_cost(n, order, COSTS.superlu), Sparse(n, *pattern)),
    ]
    if replaceable(ida_libraries()):
        blocks = BlockLU.of(equations, order)
        offers.append((sparse_cost(n, order, COSTS.fixed), FixedOrder(n, *pattern, order)))
        offers.append((block_cost(n, order, len(blocks.nodes)) + COSTS.worth_compiling, blocks))
    cheapest_first = sorted(offers, key=lambda offer: offer[0])
    return next((equations, matrix, cost) for cost, matrix in cheapest_first if _served(matrix))


def _served(matrix: Matrix) -> bool:
    """Return True if the libraries have the linear solver: scikit-sundae may be built without SuperLU_MT."""
    try:
        matrix.libraries()
    except Unavailable:
        return False
    return True


def driven_natively(
    dynamics: Dynamics, settings: RunSettings, control: ErrorControl
) -> tuple[Equations, Engine, float]:
    """Return the equations, their native driver and the cost of its linear solver, ns."""
    equations, matrix, cost = chosen(natural(dynamics, settings))
    return equations, NativeEngine(equations, dynamics, matrix, settings, control), cost


def driven_by_callbacks(dynamics: Dynamics, settings: RunSettings) -> tuple[Equations, Engine]:
    """Return the equations and their driver by scikit-sundae's callbacks."""
    equations = natural(dynamics, settings)
    tolerances = ErrorControl(margin=1.0).tolerances(equations, settings)  # with IDA's own Newton tolerance
    return equations, SundaeEngine(equations, dynamics.state, *tolerances, settings.max_step, settings.max_order or 5)


def natural(dynamics: Dynamics, settings: RunSettings) -> Equations:
    """Return the equations with their unknowns in the natural order."""
    return Equations(FORMULATIONS[settings.formulation](settings), dynamics.system, dynamics.coordinates)
