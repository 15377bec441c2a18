"""How IDA is driven, and which linear solver a pattern gets: the one with the least estimated cost."""

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
"""Solutions with one factorisation (measured: 7 to 20)."""
DENSE = (0.045, 1.0, 0.24, 10.0)
"""ns for a multiplication of the dense LU, for an entry that is cleared and filled, for an entry and an unknown in a solution."""
BANDED = (0.15, 0.5, 0.45)
"""The same of the banded LU, within the band; unknowns cost little beside it."""
FIXED = (1.2, 1.5, 0.5, 1.0)
"""ns for an update along a fixed order, for an entry of the factors that is cleared and scaled, for one in a solution, and for
an unknown in a solution.  All figures are measured on the examples, 10 to 1000 unknowns."""
PAIRED = (0.25, 3.0, 0.75, 1.0)
"""The same where columns are taken in pairs: their loops cost as much as some ten updates."""
BLOCKS = (0.05, 50.0, 0.04, 5.0, 11.0)
"""ns for an update in blocks of bodies and joints, for a node; in a solution for an entry of full blocks, an unknown, and a node."""
NEAR, FAR = 3000, 450.0
"""Nodes whose blocks and lists a processor's own cache holds, and ns more for each beyond them: measured on chains of 3000 and 10 000 rods,
which take 30 and 45 % longer with blocks."""
WORTH_COMPILING = 200.0
"""ns that blocks have to save in one factorisation and its solutions, or a machine's first run is not compiled for them, 0.5 s.
Where they are estimated to save 200 to 3000, runs of the examples take 0 to 21 % less with them; where less, up to 10 % more."""
WITH_ZEROS = 8
"""Numbers that the blocks hold at the most, relative to the entries of a triangle of full ones."""
SUPERLU = (0.5, 0.75, 600.0, 8.0)
"""The same of SuperLU_MT, which works in dense blocks where there are any, and starts anew with every factorisation."""
WORTH_A_BAND = 50
"""Unknowns below which finding a band costs more than it can save."""
FILLED, UPDATED = 1.1, 0.3
"""Parts of the entries and updates of full blocks that are there in fact: J leaves much of them empty."""


def dense_cost(n: int) -> float:
    """Estimated ns for one factorisation of a dense matrix and the solutions with it."""
    update, entry, solution, unknown = DENSE
    return update * n**3 / 3 + (entry + SOLUTIONS * solution) * n**2 + SOLUTIONS * unknown * n


def banded_cost(n: int, lower: int, upper: int) -> float:
    """The same for a banded matrix."""
    update, entry, solution = BANDED
    height = 2 * lower + upper + 1
    return n * (update * lower * (lower + upper) + (entry + SOLUTIONS * solution) * height)


def fixed_cost(n: int, order: EliminationOrder, costs: tuple[float, float, float, float]) -> float:
    """The same for elimination along a fixed order, entry by entry or by pairs of columns."""
    update, entry, solution, unknown = costs
    entries, updates = FILLED * order.fill, UPDATED * order.updates
    return update * updates + (entry + SOLUTIONS * solution) * entries + SOLUTIONS * unknown * n


def block_cost(n: int, order: EliminationOrder, n_nodes: int) -> float:
    """The same by dense blocks of so many nodes; they are numbered by 32 bits."""
    if WITH_ZEROS * order.fill > np.iinfo(np.int32).max:
        return np.inf
    update, node, entry, unknown, of_node = BLOCKS
    nodes = node * n_nodes + FAR * max(n_nodes - NEAR, 0)
    return update * order.updates + nodes + SOLUTIONS * (entry * order.fill + unknown * n + of_node * n_nodes)


def superlu_cost(n: int, order: EliminationOrder) -> float:
    """The same for SuperLU_MT."""
    update, solution, start, unknown = SUPERLU
    return (
        update * UPDATED * order.updates
        + SOLUTIONS * solution * FILLED * order.fill
        + (start + SOLUTIONS * unknown) * n
    )


def chosen(equations: Equations) -> tuple[Equations, Matrix, float]:
    """The equations with their unknowns in the order of the linear solver of the least estimated cost, that solver, and the cost.

    The band is looked for where the dense and the fixed order cost more than one that is as narrow as a row is long.

    Parameters
    ----------
    equations : Equations
        In the natural order.
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
    """Whether the libraries have the linear solver: scikit-sundae may be built without SuperLU_MT."""
    try:
        matrix.libraries()
    except Unavailable:
        return False
    return True


def driven_natively(
    dynamics: Dynamics, settings: RunSettings, control: ErrorControl
) -> tuple[Equations, Engine, float]:
    """The equations and their driver, where SUNDIALS' libraries are as it needs them, and the cost of its linear solver, ns."""
    equations, matrix, cost = chosen(_natural(dynamics, settings))
    return equations, NativeEngine(equations, dynamics, matrix, settings, control), cost


def driven_by_callbacks(dynamics: Dynamics, settings: RunSettings) -> tuple[Equations, Engine]:
    """The equations and their driver by scikit-sundae's callbacks."""
    equations = _natural(dynamics, settings)
    tolerances = ErrorControl(margin=1.0).tolerances(equations, settings)  # Newton's iteration stays as IDA has it
    return equations, SundaeEngine(equations, dynamics.state, *tolerances, settings.max_step, settings.max_order or 5)


def _natural(dynamics: Dynamics, settings: RunSettings) -> Equations:
    """The equations with their unknowns in the natural order."""
    return Equations(FORMULATIONS[settings.formulation](settings), dynamics.system, dynamics.coordinates)
