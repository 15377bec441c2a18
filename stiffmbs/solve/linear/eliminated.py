"""The block system of accelerations with u' eliminated, for systems whose bodies carry few joints each."""

from __future__ import annotations

import heapq
from itertools import combinations
from typing import Any

import numpy as np

from ...compile.equations import ABSENT, Equations
from ...compile.machine.layout import DTYPES, ELIMINATED, fill
from ...compile.state import State
from .saddle_point import ACCELERATIONS

MOST_UPDATES_PER_ENTRY = 20
"""Multiplications of the factors for each entry of J up to which they are cheaper than the LU of the whole."""
EVEN = 100.0
"""Times the square root of the smallest inertia, in the measure of masses, up to which pivots are those of the geometry."""


class Eliminated:
    """J M^-1 J^T lam = J M^-1 f - gamma, then u' = M^-1 (f - J^T lam), by flat lists for compiled code.

    The matrix is symmetric and positive definite, so its factors L D L^T need no pivots and keep their pattern.

    Attributes
    ----------
    serves : bool
        Whether the system is of the kind: no force depends on multipliers or algebraic states, and the factors stay sparse.
    pivots_tell : bool
        Whether pivots tell how near to singular a pose is: it serves, and no inertia is so small that it decides about them.
    table : ndarray of int
        Addresses (`stiffmbs.compile.machine.layout.ELIMINATED`), zeros where it does not serve.
    """

    def __init__(self, state: State) -> None:
        system = state.system
        equations = Equations(ACCELERATIONS, system)
        jacobian = system.term("acceleration", "J")
        rows = _balanced_order(jacobian.row, jacobian.column // system.of_body.n_u, system.joint_start)
        rows = rows[equations.at["lam"][rows] != ABSENT]
        self._at_lam = np.full(system.n_c, ABSENT)
        self._at_lam[rows] = np.arange(len(rows))
        row = self._at_lam[jacobian.row]
        kept = np.flatnonzero(row != ABSENT)
        kept = kept[np.lexsort((jacobian.column[kept], row[kept]))]
        self._j = (jacobian.source[kept], row[kept], jacobian.column[kept])
        products = self._products()
        columns = _filled({(a, b) for a, b, *_ in products}, len(rows))
        updates = sum(len(below) * (len(below) + 1) // 2 for below in columns)
        hanging = len(system.term("acceleration", "f_lam").source)
        self.serves = (
            not hanging and not system.algebraic.any() and updates <= MOST_UPDATES_PER_ENTRY * max(len(self._j[0]), 1)
        )
        resisting = np.sqrt(system.mass) / system.per_velocity(1.0, system.size)
        self.pivots_tell = self.serves and bool(resisting.max(initial=0.0) < EVEN * resisting.min(initial=np.inf))
        self.table = np.zeros(len(ELIMINATED), dtype=np.int64)
        self._cells = self.table.view(ELIMINATED.cells)[0]
        if self.serves:
            self._arrays = self._packable(state, products, columns)
            fill(self.table, ELIMINATED, self._arrays)

    def forget(self) -> None:
        """Forget how many digits pivots have kept so far, so that a run's rounding does not depend on earlier runs."""
        self._cells["most_kept"] = 0.0

    def _products(self) -> list[tuple[int, int, int, int]]:
        """Row, column and both factors (by their number among the entries of J) of every product in the lower half of J M^-1 J^T."""
        at_velocity: dict[int, list[tuple[int, int]]] = {}
        for place, (row, column) in enumerate(zip(*(part.tolist() for part in self._j[1:]), strict=True)):
            at_velocity.setdefault(column, []).append((row, place))
        return [
            (max(a, b), min(a, b), first, second)
            for entries in at_velocity.values()
            for (a, first), (b, second) in [*((e, e) for e in entries), *_pairs(entries)]
        ]

    def _packable(
        self, state: State, products: list[tuple[int, int, int, int]], columns: list[list[int]]
    ) -> dict[str, Any]:
        system = state.system
        starts = np.cumsum([0, *(1 + len(below) for below in columns)])
        slot = {
            (row, k): int(starts[k]) + place for k, below in enumerate(columns) for place, row in enumerate((k, *below))
        }
        updates = [[slot[b, a] for p, a in enumerate(below) for b in below[p:]] for below in columns]
        products = sorted(products, key=lambda product: (slot[product[:2]], product))
        force, gamma = system.term("acceleration", "f"), system.term("acceleration", "gamma")
        gamma_row = self._at_lam[gamma.row]
        n = len(columns)
        lists = {
            "f_source": force.source, "f_row": force.row,
            "gamma_source": gamma.source[gamma_row != ABSENT], "gamma_row": gamma_row[gamma_row != ABSENT],
            "j_source": self._j[0], "j_row": self._j[1], "j_column": self._j[2], "at_lam": self._at_lam,
            "product_end": np.cumsum(np.bincount([slot[p[:2]] for p in products], minlength=int(starts[-1]))), "product_first": [p[2] for p in products],
            "product_second": [p[3] for p in products], "column_start": starts,
            "row": [row for k, below in enumerate(columns) for row in (k, *below)],
            "update_slot": [at for part in updates for at in part],
        }  # fmt: skip
        scale = 1.0 / np.sqrt(system.mass)
        return {
            **{name: np.array(values, dtype=DTYPES[ELIMINATED[name]]) for name, values in lists.items()},
            "state": state.table, "n": n, "n_u": system.n_u, "n_f": len(force.source),
            "n_gamma": len(lists["gamma_source"]), "n_j": len(self._j[0]),
            "n_slots": int(starts[-1]), "scale": scale, "j_scale": scale[self._j[2]], "j": np.zeros(len(self._j[0])),
            "s": np.zeros(int(starts[-1])), "l": np.zeros(int(starts[-1])), "diagonal": np.zeros(n),
            "a": np.zeros(system.n_u), "b": np.zeros(n), "kept": 1.0,
        }  # fmt: skip


def _balanced_order(row: np.ndarray, body: np.ndarray, joint_start: np.ndarray) -> np.ndarray:
    """An order of the multipliers with little fill: minimum degree on joints that share a body.

    Of joints with as few neighbours the one whose turn depends on the fewest before it comes first: a chain is taken
    from both ends at a time, so that the processor works on two pivots at once.
    """
    joint = np.searchsorted(joint_start, row, side="right") - 1
    around: list[set[int]] = [set() for _ in joint_start[1:]]
    of_body: dict[int, set[int]] = {}
    for one, place in zip(joint.tolist(), body.tolist(), strict=True):
        of_body.setdefault(place, set()).add(one)
    for meeting in of_body.values():
        for one in meeting:
            around[one] |= meeting - {one}
    level = [0] * len(around)
    queue = [(len(others), 0, one) for one, others in enumerate(around)]
    heapq.heapify(queue)
    order: list[int] = []
    gone: set[int] = set()
    while queue:
        degree, depth, one = heapq.heappop(queue)
        if one in gone or (degree, depth) != (len(around[one]), level[one]):
            continue
        gone.add(one)
        order += range(joint_start[one], joint_start[one + 1])
        for other in around[one]:
            around[other] |= around[one]
            around[other] -= {one, other}
            level[other] = max(level[other], depth + 1)
        for other in around[one]:
            heapq.heappush(queue, (len(around[other]), level[other], other))
    return np.array(order, dtype=np.int64)


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
