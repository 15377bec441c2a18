"""Linear solver of IDA: sparse LU in a fixed order with two-column supernodes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ...compile.machine.layout import Layout
from ...compile.machine.routines import Routine
from ..native.tables.linear import PAIRED_COLUMNS
from .fixed_order import FixedOrder

_MODULE = "stiffmbs.solve.native.paired_columns"
SETUP = Routine(_MODULE, "setup", "int32(int64*, int64)")
SOLVE = Routine(_MODULE, "solve", "int32(int64*, int64, int64, int64, float64)")


@dataclass(frozen=True)
class PairedColumns(FixedOrder):
    """Sparse LU for long columns, with pivots searched only once (`stiffmbs.solve.native.paired_columns`)."""

    setup: ClassVar[Routine] = SETUP
    solve: ClassVar[Routine] = SOLVE
    layout: ClassVar[Layout] = PAIRED_COLUMNS

    def sentence(self) -> str:
        """Return a description for the summary."""
        return f"fixed order, columns in pairs, {self.n} unknowns, {len(self.rows)} entries"

    def _lists(self) -> dict[str, np.ndarray]:
        return {name: np.zeros(self.n, dtype=np.int64) for name in ("item_start", "item_end", "side")}
