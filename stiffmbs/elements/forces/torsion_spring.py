"""Planar torsion spring-damper."""

from __future__ import annotations

from ...reading.marker import Marker
from ..element import Expr, Symbolic
from ..turns import KeepsDescribedTurns
from .springs import AngleSpring


class TorsionSpring(KeepsDescribedTurns, AngleSpring[Marker]):
    """Rotational spring and damper on the angle of marker i relative to marker j, linear or nonlinear.

    With the deflection s = angle - free_angle and its rate v the restoring moment on i is k s + spring_law(s) + c v +
    damper_law(v) + preload. The opposite moment acts on j.

    Full revolutions of the angle are counted, including those between the described angles; a spring that a stage adds
    starts within half a turn. A spring law that is a table or a polynomial in s has a potential. With
    any other formula the element has none, and energy.total is not conserved.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), sec. 6.2 (RSDA).
    """

    @staticmethod
    def angle(e: Symbolic) -> Expr:
        return e.i.angle - e.j.angle
