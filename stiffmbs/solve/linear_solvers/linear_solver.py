"""Contract of the linear solvers of implicit steps: `factor`, `solve` and `cost`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple

import numpy as np

from ...compile.machine.routines import Routine
from ...sparse.elimination_order import EliminationOrder
from ...tuning import tuned
from ..ida.operations import take_place
from ..ida.session import Session, WhenNeeded

FACTOR_SIGNATURE = "int32(int64*, int64)"
SOLVE_SIGNATURE = "int32(int64*, int64, int64, int64, float64)"


@dataclass(frozen=True)
class LinearSolverCosts:
    """Times of one factorisation with its eight solutions, ns.

    Source: measured on examples with 10 to 1000 unknowns (`tests.bench`, problem ``linear_algebra``).
    """

    sparse: tuple[float, float, float] = (0.36, 6.05, 8.0)
    """For an update of full blocks, an entry of their factors, an unknown, of the sparse LU."""
    blocks: tuple[float, float, float, float] = (0.05, 0.32, 40.0, 138.0)
    """The same, and for a node."""
    cached_nodes: int = 3000
    """Number of nodes whose blocks fit into a processor's own cache."""
    far_node: float = 450.0
    """Additional time for each further node."""
    worth_compiling: float = 200.0
    """Time that blocks must save to be worth compiling on a machine's first run."""


COSTS = tuned("linear_solver", LinearSolverCosts())
"""Costs of every run."""


class Assembled(NamedTuple):
    """SUNDIALS matrix and the data to fill it.

    - `matrix`, `solver`: the SUNMatrix and its SUNLinearSolver.
    - `values`: address of the values of the matrix, in the order of the pattern.
    - `memory`: memory of the solver, which must stay alive.
    """

    matrix: int
    solver: int
    values: int
    memory: Memory

    def forget(self) -> None:
        """Forget the pivots of earlier runs."""
        self.memory.known["ready"] = 0


class Memory(NamedTuple):
    """Memory of a linear solver.

    `content`: table that replaces the content of a SUNDIALS linear solver. `arrays`, `factors`: arrays of the tables
    of the solver and of its factors. `known`: cells with "ready", zero if no pivots are known. `needed`:
    routines compiled at their first use.
    """

    content: np.ndarray
    arrays: dict[str, Any]
    factors: dict[str, Any]
    known: np.void
    needed: WhenNeeded | None = None


@dataclass(frozen=True, eq=False)
class LinearSolver:
    """Linear solver of matrices with one pattern.

    1. `factor` is the function SUNLinSolSetup: it factors the matrix in `Assembled.values` and keeps the values. It returns a
       positive number for a singular matrix, and a negative one if memory is missing.
    2. `solve` is the function SUNLinSolSolve for these factors.
    3. `cost` is the estimated time of a factorisation with its solutions, by which one solver is chosen.
    4. `memory` creates what both functions work on. It begins like the content of the SUNDIALS solver that it replaces.

    `n`: number of unknowns. `rows`, `columns`: entries, by columns. `order`: elimination order, with its fill-in.
    """

    factor: ClassVar[Routine]
    solve: ClassVar[Routine]
    kind: ClassVar[str]

    n: int
    rows: np.ndarray
    columns: np.ndarray
    order: EliminationOrder

    @property
    def cost(self) -> float:
        """Estimated time of a factorisation with its solutions, ns."""
        raise NotImplementedError

    def memory(self, array_of: int) -> Memory:
        """Return the memory of the compiled routines, given the address of N_VGetArrayPointer."""
        raise NotImplementedError

    def sentence(self) -> str:
        """Return a description for the summary."""
        return f"{self.kind}, {self.n} unknowns, {len(self.rows)} entries"

    def assembled(self, session: Session, y: int) -> Assembled:
        """Replace the routines of a SUNLinSol_Band on an unused diagonal matrix."""
        s = session.libraries
        matrix = session.keep(s.SUNBandMatrix(self.n, 0, 0, session.context), s.SUNMatDestroy, "a matrix")
        solver = session.keep(s.SUNLinSol_Band(y, matrix, session.context), s.SUNLinSolFree, "a linear solver")
        memory = self.memory(s.address("N_VGetArrayPointer"))
        functions = {"SUNLinSolSetup_Band": self.factor.address, "SUNLinSolSolve_Band": self.solve.address}
        if memory.needed:
            session.may_need(memory.needed)
        take_place(session, solver, self.n, functions, memory.content)
        return Assembled(matrix, solver, memory.factors["a"].ctypes.data, memory)
