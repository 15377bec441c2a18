"""Spring-damper between two points."""

from __future__ import annotations

from typing import ClassVar

from ..marker import Marker
from .line_spring import LineSpring


class SpringDamper(LineSpring[Marker]):
    """Line spring and damper, linear or by curves, along the line between two points.

    With the deflection s = L - L0 and its rate v = L' the tension is
    k s + spring_law(s) + c v + damper_law(v) + preload; tension pulls the points together.

    A damping below zero is allowed (it feeds energy in); the points must not coincide while the spring has a
    free length.  A spring law that is a table or a polynomial in s has a potential; with any other formula the
    element counts none, and energy.total is not kept.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), sec. 6.2 (TSDA).
    """

    kind: ClassVar[str] = "spring_damper"
    reflected: ClassVar[dict[str, str] | None] = {}
