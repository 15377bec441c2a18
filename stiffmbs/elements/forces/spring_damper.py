"""Planar spring-damper between two points."""

from ...reading.marker import Marker
from .springs import LineSpring


class SpringDamper(LineSpring[Marker]):
    """Spring and damper along the line between two points, linear or nonlinear.

    With the deflection s = L - L0 and its rate v = L' the tension is k s + spring_law(s) + c v + damper_law(v) +
    preload; tension pulls the points together.

    Negative damping is allowed; it adds energy, which a note reports. The points must not coincide if the spring has a free length. A spring
    law that is a table or a polynomial in s has a potential. With any other formula the element has none, and
    energy.total is not conserved.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), sec. 6.2 (TSDA).
    """
