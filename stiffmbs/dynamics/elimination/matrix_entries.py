"""Index lists of J M^-1 J^T by entries (`stiffmbs.dynamics.elimination.native.by_entries`)."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import Any

import numpy as np

from ...compile.equations import ABSENT
from ...compile.machine.layout import arrays_of
from ...compile.system import System
from ...sparse.blocks import filled_below
from .native.layouts import ENTRY_ELIMINATION

Entries = tuple[np.ndarray, np.ndarray, np.ndarray]
"""Sources, rows in the order of elimination, and columns of J."""


def entry_lists(rows: Sequence[np.ndarray], system: System, kept: np.ndarray) -> dict[str, Any]:
    """Return the lists of the matrix and its factors (`stiffmbs.dynamics.elimination.native.layouts.ENTRY_ELIMINATION`).

    Parameters
    ----------
    rows : list of ndarray of int
        Solved equations of each joint, in the order of elimination.
    system : System
    kept : ndarray of int
        Entries of J in these equations.
    """
    n, at_lam = sum(map(len, rows)), np.full(system.n_c, ABSENT)
    at_lam[np.concatenate([np.empty(0, dtype=np.int64), *rows])] = np.arange(n)
    jacobian, gamma = system.term("acceleration", "J"), system.term("acceleration", "gamma")
    kept = kept[np.lexsort((jacobian.column[kept], at_lam[jacobian.row[kept]]))]
    j: Entries = (jacobian.source[kept], at_lam[jacobian.row[kept]], jacobian.column[kept])
    products = _products(j)
    columns = _filled({(a, b) for a, b, *_ in products}, n)
    starts = np.cumsum([0, *(1 + len(below) for below in columns)])
    n_slots = int(starts[-1])
    slot = {
        (row, k): int(starts[k]) + place for k, below in enumerate(columns) for place, row in enumerate((k, *below))
    }
    products.sort(key=lambda product: (slot[product[:2]], product))
    solved = at_lam[gamma.row] != ABSENT
    lists = {
        "gamma_source": gamma.source[solved], "gamma_row": at_lam[gamma.row[solved]],
        "j_source": j[0], "j_row": j[1], "j_column": j[2], "at_lam": at_lam,
        "product_end": np.cumsum(np.bincount([slot[p[:2]] for p in products], minlength=n_slots)),
        "product_first": [p[2] for p in products], "product_second": [p[3] for p in products],
        "column_start": starts, "row": [row for k, below in enumerate(columns) for row in (k, *below)],
        "update_slot": [slot[b, a] for below in columns for p, a in enumerate(below) for b in below[p:]],
        "j_scale": 1.0 / np.sqrt(system.mass[j[2]]), "j": np.zeros(len(kept)),
        "s": np.zeros(n_slots), "l": np.zeros(n_slots), "diagonal": np.zeros(n), "b": np.zeros(n),
    }  # fmt: skip
    counts = {"n": n, "n_gamma": int(solved.sum()), "n_j": len(kept), "n_slots": n_slots}
    return {**arrays_of(ENTRY_ELIMINATION, lists), **counts}


def _products(j: Entries) -> list[tuple[int, int, int, int]]:
    """Return row, column and both factors (entries of J) of every product in the lower half of J M^-1 J^T."""
    at_velocity: dict[int, list[tuple[int, int]]] = {}
    for place, (row, column) in enumerate(zip(*(part.tolist() for part in j[1:]), strict=True)):
        at_velocity.setdefault(column, []).append((row, place))
    return [
        (max(a, b), min(a, b), first, second)
        for entries in at_velocity.values()
        for (a, first), (b, second) in [*((e, e) for e in entries), *_pairs(entries)]
    ]


def _pairs(entries: list[tuple[int, int]]) -> list[Any]:
    """Return pairs of different entries, in both orders if they are in the same row."""
    both = [(a, b) for a, b in combinations(entries, 2)]
    return both + [(b, a) for a, b in both if a[0] == b[0]]


def _filled(entries: set[tuple[int, int]], n: int) -> list[list[int]]:
    """Return the sorted rows below the diagonal of each column of the factor."""
    below: list[set[int]] = [set() for _ in range(n)]
    for row, column in entries:
        if row != column:
            below[column].add(row)
    return filled_below(below)
