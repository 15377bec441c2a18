"""Spatial forces along the line between two points, identical to the planar ones."""

from ...forces.line_force import ForceAlongLine
from ...forces.spring_damper import LineSpring
from ..marker import Marker


class LineForce(ForceAlongLine[Marker]):
    """Force along the line between two points in space: constant, or a formula of any measured quantity.

    A positive force pushes the points apart, as in Adams' translational SFORCE. A constant force has a potential, other
    forces have none.
    """


class SpringDamper(LineSpring[Marker]):
    """Spring and damper along the line between two points in space, linear or nonlinear.

    Fields and law are those of the planar spring-damper. The tension is k s + spring_law(s) + c v + damper_law(v) +
    preload at a deflection s = L - L0 and its rate v = L'.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), sec. 11.2 (TSDA).
    """
