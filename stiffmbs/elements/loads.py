"""Loads of a joint as its friction takes them, and magnitudes of vectors."""

from __future__ import annotations

from dataclasses import dataclass

from .element import Expr, Symbolic, sp

TINY = 1e-24
"""Offset under the root of the magnitude of a vector, N^2 or N^2 m^2, for a finite derivative at zero."""


def length(*parts: Expr, tiny: Expr = TINY) -> Expr:
    """Return the length of a vector, with a finite derivative at zero."""
    return sp.sqrt(sum(part**2 for part in parts) + tiny)


def magnitude(e: Symbolic, *parts: Expr) -> Expr:
    """Return the magnitude of a load and record its breakpoint at zero.

    A vector has a kink where all components are zero. One that passes close to zero changes its direction within a short time: a step that
    ends where a component is zero resolves both.
    """
    if len(parts) == 1:
        return sp.Abs(parts[0])
    e.breakpoints.extend(part for part in map(e.read, parts) if part not in e.breakpoints)
    return length(*parts)


@dataclass(frozen=True)
class Loads:
    """Magnitudes of a joint's reaction on the body of marker i, with the force at i's point.

    Attributes
    ----------
    across, thrust : Expr
        Force normal to the axis of the joint's coordinate (z of j in space) and along it, N.
    bending, torsion : Expr
        Moment normal to the axis and about it, N m.
    """

    across: Expr = 0
    thrust: Expr = 0
    bending: Expr = 0
    torsion: Expr = 0
