"""The block systems of rigid body mechanics: accelerations and multipliers, and both projections.

All three are [D J^T; J 0] [x; w] = [a; b], solved by one sparse LU whose pattern and pivots are found once.
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
"""[M J^T; J 0] [u'; lam] = [f; gamma]; one Newton step of it where friction makes f depend on lam."""

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
"""The same with algebraic states among the unknowns, 0 = z(x, lam): one Newton step of all of them."""

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
"""[W C_q^T; C_q 0] [dq; w] = [0; -C]: Newton's smallest move towards the constraints, in m and rad.

A turn by a small angle moves a quaternion by half of it, so that W is 4 there: a model has the same smallest move in the
plane and in space.
"""

VELOCITY_STEP = Formulation(
    name="velocity step",
    unknowns=("u", "lam"),
    residual_set="motion",
    matrix_set="motion",
    residual=(Product("lam", -1, "V"),),
    matrix=(Block("u", "u", "M"), *_SADDLE),
)
"""[M J^T; J 0] [du; w] = [0; -V]: the smallest correction in the mass matrix."""


def saddle_points(state: State, *formulations: Formulation) -> list[SaddlePoint]:
    """The block systems of some formulations at one state."""
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
    """Memory of the factors, and their table."""
    factors = factors_of(equations.n, *equations.pattern, order)
    return packed_with_memory(FACTORS, factors), factors


def _same_matrix(one: Equations, other: Equations) -> bool:
    """Whether the matrices are the same at every pose, as those of accelerations and of velocities are without friction."""
    if one.formulation.unknowns != other.formulation.unknowns:
        return False
    return not any(
        len(each.system.term(each.formulation.matrix_set, block.block).row)
        for each, like in ((one, other), (other, one))
        for block in set(each.formulation.matrix) - set(like.formulation.matrix)
    )


class SaddlePoint:
    """One block system with its factors, ready for compiled code.

    Attributes
    ----------
    equations : Equations
    order : EliminationOrder
        Of the LU.
    factors : tuple of ndarray of int and dict
        The table of the factors, which block systems with the same matrix share, and their memory.
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
        """Have the pivots sought anew with the next factorisation."""
        self._cells["ready"] = 0
