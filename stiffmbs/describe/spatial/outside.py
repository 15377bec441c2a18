"""Distance of a point from a solid that it is outside of."""

from __future__ import annotations

from typing import Any

LEAST_DISTANCE = 1e-9
"""Offset of distances in quadrature, m, for finite derivatives at zero."""


def above(x: Any) -> Any:
    """Return max(x, 0)."""
    from sympy import Max

    return Max(x, 0)


def length(*parts: Any) -> Any:
    """Return the length of a vector, with a finite derivative at zero."""
    from sympy import sqrt

    return sqrt(sum(part**2 for part in parts) + LEAST_DISTANCE**2)
