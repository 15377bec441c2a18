"""Choice of the driver of IDA, and of the linear solver with the least estimated cost."""

from __future__ import annotations

from contextlib import suppress
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
from .libraries import Unavailable, ida_libraries
from .matrices import Dense, Matrix, Sparse
from .native_engine import NativeEngine
from .operations import replaceable
from .sundae import FALLBACK, SundaeEngine


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


def dense_cost(n: int) -> float:
    """Return the estimated cost of a dense matrix: that of a single block."""
    return block_cost(n, EliminationOrder(np.arange(n), fill=n**2, updates=n**3), n_nodes=1)


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


def cost_of(matrix: Matrix) -> float:
    """Return the estimated cost of a linear solver; that of SuperLU_MT from entries without fill-in."""
    match matrix:
        case BlockLU():
            return block_cost(matrix.n, matrix.order, len(matrix.nodes))
        case FixedOrder():
            return sparse_cost(matrix.n, matrix.order, COSTS.fixed)
        case Dense():
            return dense_cost(matrix.n)
        case Sparse():
            entries = len(matrix.rows)
            return sparse_cost(matrix.n, EliminationOrder(np.arange(matrix.n), entries, entries), COSTS.fixed)
    raise TypeError(f"found {matrix.sentence()}, expected one of the linear solvers of this module")


def chosen(equations: Equations) -> tuple[Equations, Matrix, float]:
    """Return the equations, the linear solver of the least estimated cost, and that cost, ns.

    Solvers of SUNDIALS are slower, and are used only if they cannot be replaced.
    """
    n, pattern = equations.n, equations.pattern
    if not replaceable(ida_libraries()):
        supplied = _supplied(n, pattern)
        return equations, supplied, cost_of(supplied)
    order = elimination_order(equations)
    blocks, of_entries = BlockLU.of(equations, order), sparse_cost(n, order, COSTS.fixed)
    of_blocks = block_cost(n, order, len(blocks.nodes)) + COSTS.worth_compiling
    if of_entries <= of_blocks:
        return equations, FixedOrder(n, *pattern, order), of_entries
    return equations, blocks, of_blocks


def _supplied(n: int, pattern: tuple[np.ndarray, np.ndarray]) -> Matrix:
    """Return a linear solver of SUNDIALS; scikit-sundae may be built without SuperLU_MT."""
    sparse = Sparse(n, *pattern)
    if n > FALLBACK.dense_up_to:
        with suppress(Unavailable):
            sparse.libraries()
            return sparse
    return Dense(n, *pattern)


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
