"""Memory of the sparse LU of a pattern (`stiffmbs.compile.machine.native.factors`)."""

from __future__ import annotations

from typing import Any

import numpy as np

from .elimination_order import EliminationOrder


def factors_of(n: int, rows: np.ndarray, columns: np.ndarray, order: EliminationOrder) -> dict[str, Any]:
    """Return the contents of the layout `stiffmbs.compile.machine.native.tables.FACTORS`.

    Parameters
    ----------
    n : int
        Number of unknowns.
    rows, columns : ndarrays of int
        Entries, by columns.
    order : EliminationOrder
        Elimination order of the columns, with its fill-in.
    """
    return {
        "n": n, "expected_entries": order.fill + n,
        "a_start": np.searchsorted(columns, np.arange(n + 1)).astype(np.int64, copy=False),
        "a_row": np.ascontiguousarray(rows, dtype=np.int64), "a": np.zeros(len(rows)), "factored": np.zeros(len(rows)), "scale": np.ones(n), "order": order.unknowns,
        "l_start": _ints(n + 1), "u_start": _ints(n + 1), "pivot": _ints(n), "stack": _ints(4 * n),
        **{name: np.zeros(n) for name in ("work", "b", "previous", "x")},
    }  # fmt: skip


def _ints(count: int) -> np.ndarray:
    return np.zeros(count, dtype=np.int64)
