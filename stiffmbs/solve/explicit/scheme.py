"""What an explicit Runge-Kutta scheme is: a table of coefficients."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from ...compile.machine.layout import packed
from ..native.tables.steps import SCHEME

Row = Mapping[int, float]
"""The coefficients of a sum over stages that are not zero, by stage."""


@dataclass(frozen=True)
class Scheme:
    """Butcher's table of an explicit Runge-Kutta scheme.

    Stage i is k_i = f(t + c_i h, y + h sum_j a_ij k_j).  The stage with the number `stages` is taken at the step's
    end: its row holds the weights, and it is the first of the next step.  Those behind it serve the interpolant alone.

    Attributes
    ----------
    name : str
    order : int
    stages : int
        Evaluations that one step needs, the one at its end not counted.
    c : tuple of float
        Nodes of all stages.
    a : tuple of Row
        Coefficients of all stages.
    errors : tuple of Row
        Differences to embedded schemes, none for a scheme of fixed step.  With two, the estimate is
        h |e_1|^2 / sqrt(|e_1|^2 + 0.01 |e_2|^2) (Hairer's for orders 5 and 3).
    dense : tuple of Row
        The coefficients behind the third of the interpolant (`stiffmbs.solve.native.explicit.interpolant`).
    free : tuple of Row
        The same of an interpolant that needs no stages of its own; none where `dense` is one.
    free_error : Row
        How far that interpolant may be off: a sum of stages that vanishes to its order, times the step.
    exponent, memory : float
        Of the step control: the next step is 0.9 h error^(-exponent + 0.75 memory) last_error^memory.
    stability : float
        |h lambda| above which stability, and no longer accuracy, holds the step back.
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

    @property
    def extended(self) -> int:
        """All stages: those of a step, the one at its end, and those of the interpolant."""
        return len(self.c)

    @property
    def adaptive(self) -> bool:
        """Whether the scheme estimates its error and so chooses its step."""
        return bool(self.errors)

    @property
    def error_needs_end(self) -> bool:
        """Whether the estimate asks for the stage at the step's end."""
        return any(self.stages in row for row in self.errors)

    @cached_property
    def _arrays(self) -> dict[str, Any]:
        """What the table points to."""
        return {
            "order": self.order, "stages": self.stages, "extended": self.extended, "n_errors": len(self.errors),
            "n_dense": len(self.dense), "n_free": len(self.free), "error_needs_end": self.error_needs_end,
            "c": np.array(self.c, dtype=float), "a": self.matrix(self.a),
            "errors": self.matrix(self.errors), "dense": self.matrix(self.dense),
            "free": self.matrix(self.free), "free_error": self.matrix((self.free_error,)),
            "exponent": self.exponent, "memory": self.memory, "stability": self.stability,
        }  # fmt: skip

    @cached_property
    def table(self) -> np.ndarray:
        """Addresses for compiled code (`stiffmbs.solve.native.tables.steps.SCHEME`)."""
        return packed(SCHEME, self._arrays)

    def matrix(self, rows: tuple[Row, ...]) -> np.ndarray:
        """Rows of coefficients as a full matrix, one column for each stage."""
        full = np.zeros((len(rows), self.extended))
        for k, row in enumerate(rows):
            for stage, value in row.items():
                full[k, stage] = value
        return full
