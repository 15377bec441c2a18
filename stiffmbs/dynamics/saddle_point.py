"""Block systems of multibody dynamics: accelerations and multipliers, and projections of positions and velocities.

All three are [D J^T; J 0] [x; w] = [a; b], solved by a sparse LU with a constant pattern and pivot order.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import repeat
from typing import Any

import numpy as np

from ..compile.equations import Equations
from ..compile.formulation import Block, Formulation, Product
from ..compile.machine.layout import packed_with_memory
from ..compile.machine.native.tables import FACTORS
from ..compile.state import State
from ..sparse.elimination_order import EliminationOrder, elimination_order, factors_of

_SADDLE = (Block("u", "lam", "J.T"), Block("lam", "u", "J"))

ACCELERATIONS = Formulation(
    name="accelerations",
    unknowns=("u", "lam"),
    residual_set="acceleration",
    matrix_set="acceleration",
    residual=(Product("u", +1, "f"), Product("u", -1, "f_lam", "lam"), Product("lam", +1, "gamma")),
    matrix=(Block("u", "u", "M"), Block("u", "u", "inertia"), Block("u", "lam", "f_lam", -1), *_SADDLE),
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
    """Return the block systems of some formulations at one state; those with the same matrix share their factors."""
    for formulation in formulations:
        state.load(formulation.residual_set)
    found: list[SaddlePoint] = []
    for each in map(Equations, formulations, repeat(state.system)):
        like = next((known for known in found if _same_matrix(known.equations, each)), None)
        order = like.order if like else elimination_order(each)
        factors = like.factors if like else factors_of(each.n, *each.pattern, order)
        table = like.factors_table if like else packed_with_memory(FACTORS, factors)
        found.append(SaddlePoint(each, order, factors, table, *each.table()))
    return found


def _same_matrix(one: Equations, other: Equations) -> bool:
    """Return True if two matrices are equal in every pose, as of accelerations and velocities without friction."""
    if one.formulation.unknowns != other.formulation.unknowns:
        return False
    return not any(
        len(each.system.term(each.formulation.matrix_set, block.block).row)
        for each, like in ((one, other), (other, one))
        for block in set(each.formulation.matrix) - set(like.formulation.matrix)
    )


@dataclass(frozen=True, eq=False)
class SaddlePoint:
    """Block system with its factors, for compiled code.

    - `order`: elimination order of the LU.
    - `factors`: memory of the factors.
    - `factors_table`, `equations_table`: addresses (`stiffmbs.compile.machine.layout`).
    - `slots`: memory of the matrix entries.
    """

    equations: Equations
    order: EliminationOrder
    factors: dict[str, Any]
    factors_table: np.ndarray
    equations_table: np.ndarray
    slots: list[np.ndarray]

    def forget_pivots(self) -> None:
        """Search for new pivots in the next factorisation."""
        self._cells["ready"] = 0

    @cached_property
    def _cells(self) -> Any:
        """Numbers of `factors_table` by name."""
        return self.factors_table.view(FACTORS.cells)[0]
