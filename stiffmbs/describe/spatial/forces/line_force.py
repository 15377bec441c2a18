"""A force by formula along the line between two points of space."""

from __future__ import annotations

from typing import ClassVar

from ...forces.line_force import ForceAlongLine
from ..marker import Marker


class LineForce(ForceAlongLine[Marker]):
    """A force between two points of space along the line through them: constant, or a formula of anything measured.

    Above zero it pushes the points apart, as Adams' translational SFORCE does.  A constant force has a potential,
    others have none.
    """

    kind: ClassVar[str] = "line_force"
    reflected: ClassVar[dict[str, str] | None] = {}
