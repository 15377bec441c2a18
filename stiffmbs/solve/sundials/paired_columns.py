"""The iteration matrix factored along a fixed order of pivots, its columns taken in pairs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from ...compile.layout import PAIRED_COLUMNS, Layout
from ...compile.routines import Routine
from .fixed_order import ROOM_FOR_PIVOTING, FixedOrder

_MODULE = "stiffmbs.solve.native.paired_columns"
SETUP = Routine(_MODULE, "setup", "int32(int64*, int64)")
SOLVE = Routine(_MODULE, "solve", "int32(int64*, int64, int64, int64, float64)")


@dataclass(frozen=True)
class PairedColumns(FixedOrder):
    """Sparse LU whose pivots are sought once, for long columns (`stiffmbs.solve.native.paired_columns`)."""

    setup: ClassVar[Routine] = SETUP
    solve: ClassVar[Routine] = SOLVE
    layout: ClassVar[Layout] = PAIRED_COLUMNS

    def sentence(self) -> str:
        return f"fixed order, columns in pairs, {self.n} unknowns, {len(self.rows)} entries"

    def _solver(self, array_of: int, factors: np.ndarray) -> dict[str, Any]:
        n = self.n
        entries = 2 * (min(ROOM_FOR_PIVOTING * self.order.fill, n * n) + n)
        integers = {name: np.zeros(n, dtype=np.int64) for name in ("item_start", "item_end", "side", "mark")}
        lists = {name: np.zeros(entries, dtype=np.int32) for name in ("row", "column", "place", "update")}
        return {
            "n": n, "pivots": 0, "last_flag": 0, "array_of": array_of, "factors": factors,
            "found": np.zeros(3, dtype=np.int64), "slot": np.zeros(len(self.rows), dtype=np.int32),
            "weight": np.zeros(len(self.rows)), "lu": np.zeros(2 * entries + n),
            "update_start": np.zeros(n + 1, dtype=np.int64), "x": np.zeros(n + 1), **integers, **lists,
        }  # fmt: skip
