"""Numbers as a scene writes them."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from .orientation import from_matrix


def plain(value: float) -> float | int:
    """A Python number: whole where it is, and no minus before a zero."""
    value = float(value)
    return int(value) if value.is_integer() and abs(value) < 1e15 else value


def vector(values: Iterable[float]) -> list[float | int]:
    """A list of such numbers."""
    return [plain(value) for value in values]


def quaternion(axes: np.ndarray) -> list[float | int]:
    """The orientation whose axes stand in the columns of a matrix, as w, x, y, z."""
    return vector(from_matrix(axes))
