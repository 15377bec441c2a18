"""Choice of the driver of IDA, and of the linear solver with the least estimated cost."""

from __future__ import annotations

import numpy as np

from ...compile.equations import Equations
from ...describe.settings import RunSettings
from ..dynamics import Dynamics
from ..error_control.error_test import ErrorControl
from ..formulations import FORMULATIONS
from ..linear.elimination_order import EliminationOrder, elimination_order
from .block_lu import BlockLU
from .engine import Engine
from .fixed_order import FixedOrder
from .libraries import Unavailable, ida_libraries
from .matrices import Banded, Dense, Matrix, Sparse
from .native_engine import NativeEngine
from .operations import replaceable
from .ordering import narrowed
from .paired_columns import PairedColumns
from .sundae import SundaeEngine

SOLUTIONS = 8
"""Solutions for one factorisation."""
DENSE = (0.045, 1.0, 0.24, 10.0)
"""ns for a multiplication of the dense LU, an entry cleared and filled, an entry and an unknown of a solution."""
BANDED = (0.15, 0.5, 0.45)
"""ns for a multiplication of the banded LU, an entry cleared and filled, an entry of a solution."""
FIXED = (1.2, 1.5, 0.5, 1.0)
"""ns for an update in a fixed order, for an entry of the factors that is cleared and scaled; for an entry and an
unknown of a solution.  All costs were fitted on the examples with 10 to 1000 unknowns."""
PAIRED = (0.25, 3.0, 0.75, 1.0)
"""ns as in `FIXED`, for two-column supernodes."""
BLOCKS = (0.05, 50.0, 0.04, 5.0, 11.0)
"""ns for an update in blocks, for a node; for an entry of full blocks, an unknown and a node of a solution."""
NEAR, FAR = 3000, 450.0
"""Number of nodes whose blocks fit into a processor's own cache, and additional ns for each further node."""
WORTH_COMPILING = 200.0
"""ns that blocks must save per factorisation and its solutions to be worth compiling on a machine's first run."""
WITH_ZEROS = 8
"""Upper bound of the numbers stored in the blocks, relative to the entries of a triangle of full blocks."""
SUPERLU = (0.5, 0.75, 600.0, 8.0)
"""ns of SuperLU_MT for an update, for an entry of a solution; for an unknown in a factorisation and in a solution."""
WORTH_A_BAND = 50
"""Number of unknowns below which a search for a band is not worth its cost."""
FILLED, UPDATED = 1.1, 0.3
"""Ratios of the actual entries and updates to those of full blocks."""


def dense_cost(n: int) -> float:
    """Return the estimated ns of a factorisation of a dense matrix and its solutions."""
    update, entry, solution, unknown = DENSE
    return update * n**3 / 3 + (entry + SOLUTIONS * solution) * n**2 + SOLUTIONS * unknown * n


def banded_cost(n: int, lower: int, upper: int) -> float:
    """Return the estimated ns of a factorisation of a banded matrix and its solutions."""
    update, entry, solution = BANDED
    height = 2 * lower + upper + 1
    return n * (update * lower * (lower + upper) + (entry + SOLUTIONS * solution) * height)


def fixed_cost(n: int, order: EliminationOrder, costs: tuple[float, float, float, float]) -> float:
    """Return the estimated ns of an elimination in a fixed order, by entries or by two-column supernodes."""
    update, entry, solution, unknown = costs
    entries, updates = FILLED * order.fill, UPDATED * order.updates
    return update * updates + (entry + SOLUTIONS * solution) * entries + SOLUTIONS * unknown * n


def block_cost(n: int, order: EliminationOrder, n_nodes: int) -> float:
    """Return the estimated ns of an elimination by blocks; infinite if they are too many for 32-bit indices."""
    if WITH_ZEROS * order.fill > np.iinfo(np.int32).max:
        return np.inf
    update, node, entry, unknown, of_node = BLOCKS
    nodes = node * n_nodes + FAR * max(n_nodes - NEAR, 0)
    return update * order.updates + nodes + SOLUTIONS * (entry * order.fill + unknown * n + of_node * n_nodes)


def superlu_cost(n: int, order: EliminationOrder) -> float:
    """Return the estimated ns of SuperLU_MT."""
    update, solution, start, unknown = SUPERLU
    return (
        update * UPDATED * order.updates
        + SOLUTIONS * solution * FILLED * order.fill
        + (start + SOLUTIONS * unknown) * n
    )


def chosen(equations: Equations) -> tuple[Equations, Matrix, float]:
    """Return the equations ordered for the linear solver of the least estimated cost, that solver, and its cost, ns.

    A banded order is searched for only if a band as wide as the longest row would be the least expensive.

    Parameters
    ----------
    equations : Equations
        Equations in their natural order.
    """
    n, pattern = equations.n, equations.pattern
    order = elimination_order(equations)
    offers: list[tuple[float, Equations, Matrix]] = [(dense_cost(n), equations, Dense(n, *pattern))]
    if replaceable(ida_libraries()):
        offers.append((fixed_cost(n, order, FIXED), equations, FixedOrder(n, *pattern, order)))
        offers.append((fixed_cost(n, order, PAIRED), equations, PairedColumns(n, *pattern, order)))
        blocks = BlockLU.of(equations, order)
        offers.append((block_cost(n, order, len(blocks.nodes)) + WORTH_COMPILING, equations, blocks))
    offers.append((superlu_cost(n, order), equations, Sparse(n, *pattern)))
    half = int(np.bincount(pattern[0]).max()) // 2
    if n >= WORTH_A_BAND and banded_cost(n, half, half) < min(cost for cost, *_ in offers):
        ordered = narrowed(equations)
        band = Banded(n, *ordered.pattern)
        offers.append((banded_cost(n, band.lower, band.upper), ordered, band))
    cheapest_first = sorted(offers, key=lambda offer: offer[0])
    return next((ordered, matrix, cost) for cost, ordered, matrix in cheapest_first if _served(matrix))


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
    equations, matrix, cost = chosen(_natural(dynamics, settings))
    return equations, NativeEngine(equations, dynamics, matrix, settings, control), cost


def driven_by_callbacks(dynamics: Dynamics, settings: RunSettings) -> tuple[Equations, Engine]:
    """Return the equations and their driver by scikit-sundae's callbacks."""
    equations = _natural(dynamics, settings)
    tolerances = ErrorControl(margin=1.0).tolerances(equations, settings)  # with IDA's own Newton tolerance
    return equations, SundaeEngine(equations, dynamics.state, *tolerances, settings.max_step, settings.max_order or 5)


def _natural(dynamics: Dynamics, settings: RunSettings) -> Equations:
    """Return the equations with their unknowns in the natural order."""
    return Equations(FORMULATIONS[settings.formulation](settings), dynamics.system, dynamics.coordinates)
