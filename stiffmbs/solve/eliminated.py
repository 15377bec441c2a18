"""The block system of accelerations with u' eliminated, for systems whose bodies carry few joints each."""

from __future__ import annotations

from itertools import combinations
from typing import Any

import numpy as np

from ..compile.equations import ABSENT, Equations
from ..compile.layout import ELIMINATED, packed
from ..compile.state import State
from .saddle_point import ACCELERATIONS, elimination_order

MOST_UPDATES_PER_ENTRY = 20
"""Multiplications of the factors for each entry of J up to which they are cheaper than the LU of the whole."""


class Eliminated:
    """J M^-1 J^T lam = J M^-1 f - gamma, then u' = M^-1 (f - J^T lam), by flat lists for compiled code.

    The matrix is symmetric and positive definite, so its factors L D L^T need no pivots and keep their pattern.

    Attributes
    ----------
    serves : bool
        Whether the system is of the kind: no force hangs on multipliers, and the factors stay sparse.
    table : ndarray of int
        Addresses (`stiffmbs.compile.layout.ELIMINATED`), zeros where it does not serve.
    """

    def __init__(self, state: State) -> None:
        system = state.system
        equations = Equations(ACCELERATIONS, system)
        multipliers, _ = elimination_order(equations)
        multipliers = multipliers[multipliers >= system.n_u]
        self._position = np.full(equations.n, ABSENT)
        self._position[multipliers] = np.arange(len(multipliers))
        self._at_lam = np.where(equations.at["lam"] == ABSENT, ABSENT, self._position[equations.at["lam"]])
        jacobian = system.term("acceleration", "J")
        row = self._at_lam[jacobian.row]
        kept = row != ABSENT
        self._j = (jacobian.source[kept], row[kept], jacobian.column[kept])
        products = self._products()
        columns = _filled({(a, b) for a, b, *_ in products}, len(multipliers))
        updates = sum(len(below) * (len(below) + 1) // 2 for below in columns)
        hanging = len(system.term("acceleration", "f_lam").source)
        self.serves = not hanging and updates <= MOST_UPDATES_PER_ENTRY * max(len(self._j[0]), 1)
        self.table = np.zeros(len(ELIMINATED), dtype=np.int64)
        if self.serves:
            self._arrays = self._packable(state, products, columns)
            self.table = packed(ELIMINATED, self._arrays)

    def _products(self) -> list[tuple[int, int, int, int, int]]:
        """Row, column, both factors and the velocity of every product in the lower half of J M^-1 J^T."""
        at_velocity: dict[int, list[tuple[int, int]]] = {}
        for source, row, column in zip(*(part.tolist() for part in self._j), strict=True):
            at_velocity.setdefault(column, []).append((row, source))
        return [
            (max(a, b), min(a, b), first, second, column)
            for column, entries in at_velocity.items()
            for (a, first), (b, second) in [*((e, e) for e in entries), *_pairs(entries)]
        ]

    def _packable(
        self, state: State, products: list[tuple[int, int, int, int, int]], columns: list[list[int]]
    ) -> dict[str, Any]:
        system = state.system
        starts = np.cumsum([0, *(1 + len(below) for below in columns)])
        slot = {
            (row, k): int(starts[k]) + place for k, below in enumerate(columns) for place, row in enumerate((k, *below))
        }
        updates = [[slot[b, a] for p, a in enumerate(below) for b in below[p:]] for below in columns]
        force, gamma = system.term("acceleration", "f"), system.term("acceleration", "gamma")
        gamma_row = self._at_lam[gamma.row]
        n = len(columns)
        lists = {
            "f_source": force.source, "f_row": force.row,
            "gamma_source": gamma.source[gamma_row != ABSENT], "gamma_row": gamma_row[gamma_row != ABSENT],
            "j_source": self._j[0], "j_row": self._j[1], "j_column": self._j[2], "at_lam": self._at_lam,
            "product_slot": [slot[a, b] for a, b, *_ in products], "product_first": [p[2] for p in products],
            "product_second": [p[3] for p in products], "column_start": starts,
            "row": [row for k, below in enumerate(columns) for row in (k, *below)],
            "update_start": np.cumsum([0, *(len(part) for part in updates)]),
            "update_slot": [at for part in updates for at in part],
        }  # fmt: skip
        inverse_mass = 1.0 / system.mass
        return {
            **{name: np.array(values, dtype=np.int64) for name, values in lists.items()},
            "state": state.table, "n": n, "n_u": system.n_u, "n_f": len(force.source),
            "n_gamma": len(lists["gamma_source"]), "n_j": len(self._j[0]), "n_products": len(products),
            "n_slots": int(starts[-1]), "inverse_mass": inverse_mass,
            "product_weight": np.array([inverse_mass[p[4]] for p in products], dtype=float),
            "s": np.zeros(int(starts[-1])), "l": np.zeros(int(starts[-1])), "diagonal": np.zeros(n),
            "a": np.zeros(system.n_u), "b": np.zeros(n),
        }  # fmt: skip


def _pairs(entries: list[tuple[int, int]]) -> list[Any]:
    """Pairs of different entries; both orders where they stand in the same row."""
    both = [(a, b) for a, b in combinations(entries, 2)]
    return both + [(b, a) for a, b in both if a[0] == b[0]]


def _filled(entries: set[tuple[int, int]], n: int) -> list[list[int]]:
    """The rows below the diagonal of each column of the factor, in order."""
    below: list[set[int]] = [set() for _ in range(n)]
    for row, column in entries:
        if row != column:
            below[column].add(row)
    for k in range(n):
        if below[k]:
            parent = min(below[k])
            below[parent] |= below[k] - {parent}
    return [sorted(rows) for rows in below]
