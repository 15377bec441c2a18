"""Block systems of multibody dynamics: accelerations and multipliers, and projections of positions and velocities.

All three are [D J^T; J 0] [x; w] = [a; b], solved by a sparse LU with a constant pattern and pivot order.
"""

from __future__ import annotations

from itertools import repeat
from typing import Any

import numpy as np

from ...compile.equations import Equations
from ...compile.formulation import Block, Formulation, Product
from ...compile.machine.native.tables import FACTORS
from ...compile.machine.own_memory import packed_with_memory
from ...compile.state import State
from .elimination_order import EliminationOrder, elimination_order
from .factors import factors_of

_SADDLE = (Block("u", "lam", "J.T"), Block("lam", "u", "J"))

ACCELERATIONS = Formulation(
    name="accelerations",
    unknowns=("u", "lam"),
    residual_set="acceleration",
    matrix_set="acceleration",
    residual=(Product("u", +1, "f"), Product("u", -1, "f_lam", "lam"), Product("lam", +1, "gamma")),
    matrix=(Block("u", "u", "M"), Block("u", "lam", "f_lam", -1), *_SADDLE),
)
"""[M J^T; J 0] [u'; lam] = [f; gamma]; with friction that depends on lam, one Newton step of it."""

WITH_ALGEBRAIC_STATES = Formulation(
    name="accelerations with algebraic states",
    unknowns=("u", "lam", "x"),
    residual_set="acceleration",
    matrix_set="acceleration",
    residual=(
        *ACCELERATIONS.residual,
        Product("u", -1, "f_alg", "x"),
        Product("x", +1, "rate"),
        Product("x", -1, "rate_alg", "x"),
        Product("x", -1, "rate_lam", "lam"),
    ),
    matrix=(
        *ACCELERATIONS.matrix,
        Block("u", "x", "f_alg", -1),
        Block("x", "x", "rate_alg", -1),
        Block("x", "lam", "rate_lam", -1),
    ),
)
"""Accelerations with algebraic states as unknowns, 0 = z(x, lam): one Newton step."""

POSITION_STEP = Formulation(
    name="position step",
    unknowns=("q", "mu"),
    residual_set="position",
    matrix_set="position",
    residual=(Product("mu", -1, "C"),),
    matrix=(
        Block("q", "q", "I"),
        Block("q", "q", "I:turning", constant=3),
        Block("q", "mu", "C_q.T"),
        Block("mu", "q", "C_q"),
    ),
)
"""[W C_q^T; C_q 0] [dq; w] = [0; -C]: minimum-norm Newton step of the position constraints, in m and rad.

A small rotation changes a quaternion by half its angle, so W is 4 there: planar and spatial models have the same step.
"""

VELOCITY_STEP = Formulation(
    name="velocity step",
    unknowns=("u", "lam"),
    residual_set="motion",
    matrix_set="motion",
    residual=(Product("lam", -1, "V"),),
    matrix=(Block("u", "u", "M"), *_SADDLE),
)
"""[M J^T; J 0] [du; w] = [0; -V]: the velocity correction of minimum norm in the mass matrix."""


def saddle_points(state: State, *formulations: Formulation) -> list[SaddlePoint]:
    """Return the block systems of some formulations at one state."""
    for formulation in formulations:
        state.load(formulation.residual_set)
    systems = list(map(Equations, formulations, repeat(state.system)))
    tables = list(map(Equations.table, systems))
    found: list[SaddlePoint] = []
    for each, table in zip(systems, tables, strict=True):
        like = next((known for known in found if _same_matrix(known.equations, each)), None)
        order = like.order if like else elimination_order(each)
        found.append(SaddlePoint(each, table, order, like.factors if like else _factors(each, order)))
    return found


def _factors(equations: Equations, order: EliminationOrder) -> tuple[np.ndarray, dict[str, Any]]:
    """Return the table of the factors, and their memory."""
    factors = factors_of(equations.n, *equations.pattern, order)
    return packed_with_memory(FACTORS, factors), factors


def _same_matrix(one: Equations, other: Equations) -> bool:
    """Return True if two matrices are equal in every pose, as of accelerations and velocities without friction."""
    if one.formulation.unknowns != other.formulation.unknowns:
        return False
    return not any(
        len(each.system.term(each.formulation.matrix_set, block.block).row)
        for each, like in ((one, other), (other, one))
        for block in set(each.formulation.matrix) - set(like.formulation.matrix)
    )


class SaddlePoint:
    """Block system with its factors, for compiled code.

    Attributes
    ----------
    equations : Equations
    order : EliminationOrder
        Elimination order of the LU.
    factors : tuple of ndarray of int and dict
        Table and memory of the factors, shared by block systems with the same matrix.
    equations_table, factors_table : ndarrays of int
        Addresses (`stiffmbs.compile.machine.layout`).
    """

    def __init__(
        self, equations: Equations, table: tuple[np.ndarray, list[np.ndarray]], order: EliminationOrder,
        factors: tuple[np.ndarray, dict[str, Any]],
    ) -> None:  # fmt: skip
        self.equations, self.order, self.factors = equations, order, factors
        self.factors_table, _ = factors
        self.equations_table, self._slots = table
        self._cells = self.factors_table.view(FACTORS.cells)[0]

    def forget_pivots(self) -> None:
        """Search for new pivots in the next factorisation."""
        self._cells["ready"] = 0
