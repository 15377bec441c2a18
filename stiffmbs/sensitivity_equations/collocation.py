"""Variational equations along steps of `radau`, by a Radau IIA method.

The stages S_i of r_y s + r_y' s' + r_p = 0 satisfy A_i S_i + (1/h) B_i sum_j D_ij (S_j - s_n) + r_p,i = 0 with A = r_y and
B = r_y' at the nodes.  These linear equations are solved together for S_i - s_n, which rounding does not spoil in short steps.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..solve.radau.collocation import radau
from .equations import VariationalEquations, singular
from .recorded import STAGES


class CollocationVariations(VariationalEquations):
    """Variational equations along steps of `radau`, which are recorded at the nodes."""

    def __init__(self, *arguments: Any) -> None:
        super().__init__(*arguments)
        self._method = radau(STAGES)
        row, column = (np.asarray(self._kept[0][name], dtype=np.int64) for name in ("row", "column"))
        stage = np.arange(STAGES)
        shape = (
            STAGES,
            STAGES,
            len(row),
        )  # the stages of an unknown are neighbours, as the blocks of the matrix then stay small
        self._rows = np.broadcast_to(row * STAGES + stage[:, None, None], shape).ravel()
        self._columns = np.broadcast_to(column * STAGES + stage[None, :, None], shape).ravel()

    def begin(self, t: float, first_step: float, s: np.ndarray, rates: np.ndarray) -> None:
        """Begin at the sensitivities s; the stages need neither the first step nor rates."""
        self._t, self._s = t, s
        self._known = t, s[None]

    def advance(self, steps: np.ndarray) -> None:
        """Solve the stage equations of some steps."""
        for step in steps:
            self._t, self._s = step[-1, 0], self._stages(step)[-1]

    def within(self, row: np.ndarray, step: np.ndarray) -> np.ndarray:
        """Return the collocation polynomial of the next step at the time of a row."""
        place = (row[0] - self._t) / (step[-1, 0] - self._t)
        nodes = np.concatenate([[0.0], self._method.nodes])
        apart = place - nodes
        basis = [weight * np.prod(np.delete(apart, k)) for k, weight in enumerate(self._method.weights)]
        found: np.ndarray = np.tensordot(basis, np.concatenate([self._s[None], self._stages(step)]), 1)
        return found

    @property
    def last(self) -> np.ndarray:
        return self._s.copy()

    def _stages(self, step: np.ndarray) -> np.ndarray:
        """Return s at the nodes of the next step, shape (stages, directions, n)."""
        if step[-1, 0] != self._known[0]:
            self._known = step[-1, 0], self._solved(step)
        return self._known[1]

    def _solved(self, step: np.ndarray) -> np.ndarray:
        from scipy.sparse import csc_array
        from scipy.sparse.linalg import splu

        arrays: dict[str, Any] = self._kept[0]
        n = self.equations.n
        D = self._method.derivative / (step[-1, 0] - self._t)
        entries = np.empty((STAGES, STAGES, len(arrays["row"])))
        right = np.empty((n, STAGES, len(self._s)))
        for i, row in enumerate(step):
            right[:, i] = -self.defects(row, self._s).T
            entries[i] = D[i][:, None] * arrays["rate"]
            entries[i, i] += arrays["constant"]
        size, values = n * STAGES, entries.ravel()
        kept = np.flatnonzero(values)  # stages are coupled by r_y' alone, which has few of the entries
        at = self._rows[kept], self._columns[kept]
        try:
            solution = splu(csc_array((values[kept], at), shape=(size, size)))
        except RuntimeError:
            raise singular(step[-1, 0]) from None
        change: np.ndarray = solution.solve(right.reshape(size, -1)).reshape(n, STAGES, -1).transpose(1, 2, 0)
        return self._s + change
