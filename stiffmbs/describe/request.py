"""Requests: quantities to report, by formula."""

from __future__ import annotations

from typing import Any, ClassVar

from .element import Element, Symbolic
from .formula.field import OfMotion


class Request(Element):
    """A channel of its own, of coordinates, velocities, measures and time (Adams: REQUEST); made by the model."""

    kind: ClassVar[str] = ""

    formula: OfMotion

    @staticmethod
    def value(e: Symbolic) -> Any:
        """What is reported."""
        return e.formula
