"""Distance of a point from a solid that it is outside of."""

from __future__ import annotations

from typing import Any

LEAST_DISTANCE = 1e-9
"""m, added to distances in quadrature, so that their derivatives exist at zero."""


def above(x: Any) -> Any:
    """What a coordinate exceeds zero by."""
    from sympy import Max

    return Max(x, 0)


def length(*parts: Any) -> Any:
    """Of a vector by its components, with a derivative where it vanishes."""
    from sympy import sqrt

    return sqrt(sum(part**2 for part in parts) + LEAST_DISTANCE**2)
