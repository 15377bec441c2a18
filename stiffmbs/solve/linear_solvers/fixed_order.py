"""Linear solvers of IDA: sparse LU with a fixed order of pivots, and with pivots searched in every matrix."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple

import numpy as np

from ...compile.machine.layout import Layout, packed_with_memory
from ...compile.machine.native.tables import FACTORS
from ...compile.machine.routines import Routine
from ...sparse.elimination_order import EliminationOrder, factors_of
from ..ida.operations import take_place
from ..ida.session import Session, WhenNeeded
from .native.layouts import FIXED_ORDER, PIVOTED

_MODULE = "stiffmbs.solve.linear_solvers.native.fixed_order"
SETUP = Routine(_MODULE, "setup", "int32(int64*, int64)")
SOLVE = Routine(_MODULE, "solve", "int32(int64*, int64, int64, int64, float64)")
_PIVOTED = "stiffmbs.solve.linear_solvers.native.pivoted"
SETUP_PIVOTED = Routine(_PIVOTED, "setup", "int32(int64*, int64)")
SOLVE_PIVOTED = Routine(_PIVOTED, "solve", "int32(int64*, int64, int64, int64, float64)")


class Assembled(NamedTuple):
    """SUNDIALS matrix and the data to fill it.

    - `matrix`, `solver`: the SUNMatrix and its SUNLinearSolver.
    - `values`: address of the values of the matrix, in the order of the pattern.
    - `memory`: memory of the solver, which must stay alive.
    - `pivots`: cells of a linear solver that stores its pivots, with "ready" zero to search them again; None for
      others.
    """

    matrix: int
    solver: int
    values: int
    memory: Memory
    pivots: np.void | None


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
        pivots = memory.content.view(self.layout.cells)[0] if "ready" in self.layout else None
        values = memory.factors["a"].ctypes.data
        return Assembled(matrix, solver, values, memory, pivots)

    def memory(self, array_of: int) -> Memory:
        """Return the memory of the compiled routines, given the address of N_VGetArrayPointer."""
        factors, lists = factors_of(self.n, self.rows, self.columns, self.order), self._lists()
        arrays = {
            "n": self.n, "pivots": 0, "last_flag": 0, "array_of": array_of, "factors": packed_with_memory(FACTORS, factors),
            "weight": np.zeros(len(self.rows)), **lists,
        }  # fmt: skip
        return Memory(packed_with_memory(self.layout, arrays), arrays, factors)

    def _lists(self) -> dict[str, np.ndarray]:
        """Return the arrays of the list of updates."""
        n = self.n
        return {
            "slot": np.zeros(len(self.rows), dtype=np.int32), "update_start": np.zeros(n + 1, dtype=np.int64),
            "mark": np.zeros(n, dtype=np.int64), "x": np.zeros(n),
        }  # fmt: skip


@dataclass(frozen=True)
class Pivoted(FixedOrder):
    """Sparse LU with pivots searched in every matrix (`stiffmbs.solve.linear_solvers.native.pivoted`)."""

    setup: ClassVar[Routine] = SETUP_PIVOTED
    solve: ClassVar[Routine] = SOLVE_PIVOTED
    layout: ClassVar[Layout] = PIVOTED

    def sentence(self) -> str:
        """Return a description for the summary."""
        return f"pivots searched in every matrix, {self.n} unknowns, {len(self.rows)} entries"

    def _lists(self) -> dict[str, np.ndarray]:
        return {}
