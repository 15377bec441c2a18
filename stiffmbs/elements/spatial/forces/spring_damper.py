"""Spatial spring-damper between two points."""

from ...forces.springs import LineSpring
from ..marker import Marker


class SpringDamper(LineSpring[Marker]):
    """Spring and damper along the line between two points in space, linear or nonlinear.

    Fields and law are those of the planar spring-damper. The tension is k s + spring_law(s) + c v + damper_law(v) +
    preload at a deflection s = L - L0 and its rate v = L'.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), sec. 11.2 (TSDA).
    """
