"""Common normal of two convex solids in equations (`stiffmbs.compile.machine.geometry.common_normal`)."""

from __future__ import annotations

from collections.abc import Sequence

import sympy as sp

from ...errors import InputError


class CommonNormal(sp.Function):  # type: ignore[misc]
    """Component of the unit normal in the axes of the second solid: CommonNormal(component, pose...)."""

    is_real = True

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        component, *pose = self.args
        normal = (CommonNormal(sp.Integer(k), *pose) for k in range(3))
        return CommonNormalSlope(component, sp.Integer(argindex - 2), *normal, *pose)


class CommonNormalSlope(sp.Function):  # type: ignore[misc]
    """Derivative of the normal by an entry of the pose: CommonNormalSlope(component, entry, normal..., pose...)."""

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
    """Return the unit normal from the second solid to the first, in the second one's axes.

    Parameters
    ----------
    way : 3 expressions
        Vector from the centre of the second solid to that of the first, m.
    axes : 9 expressions
        Rotation matrix from the axes of the first solid to those of the second, by rows.
    first, second : up to 3 sequences of 3 expressions each
        Squared semi-axes of the ellipsoids whose Minkowski sum is the solid, m^2.
    """
    pose = [*way, *axes, *_all_three(first), *_all_three(second)]
    return sp.Matrix([CommonNormal(sp.Integer(k), *pose) for k in range(3)])


def _all_three(ellipsoids: Sequence[Sequence[sp.Expr]]) -> list[sp.Expr]:
    squares = [square for ellipsoid in ellipsoids for square in ellipsoid]
    return squares + [sp.Integer(0)] * (9 - len(squares))
