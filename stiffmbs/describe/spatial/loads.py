"""What presses a joint in space: the parts of its reaction, from its multipliers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ..element import Symbolic
from ..forces.friction import magnitude


@dataclass(frozen=True)
class Loads:
    """Magnitudes of a joint's reaction on the body of marker i, the force at i's point.

    Attributes
    ----------
    across, thrust : Expr
        Force across the axis z of j and along it, N.
    bending, torsion : Expr
        Moment across the axis and about it, N m.
    """

    across: Any = 0
    thrust: Any = 0
    bending: Any = 0
    torsion: Any = 0


def loads(joint: Symbolic) -> Loads:
    """Of a revolute, cylindrical, prismatic or spherical joint, whose multipliers are forces and torques along axes."""
    from sympy import Matrix

    lam = joint.lam
    match joint.kind:
        case "revolute":
            force, z = Matrix(lam[:3]), joint.j.z
            along = force.dot(z)
            return Loads(across=magnitude(*(force - along * z)), thrust=magnitude(along), bending=magnitude(*lam[3:]))
        case "cylindrical":
            return Loads(across=magnitude(*lam[:2]), bending=magnitude(*lam[2:]))
        case "prismatic":
            return Loads(across=magnitude(*lam[:2]), torsion=magnitude(lam[2]), bending=magnitude(*lam[3:]))
    return Loads(across=magnitude(*lam))
