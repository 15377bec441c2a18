"""Choice of the driver of IDA, and of the linear solver with the least estimated cost."""

from __future__ import annotations

from dataclasses import dataclass

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
from .engine import Engine
from .libraries import Unavailable, ida_libraries, sparse_libraries
from .matrices import Dense, Matrix, Sparse
from .native_engine import NativeEngine
from .operations import replaceable
from .sundae import SundaeEngine


@dataclass(frozen=True)
class LinearSolverCosts:
    """Times of one factorisation with its eight solutions, ns.

    Source: measured on examples with 10 to 1000 unknowns (`tests.bench`, problem ``linear_algebra``).
    """

    fixed: tuple[float, float, float] = (0.36, 6.05, 8.0)
    """For an update, an entry and an unknown in a fixed order."""
    blocks: tuple[float, float, float, float] = (0.05, 0.32, 40.0, 138.0)
    """The same by blocks, and for a node."""
    cached_nodes: int = 3000
    """Number of nodes whose blocks fit into a processor's own cache."""
    far_node: float = 450.0
    """Additional time for each further node."""
    worth_compiling: float = 200.0
    """Time that blocks must save to be worth compiling on a machine's first run."""
    dense_up_to: int = 90
    """Number of unknowns up to which the dense linear solver of SUNDIALS is used, where its operations cannot be
    replaced; SuperLU_MT beyond."""


COSTS = tuned("linear_solver", LinearSolverCosts())
"""Costs of every run."""


def sparse_cost(n: int, order: EliminationOrder, costs: tuple[float, float, float]) -> float:
    """Return the estimated cost of a sparse matrix without blocks."""
    update, entry, unknown = costs
    return update * order.updates + entry * order.fill + unknown * n


def block_cost(n: int, order: EliminationOrder, n_nodes: int) -> float:
    """Return the estimated cost of an elimination by blocks; infinite if they are too many for 32-bit indices."""
    if 2 * QUAD * order.fill > np.iinfo(np.int32).max:
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
        case Dense() | Sparse():
            entries = len(matrix.rows)
            return sparse_cost(matrix.n, EliminationOrder(np.arange(matrix.n), entries, entries), COSTS.fixed)
    raise TypeError(f"found {matrix.sentence()}, expected one of the linear solvers of this module")


def chosen(equations: Equations) -> tuple[Equations, Matrix, float]:
    """Return the equations, the linear solver of the least estimated cost, and that cost, ns."""
    n, pattern = equations.n, equations.pattern
    if not replaceable(ida_libraries()):
        other = Dense(n, *pattern) if is_dense(n) else Sparse(n, *pattern)
        return equations, other, cost_of(other)
    order = elimination_order(equations)
    entries, blocks = FixedOrder(n, *pattern, order), BlockLU.of(equations, order)
    by_entries, by_blocks = cost_of(entries), cost_of(blocks) + COSTS.worth_compiling
    return (equations, blocks, by_blocks) if by_blocks < by_entries else (equations, entries, by_entries)


def is_dense(n: int) -> bool:
    """Return True if SUNDIALS' own linear solver is the dense one; SuperLU_MT may be missing in scikit-sundae."""
    if n <= COSTS.dense_up_to:
        return True
    try:
        sparse_libraries()
    except Unavailable:
        return True
    return False


def driven_natively(
    dynamics: Dynamics, settings: RunSettings, control: ErrorControl
) -> tuple[Equations, Engine, float]:
    """Return the equations, their native driver and the cost of its linear solver, ns."""
    equations, matrix, cost = chosen(natural(dynamics, settings))
    return equations, NativeEngine(equations, dynamics, matrix, settings, control), cost


def driven_by_callbacks(dynamics: Dynamics, settings: RunSettings) -> tuple[Equations, Engine, float]:
    """Return the equations, their driver by scikit-sundae's callbacks and the cost of its linear solver, ns."""
    equations = natural(dynamics, settings)
    tolerances = ErrorControl(margin=1.0).tolerances(equations, settings)  # with IDA's own Newton tolerance
    engine = SundaeEngine(
        equations, dynamics.state, *tolerances, settings.max_step, settings.max_order or 5, is_dense(equations.n)
    )
    return equations, engine, cost_of(Sparse(equations.n, *equations.pattern))


def natural(dynamics: Dynamics, settings: RunSettings) -> Equations:
    """Return the equations with their unknowns in the natural order."""
    return Equations(FORMULATIONS[settings.formulation](settings), dynamics.system, dynamics.coordinates)
