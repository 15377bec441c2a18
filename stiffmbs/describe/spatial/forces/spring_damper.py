"""Spring-damper between two points in space."""

from __future__ import annotations

from typing import ClassVar

from ...forces.line_spring import LineSpring
from ..marker import Marker


class SpringDamper(LineSpring[Marker]):
    """Line spring and damper, linear or by curves, along the line between two points of space.

    Its fields and its law are those of the plane's spring-damper: the tension
    k s + spring_law(s) + c v + damper_law(v) + preload at a deflection s = L - L0 and its rate v = L'.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), sec. 11.2 (TSDA).
    """

    kind: ClassVar[str] = "spring_damper"
    reflected: ClassVar[dict[str, str] | None] = {}
