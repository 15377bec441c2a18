"""Linear solvers of IDA: sparse LU with a fixed order of pivots, by entries or two-column supernodes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple

import numpy as np

from ...compile.machine.layout import Layout, packed_with_memory
from ...compile.machine.native.tables import FACTORS
from ...compile.machine.routines import Routine
from ...sparse.elimination_order import EliminationOrder, factors_of
from ..ida.libraries import Libraries, ida_libraries
from ..ida.matrices import Assembled
from ..ida.operations import take_place
from ..ida.session import Session, WhenNeeded
from .native.layouts import FIXED_ORDER, PAIRED_COLUMNS

_MODULE = "stiffmbs.solve.linear_solvers.native.fixed_order"
SETUP = Routine(_MODULE, "setup", "int32(int64*, int64)")
SOLVE = Routine(_MODULE, "solve", "int32(int64*, int64, int64, int64, float64)")
_PAIRED = "stiffmbs.solve.linear_solvers.native.paired_columns"
SETUP_PAIRED = Routine(_PAIRED, "setup", "int32(int64*, int64)")
SOLVE_PAIRED = Routine(_PAIRED, "solve", "int32(int64*, int64, int64, int64, float64)")


class Memory(NamedTuple):
    """Memory of a linear solver.

    `content`: table that replaces the content of a SUNDIALS linear solver. `arrays`, `factors`: arrays of the tables
    of the solver and of its factors. `needed`: routines compiled at their first use.
    """

    content: np.ndarray
    arrays: dict[str, Any]
    factors: dict[str, Any]
    needed: WhenNeeded | None = None


@dataclass(frozen=True)
class FixedOrder:
    """Sparse LU by columns, with pivots searched only once (`stiffmbs.solve.linear_solvers.native.fixed_order`).

    `order`: elimination order of the columns, and their fill-in.
    """

    setup: ClassVar[Routine] = SETUP
    solve: ClassVar[Routine] = SOLVE
    layout: ClassVar[Layout] = FIXED_ORDER

    n: int
    rows: np.ndarray
    columns: np.ndarray
    order: EliminationOrder

    def libraries(self) -> Libraries:
        """Return the libraries of IDA alone."""
        return ida_libraries()

    def sentence(self) -> str:
        """Return a description for the summary."""
        return f"fixed order, {self.n} unknowns, {len(self.rows)} entries"

    def assembled(self, session: Session, y: int) -> Assembled:
        """Replace the routines of a SUNLinSol_Band on an unused diagonal matrix."""
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
        """Return the memory of the compiled routines, given the address of N_VGetArrayPointer."""
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
        """Return additional arrays of the layout."""
        return {}


@dataclass(frozen=True)
class PairedColumns(FixedOrder):
    """Sparse LU for long columns, with pivots searched only once (`stiffmbs.solve.linear_solvers.native.paired_columns`)."""

    setup: ClassVar[Routine] = SETUP_PAIRED
    solve: ClassVar[Routine] = SOLVE_PAIRED
    layout: ClassVar[Layout] = PAIRED_COLUMNS

    def sentence(self) -> str:
        """Return a description for the summary."""
        return f"fixed order, columns in pairs, {self.n} unknowns, {len(self.rows)} entries"

    def _lists(self) -> dict[str, np.ndarray]:
        return {name: np.zeros(self.n, dtype=np.int64) for name in ("item_start", "item_end", "side")}
