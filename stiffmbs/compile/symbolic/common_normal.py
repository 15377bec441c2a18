"""The common normal of two convex solids in equations (`stiffmbs.compile.machine.geometry.common_normal`)."""

from __future__ import annotations

from collections.abc import Sequence

import sympy as sp

from ...errors import InputError


class CommonNormal(sp.Function):  # type: ignore[misc]
    """A component of the unit normal, in the axes of the second solid: CommonNormal(component, pose...)."""

    is_real = True

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        component, *pose = self.args
        normal = (CommonNormal(sp.Integer(k), *pose) for k in range(3))
        return CommonNormalSlope(component, sp.Integer(argindex - 2), *normal, *pose)


class CommonNormalSlope(sp.Function):  # type: ignore[misc]
    """Its derivative by an entry of the pose: CommonNormalSlope(component, entry, normal..., pose...)."""

    is_real = True

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        raise InputError(
            "found a second derivative of the normal of two solids, expected it in efforts, and not in rates"
        )


def common_normal(
    way: Sequence[sp.Expr],
    axes: Sequence[sp.Expr],
    first: Sequence[Sequence[sp.Expr]],
    second: Sequence[Sequence[sp.Expr]],
) -> sp.Matrix:
    """The unit normal from the second solid to the first, in the second one's axes.

    Parameters
    ----------
    way : 3 expressions
        From the middle of the second solid to that of the first, m.
    axes : 9 expressions
        The rotation matrix that takes components along the first solid's axes into those along the second's, row by row.
    first, second : up to 3 sequences of 3 expressions each
        Squares of the semi-axes of the ellipsoids whose Minkowski sum a solid is, m^2.
    """
    pose = [*way, *axes, *_all_three(first), *_all_three(second)]
    return sp.Matrix([CommonNormal(sp.Integer(k), *pose) for k in range(3)])


def _all_three(ellipsoids: Sequence[Sequence[sp.Expr]]) -> list[sp.Expr]:
    squares = [square for ellipsoid in ellipsoids for square in ellipsoid]
    return squares + [sp.Integer(0)] * (9 - len(squares))
