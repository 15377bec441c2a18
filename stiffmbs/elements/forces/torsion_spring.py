"""Planar torsion spring-damper."""

from __future__ import annotations

from typing import TYPE_CHECKING, Self

from ...reading.marker import Marker
from ..element import Expr, Symbolic
from ..turns import WithinHalfATurn
from .springs import AngleSpring

if TYPE_CHECKING:
    from ...model.model_data import ModelData


class TorsionSpring(WithinHalfATurn, AngleSpring[Marker]):
    """Rotational spring and damper on the angle of marker i relative to marker j, linear or nonlinear.

    With the deflection s = angle - free_angle and its rate v the restoring moment on i is k s + spring_law(s) + c v +
    damper_law(v) + preload. The opposite moment acts on j.

    Full revolutions of the angle are counted, including those between the described angles; a spring that a stage adds
    starts within half a turn. A spring law that is a table or a polynomial in s has a potential. With
    any other formula the element has none, and energy.total is not conserved.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), sec. 6.2 (RSDA).
    """

    def at_initial_pose(self, model: ModelData) -> Self:
        """Return the same spring, which is wound by the turns between the described angles."""
        return self

    def at_current_pose(self, model: ModelData) -> Self:
        """Return the spring within half a turn."""
        return super().at_initial_pose(model)

    @staticmethod
    def angle(e: Symbolic) -> Expr:
        return e.i.angle - e.j.angle
