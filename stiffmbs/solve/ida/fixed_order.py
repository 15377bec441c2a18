"""The iteration matrix factored along a fixed order of pivots, in place of a linear solver of SUNDIALS' own."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple

import numpy as np

from ...compile.machine.layout import Layout
from ...compile.machine.native.tables import FACTORS
from ...compile.machine.own_memory import packed_with_memory
from ...compile.machine.routines import Routine
from ..linear.elimination_order import EliminationOrder
from ..linear.factors import factors_of
from ..native.tables.linear import FIXED_ORDER
from .libraries import Libraries, ida_libraries
from .matrices import Assembled
from .operations import take_place
from .session import Session
from .when_needed import WhenNeeded

_MODULE = "stiffmbs.solve.native.fixed_order"
SETUP = Routine(_MODULE, "setup", "int32(int64*, int64)")
SOLVE = Routine(_MODULE, "solve", "int32(int64*, int64, int64, int64, float64)")


class Memory(NamedTuple):
    """What a linear solver works on.

    Attributes
    ----------
    content : ndarray of int
        The table that takes the place of the content of a solver of SUNDIALS.
    arrays, factors : dict
        What the tables of the solver and of its factors refer to.
    needed : WhenNeeded or None
        Routines that the solver may ask for.
    """

    content: np.ndarray
    arrays: dict[str, Any]
    factors: dict[str, Any]
    needed: WhenNeeded | None = None


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
        """Those of IDA alone."""
        return ida_libraries()

    def sentence(self) -> str:
        """What the summary says of it."""
        return f"fixed order, {self.n} unknowns, {len(self.rows)} entries"

    def assembled(self, session: Session, y: int) -> Assembled:
        """Takes the place of SUNLinSol_Band on a diagonal matrix, which stays unused."""
        s = session.libraries
        matrix = session.keep(s.SUNBandMatrix(self.n, 0, 0, session.context), s.SUNMatDestroy, "a matrix")
        solver = session.keep(s.SUNLinSol_Band(y, matrix, session.context), s.SUNLinSolFree, "a linear solver")
        memory = self.memory(s.address("N_VGetArrayPointer"))
        functions = {"SUNLinSolSetup_Band": self.setup.address, "SUNLinSolSolve_Band": self.solve.address}
        if memory.needed:
            session.may_need(memory.needed)
        take_place(session, solver, self.n, functions, memory.content)
        return Assembled(
            matrix, solver, memory.factors["a"].ctypes.data, None, np.zeros(6, dtype=np.int64), (memory,), memory.content.view(self.layout.cells)[0]
        )  # fmt: skip

    def memory(self, array_of: int) -> Memory:
        """What the compiled routines work on, given the address of N_VGetArrayPointer."""
        factors, lists = factors_of(self.n, self.rows, self.columns, self.order), self._lists()
        table = packed_with_memory(FACTORS, factors)
        arrays = {
            "n": self.n, "pivots": 0, "last_flag": 0, "array_of": array_of, "factors": table,
            "slot": np.zeros(len(self.rows), dtype=np.int32),
            "weight": np.zeros(len(self.rows)), "update_start": np.zeros(self.n + 1, dtype=np.int64),
            "mark": np.zeros(self.n, dtype=np.int64), "x": np.zeros(self.n + 1), **lists,
        }  # fmt: skip
        return Memory(packed_with_memory(self.layout, arrays), arrays, factors)

    def _lists(self) -> dict[str, np.ndarray]:
        """What the layout has beside that."""
        return {}
