"""Torsion spring-damper."""

from __future__ import annotations

from typing import Any, ClassVar

from ..element import Symbolic
from ..marker import Marker
from .angle_spring import AngleSpring


class TorsionSpring(AngleSpring[Marker]):
    """Rotational spring and damper, linear or by curves, on the angle of marker i against marker j.

    With the deflection s = angle - free_angle and its rate v the moment
    k s + spring_law(s) + c v + damper_law(v) + preload turns i back towards j, and j as much the other way.

    Angles are counted over whole turns.  A spring law that is a table or a polynomial in s has a potential; with
    any other formula the element counts none, and energy.total is not kept.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), sec. 6.2 (RSDA).
    """

    kind: ClassVar[str] = "torsion_spring"
    reflected: ClassVar[dict[str, str] | None] = {
        "free_angle": "angle",
        "preload": "angle",
        "spring_law": "angle",
        "damper_law": "angle",
    }

    @staticmethod
    def angle(e: Symbolic) -> Any:
        return e.i.angle - e.j.angle

    def in_space(self, angles: Any) -> dict[str, Any]:
        from ..spatial.embedding.forces import torsion_spring

        return torsion_spring(self, angles)
