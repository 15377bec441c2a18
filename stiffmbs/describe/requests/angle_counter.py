"""A counter of an angle's whole turns, for requests."""

from __future__ import annotations

from typing import ClassVar

from ..element import Element
from ..formula.field import OfPosition


class AngleCounter(Element):
    """Has the integration count the turns of an angle in space, ``az(i, j)``, that a request asks for; made by the model."""

    kind: ClassVar[str] = ""

    angle: OfPosition
