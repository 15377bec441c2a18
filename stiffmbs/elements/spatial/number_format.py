"""Number format of scenes."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from .orientation import from_matrix


def plain(value: float) -> float | int:
    """Return a Python number: an int if it is whole, without negative zero."""
    value = float(value)
    return int(value) if value.is_integer() and abs(value) < 1e15 else value


def vector(values: Iterable[float]) -> list[float | int]:
    """Return a list of such numbers."""
    return [plain(value) for value in values]


def quaternion(axes: np.ndarray) -> list[float | int]:
    """Return the orientation whose axes are the columns of a matrix, as w, x, y, z."""
    return vector(from_matrix(axes))
