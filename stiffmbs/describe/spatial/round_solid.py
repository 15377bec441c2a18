"""Ellipsoids, boxes and cylinders as Minkowski sums of ellipsoids, which makes their surfaces smooth and strictly
convex.

The support function of the sum of concentric ellipsoids with matrices M is h(n) = sum sqrt(n^T M n). Its gradient h'(n)
is the surface point with the normal n. A box is the sum of three thin ellipsoids along its axes. A cylinder is that of
a thin one along its axis and a flat one normal to it. Schneider, Convex Bodies: The Brunn-Minkowski Theory (2014), sec.
1.7 and 3.5.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

from ..element import Symbolic

Shape = Literal["ellipsoid", "box", "cylinder"]
ROUNDING = 1e-4
"""Edge radius of boxes and cylinders relative to half their smallest size."""


@dataclass(frozen=True)
class RoundSolid:
    """Solid about its centre, in its axes.

    Attributes
    ----------
    ellipsoids : list of lists of three expressions
        Squares of their semi-axes, m^2.
    least : expression
        Half the smallest size, m.
    """

    ellipsoids: list[list[Any]]
    least: Any

    def support(self, n: Any) -> Any:
        """Return the support function for a unit vector along its axes."""
        return sum(_reach(squares, n) for squares in self.ellipsoids)

    def point(self, e: Symbolic, n: Any) -> Any:
        """Return the surface point with the normal n, from its centre, along its axes."""
        from sympy import Matrix

        reaches = [e.named(_reach(squares, n)) for squares in self.ellipsoids]
        parts = zip(self.ellipsoids, reaches, strict=True)
        by_part = [[square * way / reach for square, way in zip(squares, n, strict=True)] for squares, reach in parts]
        return Matrix([sum(along) for along in zip(*by_part, strict=True)])


def round_solid(e: Symbolic, shape: Shape, size: Any) -> RoundSolid:
    """Return a solid with the given full sizes along its axes; the axis of a cylinder is z."""
    from sympy import Min

    halves = [e.named(whole / 2) for whole in size]
    least = e.named(Min(*halves))
    if shape == "ellipsoid":
        return RoundSolid([[half**2 for half in halves]], least)
    edge = e.named(ROUNDING * least)
    x, y, z = halves
    if shape == "cylinder":
        across = [e.named((half - edge) ** 2) for half in (x, y)]
        return RoundSolid([[*across, edge**2], [edge**2, edge**2, e.named((z - edge) ** 2)]], least)
    along = [e.named((half - 2 * edge) ** 2) for half in halves]
    return RoundSolid([[along[k] if k == row else edge**2 for k in range(3)] for row in range(3)], least)


def _reach(squares: list[Any], n: Any) -> Any:
    from sympy import sqrt

    return sqrt(sum(square * way**2 for square, way in zip(squares, n, strict=True)))
