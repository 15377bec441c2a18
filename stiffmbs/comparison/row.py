"""Measurement as a row of a table."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np


@dataclass(frozen=True)
class Row:
    """Measurement of a solver configuration at a setting.

    Attributes
    ----------
    solver, setting : str
        Texts such as ``dop853`` and ``rtol 1e-06``.
    errors : mapping of str to float
        Largest errors over all output instants and channels, by measure; empty if the run failed.
    seconds : float
        Median of the times of a solution; nan if the run failed.
    steps : int
    message : str
        Reason of a failure; else empty.
    """

    solver: str
    setting: str
    errors: Mapping[str, float]
    seconds: float
    steps: int
    message: str = ""

    def as_dict(self, measure: str) -> dict[str, Any]:
        """Return a row of ``stiffmbs compare --json``; a failed run has a message, and None as error and time."""
        found = {"solver": self.solver, "setting": self.setting, "error": _finite(self.errors.get(measure, np.nan))}
        told = {"message": self.message} if self.message else {}
        return {**found, "seconds": _finite(self.seconds), "steps": self.steps, **told}


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None
