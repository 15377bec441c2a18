"""The block systems of rigid body mechanics: accelerations and multipliers, and both projections.

All three are [D J^T; J 0] [x; w] = [a; b], solved by one sparse LU whose pattern and pivots are found once.
"""

from __future__ import annotations

import numpy as np

from ..compile.equations import Equations
from ..compile.formulation import Block, Formulation, Product
from ..compile.layout import FACTORS, packed
from ..compile.state import State
from .elimination_order import elimination_order

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


ROOM_FOR_PIVOTING = 4
"""Times the fill without pivoting that the factors may grow to when pivots leave the diagonal."""


class SaddlePoint:
    """One block system with its factors, ready for compiled code.

    Attributes
    ----------
    equations_table, factors_table : ndarrays of int
        Addresses (`stiffmbs.compile.layout`).
    """

    def __init__(self, formulation: Formulation, state: State) -> None:
        self.equations = Equations(formulation, state.system)
        state.load(formulation.residual_set)
        self.equations_table, self._slots = self.equations.table()
        n = self.equations.n
        rows, columns = self.equations.pattern
        order = elimination_order(self.equations)
        room = ROOM_FOR_PIVOTING * order.fill + min(n * n, 4096) + n
        ints, floats = (lambda k: np.zeros(k, dtype=np.int64)), np.zeros
        self._ready = ints(1)
        self._arrays = {
            "n": n, "capacity": room, "ready": self._ready,
            "a_start": np.searchsorted(columns, np.arange(n + 1)).astype(np.int64),
            "a_row": rows.astype(np.int64), "a": floats(len(rows)), "scale": np.ones(n), "order": order.unknowns,
            "l_start": ints(n + 1), "l_row": ints(room), "l": floats(room),
            "u_start": ints(n + 1), "u_row": ints(room), "u": floats(room),
            "pivot": ints(n), "work": floats(n), "b": floats(n), "previous": floats(n), "stack": ints(4 * n), "x": floats(n),
        }  # fmt: skip
        self.factors_table = packed(FACTORS, self._arrays)

    def forget_pivots(self) -> None:
        """Have the pivots sought anew with the next factorisation."""
        self._ready[0] = 0
