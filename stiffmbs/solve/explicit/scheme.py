"""Explicit Runge-Kutta schemes as tables of coefficients."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from ...compile.machine.layout import Table, packed
from ...compile.machine.routines import Routine
from .native.layouts import SCHEME

Row = Mapping[int, float]
"""Nonzero coefficients of a sum over stages, by stage."""


@dataclass(frozen=True)
class Scheme:
    """Butcher tableau of an explicit Runge-Kutta scheme.

    Stage i is k_i = f(t + c_i h, y + h sum_j a_ij k_j). Stage `stages` is evaluated at the end of the step: its row
    holds the weights, and it is the first stage of the next step. Later stages serve the interpolant only.

    - `stages`: evaluations per step, without the one at its end.
    - `c`: nodes of all stages.
    - `a`: coefficients of all stages.
    - `errors`: differences to embedded schemes; empty for a fixed-step scheme. With two, the estimate is h |e_1|^2 /
      sqrt(|e_1|^2 + 0.01 |e_2|^2) (Hairer's for orders 5 and 3).
    - `dense`: coefficients of the interpolant after the third (`stiffmbs.solve.explicit.native.interpolant`).
    - `free`: the same of an interpolant without additional stages; empty if `dense` needs none.
    - `free_error`: error bound of that interpolant: a sum of stages that vanishes to its order, times the step.
    - `exponent`, `memory`: of the step control: the next step is 0.9 h error^(-exponent + 0.75 memory)
      last_error^memory.
    - `semi_implicit`: true if the new velocities move the positions, as in `euler_cromer`, which has one stage.
    - `columns`: columns of the extrapolation table of linearly implicit Euler steps; 0 for an explicit scheme.
    - `stability`: |h lambda| above which stability, not accuracy, limits the step.
    """

    name: str
    order: int
    stages: int
    c: tuple[float, ...]
    a: tuple[Row, ...]
    errors: tuple[Row, ...] = ()
    dense: tuple[Row, ...] = ()
    free: tuple[Row, ...] = ()
    free_error: Row = field(default_factory=dict)
    exponent: float = 0.0
    memory: float = 0.0
    stability: float = field(default=float("inf"))
    semi_implicit: bool = False
    columns: int = 0

    @property
    def extended(self) -> int:
        """Number of all stages: those of a step, the one at its end, and those of the interpolant."""
        return len(self.c)

    @property
    def adaptive(self) -> bool:
        """True if the scheme has an error estimate."""
        return bool(self.errors)

    @property
    def error_needs_end(self) -> bool:
        """True if the error estimate uses the stage at the end of the step."""
        return any(self.stages in row for row in self.errors)

    def work(self, steps: int) -> dict[str, int]:
        """Return the work of fixed steps, under the name of its counter."""
        if self.columns:
            return {"factorizations": self.columns * (self.columns + 1) // 2 * steps}
        return {"accelerations": self.stages * steps}

    @cached_property
    def _arrays(self) -> dict[str, Any]:
        return {
            "order": self.order, "stages": self.stages, "extended": self.extended, "n_errors": len(self.errors),
            "n_dense": len(self.dense), "n_free": len(self.free), "error_needs_end": self.error_needs_end, "by_stages": not (self.semi_implicit or self.columns), "columns": self.columns,
            "c": np.array(self.c, dtype=float), "a": self.matrix(self.a),
            "errors": self.matrix(self.errors), "dense": self.matrix(self.dense),
            "free": self.matrix(self.free), "free_error": self.matrix((self.free_error,)),
            "exponent": self.exponent, "memory": self.memory, "stability": self.stability,
        }  # fmt: skip

    @cached_property
    def table(self) -> Table:
        """Addresses for compiled code (`stiffmbs.solve.explicit.native.layouts.SCHEME`)."""
        return packed(SCHEME, self._arrays)

    def matrix(self, rows: tuple[Row, ...]) -> np.ndarray:
        """Return rows of coefficients as a full matrix, one column per stage."""
        full = np.zeros((len(rows), self.extended))
        for k, row in enumerate(rows):
            for stage, value in row.items():
                full[k, stage] = value
        return full


ADVANCE = Routine(
    "stiffmbs.solve.explicit.native.runge_kutta", "advance", "int64(float64, int64, int64, int64, int64*)"
)
