"""Stiffness and damping matrices of bushings, fields and beams."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import Any

from ...reading.units import si
from ..element import Expr, Symbolic

K = si.Stiffness | None
Kc = si.CouplingStiffness | None
Kt = si.TorsionalStiffness | None
C = si.Damping | None
Cc = si.CouplingDamping | None
Ct = si.TorsionalDamping | None
"""Entries of stiffness and damping matrices: of forces, of coupling, of torques."""

REFLECTED = {"stiffness": "matrix", "damping": "matrix", "preload": "components"}
"""Transformation of the fields of bushings and fields in a mirror image (`stiffmbs.elements.element.Element`)."""

Rows = Sequence[Sequence[Expr | None]]
"""Rows of a matrix: numbers or symbols; None for uncoupled directions."""


def from_diagonal(found: object) -> Any:
    """Return the rows of a diagonal matrix, with None for uncoupled directions; other values are unchanged."""
    if not isinstance(found, list | tuple) or any(isinstance(part, list | tuple) for part in found):
        return found
    return tuple(tuple(part if k == row else None for k in range(len(found))) for row, part in enumerate(found))


def check_symmetric(matrix: Rows) -> Rows:
    """Return the matrix if it is symmetric. Raises ValueError if two entries across the diagonal differ."""
    for row, column in itertools.combinations(range(len(matrix)), 2):
        one, other = matrix[row][column] or 0.0, matrix[column][row] or 0.0
        if abs(one - other) > 1e-12 * max(abs(one), abs(other)):
            raise ValueError(
                f"found {one:g} in row {row + 1}, column {column + 1} and {other:g} across the diagonal, "
                "expected a symmetric matrix"
            )
    return matrix


def times(matrix: Rows, vector: Sequence[Expr]) -> list[Expr]:
    """Return matrix times vector, skipping entries that are None."""
    return [sum(k * part for k, part in zip(row, vector, strict=True) if k is not None) for row in matrix]


def stored(stiffness: Rows, s: Sequence[Expr], preload: Sequence[Expr | None]) -> Expr:
    """Return 1/2 s^T K s - preload . s, J."""
    resisting = times(stiffness, s)
    return sum(f * x / 2 - (p or 0) * x for f, p, x in zip(resisting, preload, s, strict=True))


def stored_with_laws(e: Symbolic, s: Sequence[Expr], laws: Sequence[Expr | None]) -> Expr:
    """Return `stored` plus the integrals of laws, J; zero if one has no closed-form integral."""
    of_laws = [e.integral(law, part) for law, part in zip(laws, s, strict=True) if law is not None]
    return 0 if None in of_laws else stored(e.stiffness, s, e.preload) + sum(of_laws)
