"""Symmetric stiffness and damping matrices as fields, given in full or by their diagonal."""

from __future__ import annotations

import itertools
from typing import Any


def from_diagonal(found: Any) -> Any:
    """Return the rows of a diagonal matrix, with None for uncoupled directions; other values are unchanged."""
    if not isinstance(found, list | tuple) or any(isinstance(part, list | tuple) for part in found):
        return found
    return tuple(tuple(part if k == row else None for k in range(len(found))) for row, part in enumerate(found))


def check_symmetric(matrix: Any) -> Any:
    """Return the matrix if it is symmetric.

    Raises
    ------
    ValueError
        If two entries across the diagonal differ.
    """
    for row, column in itertools.combinations(range(len(matrix)), 2):
        one, other = matrix[row][column] or 0.0, matrix[column][row] or 0.0
        if abs(one - other) > 1e-12 * max(abs(one), abs(other)):
            raise ValueError(
                f"found {one:g} in row {row + 1}, column {column + 1} and {other:g} across the diagonal, "
                "expected a symmetric matrix"
            )
    return matrix


def product(matrix: Any, vector: Any) -> list[Any]:
    """Return matrix times vector, skipping entries that are None."""
    return [sum(k * part for k, part in zip(row, vector, strict=True) if k is not None) for row in matrix]
