"""Forces that are the same in space as in the plane: along the line between two points."""

from __future__ import annotations

from ...forces.line_force import ForceAlongLine
from ...forces.spring_damper import LineSpring
from ..marker import Marker


class LineForce(ForceAlongLine[Marker]):
    """A force between two points of space along the line through them: constant, or a formula of anything measured.

    Above zero it pushes the points apart, as Adams' translational SFORCE does.  A constant force has a potential,
    others have none.
    """


class SpringDamper(LineSpring[Marker]):
    """Line spring and damper, linear or by curves, along the line between two points of space.

    Its fields and its law are those of the plane's spring-damper: the tension
    k s + spring_law(s) + c v + damper_law(v) + preload at a deflection s = L - L0 and its rate v = L'.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), sec. 11.2 (TSDA).
    """
