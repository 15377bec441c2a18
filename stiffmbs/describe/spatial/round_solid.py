"""Ellipsoids, boxes and cylinders as Minkowski sums of ellipsoids, whose surfaces have one normal and one point for each other.

The support function of the sum of ellipsoids with matrices M about one middle is h(n) = sum sqrt(n^T M n), and h'(n) is the point
of the surface with the normal n.  A box is the sum of three thin ellipsoids along its axes, a cylinder that of a thin one along
its axis and a flat one across.  Schneider, Convex Bodies: The Brunn-Minkowski Theory (2014), sec. 1.7 and 3.5.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

from ..element import Symbolic

Shape = Literal["ellipsoid", "box", "cylinder"]
ROUNDING = 1e-4
"""Radius of the edges of boxes and cylinders as a part of half their least size."""


@dataclass(frozen=True)
class RoundSolid:
    """A solid about a middle, with its axes.

    Attributes
    ----------
    ellipsoids : list of lists of three expressions
        Squares of their semi-axes, m^2.
    least : expression
        Half of the least size, m.
    """

    ellipsoids: list[list[Any]]
    least: Any

    def support(self, n: Any) -> Any:
        """How far the solid reaches from its middle along a unit vector, which is given along its axes."""
        return sum(_reach(squares, n) for squares in self.ellipsoids)

    def point(self, e: Symbolic, n: Any) -> Any:
        """The point of its surface where n is normal, from its middle, along its axes."""
        from sympy import Matrix

        reaches = [e.named(_reach(squares, n)) for squares in self.ellipsoids]
        parts = zip(self.ellipsoids, reaches, strict=True)
        by_part = [[square * way / reach for square, way in zip(squares, n, strict=True)] for squares, reach in parts]
        return Matrix([sum(along) for along in zip(*by_part, strict=True)])


def round_solid(e: Symbolic, shape: Shape, size: Any) -> RoundSolid:
    """A solid of whole sizes along its axes; the axis of a cylinder is z."""
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
