"""The iteration matrix factored along a fixed order of pivots, in place of a linear solver of SUNDIALS' own."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from ...compile.layout import FACTORS, FIXED_ORDER, Layout, packed
from ...compile.routines import Routine
from ..elimination_order import EliminationOrder
from .libraries import Libraries, ida_libraries
from .matrices import Assembled
from .operations import take_place
from .session import Session

_MODULE = "stiffmbs.solve.native.fixed_order"
SETUP = Routine(_MODULE, "setup", "int32(int64*, int64)")
SOLVE = Routine(_MODULE, "solve", "int32(int64*, int64, int64, int64, float64)")

ROOM_FOR_PIVOTING = 4
"""Times the estimated fill and updates that there is room for when pivots leave the diagonal."""


@dataclass(frozen=True)
class FixedOrder:
    """The entries of the pattern, by columns; sparse LU whose pivots are sought once (`stiffmbs.solve.native.fixed_order`).

    Attributes
    ----------
    order : EliminationOrder
        Of the columns, and how much is filled.
    """

    setup: ClassVar[Routine] = SETUP
    solve: ClassVar[Routine] = SOLVE
    layout: ClassVar[Layout] = FIXED_ORDER

    n: int
    rows: np.ndarray
    columns: np.ndarray
    order: EliminationOrder

    def libraries(self) -> Libraries:
        return ida_libraries()

    def sentence(self) -> str:
        return f"fixed order, {self.n} unknowns, {len(self.rows)} entries"

    def assembled(self, session: Session, y: int) -> Assembled:
        """Takes the place of SUNLinSol_Band on a diagonal matrix, which stays unused."""
        s = session.libraries
        matrix = session.keep(s.SUNBandMatrix(self.n, 0, 0, session.context), s.SUNMatDestroy, "a matrix")
        solver = session.keep(s.SUNLinSol_Band(y, matrix, session.context), s.SUNLinSolFree, "a linear solver")
        factors = self._factors()
        solver_arrays = self._solver(s.address("N_VGetArrayPointer"), packed(FACTORS, factors))
        content = packed(self.layout, solver_arrays)
        functions = {"SUNLinSolSetup_Band": self.setup.address(), "SUNLinSolSolve_Band": self.solve.address()}
        take_place(session, solver, self.n, functions, content)
        return Assembled(
            matrix, solver, factors["a"].ctypes.data, None, np.zeros(6, dtype=np.int64),
            (content, *factors.values(), *solver_arrays.values()), solver_arrays["found"],
        )  # fmt: skip

    def _factors(self) -> dict[str, Any]:
        n, ints, floats = self.n, _ints, np.zeros
        room = min(ROOM_FOR_PIVOTING * self.order.fill, n * n) + n
        return {
            "n": n, "capacity": room, "ready": ints(1),
            "a_start": np.searchsorted(self.columns, np.arange(n + 1)).astype(np.int64),
            "a_row": self.rows.astype(np.int64), "a": floats(len(self.rows)), "scale": np.ones(n),
            "order": self.order.unknowns,
            "l_start": ints(n + 1), "l_row": ints(room), "l": floats(room),
            "u_start": ints(n + 1), "u_row": ints(room), "u": floats(room),
            "pivot": ints(n), "work": floats(n), "b": floats(n), "previous": floats(n), "stack": ints(4 * n), "x": floats(n),
        }  # fmt: skip

    def _solver(self, array_of: int, factors: np.ndarray) -> dict[str, Any]:
        n, ints, floats = self.n, _ints, np.zeros
        entries = 2 * (min(ROOM_FOR_PIVOTING * self.order.fill, n * n) + n)
        room = 3 * min(ROOM_FOR_PIVOTING * self.order.updates, n * n * n)
        return {
            "n": n, "pivots": 0, "last_flag": 0, "array_of": array_of, "factors": factors, "found": ints(3),
            "slot": _int32s(len(self.rows)), "weight": floats(len(self.rows)), "lu": floats(entries),
            "row": _int32s(entries), "column": _int32s(entries), "update_start": ints(n + 1), "update": _int32s(room), "room": room,
            "mark": ints(n), "x": floats(n),
        }  # fmt: skip


def _int32s(count: int) -> np.ndarray:
    return np.zeros(count, dtype=np.int32)


def _ints(count: int) -> np.ndarray:
    return np.zeros(count, dtype=np.int64)
