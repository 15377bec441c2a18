"""A measurement, as it stands in a table."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np


@dataclass(frozen=True)
class Row:
    """A way to solve at a setting.

    Attributes
    ----------
    solver, setting : str
        ``dop853``, ``rtol 1e-06``.
    errors : mapping of str to float
        Largest over all output instants and channels, by measure; empty where it failed.
    seconds : float
        Median of the times of a solution; NaN where it failed.
    steps : int
    message : str
        Why it failed; empty where it did not.
    """

    solver: str
    setting: str
    errors: Mapping[str, float]
    seconds: float
    steps: int
    message: str = ""

    def as_dict(self, measure: str) -> dict[str, Any]:
        """A row of ``stiffmbs compare --json``; error and time are None, and there is a message, where it failed."""
        found = {"solver": self.solver, "setting": self.setting, "error": _finite(self.errors.get(measure, np.nan))}
        told = {"message": self.message} if self.message else {}
        return {**found, "seconds": _finite(self.seconds), "steps": self.steps, **told}


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None
