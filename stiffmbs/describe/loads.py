"""Loads on a joint's surfaces, from its multipliers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


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

    across: Any = 0
    thrust: Any = 0
    bending: Any = 0
    torsion: Any = 0
