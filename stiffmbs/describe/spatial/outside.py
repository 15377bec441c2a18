"""Distance of a point from a solid that it is outside of."""

from __future__ import annotations

from typing import Any

from ..element import Symbolic
from .impact import Touch

TINY = 1e-9
"""m, added to distances in quadrature, so that their derivatives exist at zero."""
INSIDE = (
    "found the centre of a sphere inside the solid that it meets, expected it outside: more stiffness, or a lower speed"
)


def above(x: Any) -> Any:
    """What a coordinate exceeds zero by."""
    from sympy import Max

    return Max(x, 0)


def length(*parts: Any) -> Any:
    """Of a vector by its components, with a derivative where it vanishes."""
    from sympy import sqrt

    return sqrt(sum(part**2 for part in parts) + TINY**2)


def touch_of_sphere(e: Symbolic, way: Any) -> Touch:
    """Of a sphere about marker i, by the way (along the axes of j) from the nearest point of the solid to its centre."""
    distance = e.named(length(*way))
    x, y, z = (part / distance for part in way)
    normal = e.named(x * e.j.x + y * e.j.y + z * e.j.z)
    return Touch(distance - e.radius, e.i.point - e.radius * normal, normal)
