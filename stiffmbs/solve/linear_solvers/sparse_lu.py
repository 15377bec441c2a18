"""Linear solver of small matrices, and of those that blocks factor inaccurately: sparse LU by columns."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from ...compile.machine.layout import packed_with_memory
from ...compile.machine.native.tables import FACTORS
from ...compile.machine.routines import Routine
from ...sparse.elimination_order import factors_of
from .linear_solver import COSTS, FACTOR_SIGNATURE, SOLVE_SIGNATURE, LinearSolver, Memory
from .native.layouts import SPARSE_LU

_MODULE = "stiffmbs.solve.linear_solvers.native.sparse_lu"
FACTOR, SOLVE = Routine(_MODULE, "setup", FACTOR_SIGNATURE), Routine(_MODULE, "solve", SOLVE_SIGNATURE)


class SparseLU(LinearSolver):
    """Sparse LU with threshold pivoting, whose pivots are kept as long as they are large enough."""

    factor: ClassVar[Routine] = FACTOR
    solve: ClassVar[Routine] = SOLVE
    kind: ClassVar[str] = "sparse LU"

    @property
    def cost(self) -> float:
        """Estimated time of a factorisation with its solutions, ns."""
        update, entry, unknown = COSTS.sparse
        return update * self.order.updates + entry * self.order.fill + unknown * self.n

    def memory(self, array_of: int) -> Memory:
        """Return the memory of the compiled routines, given the address of N_VGetArrayPointer."""
        factors = factors_of(self.n, self.rows, self.columns, self.order)
        table = packed_with_memory(FACTORS, factors)
        arrays = {
            "n": self.n, "pivots": 0, "last_flag": 0, "array_of": array_of, "factors": table,
            "entries": np.zeros(len(self.rows)),
        }  # fmt: skip
        return Memory(packed_with_memory(SPARSE_LU, arrays), arrays, factors, table.view(FACTORS.cells)[0])
