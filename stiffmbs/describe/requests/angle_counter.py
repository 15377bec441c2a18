"""A counter of an angle's whole turns, for requests."""

from __future__ import annotations

from functools import lru_cache
from typing import ClassVar

from ..element import Element
from ..formula.field import OfPosition
from ..parts.names import Names

COUNTERS = 256
"""Counters that are kept: a run asks for those of its model several times."""


class AngleCounter(Element):
    """Has the integration count the turns of an angle in space, ``az(i, j)``, that a request asks for; made by the model."""

    kind: ClassVar[str] = ""

    counted: OfPosition


@lru_cache(maxsize=COUNTERS)
def counter_of(angle: str, bodies: frozenset[str]) -> AngleCounter:
    """The counter of an angle between markers of these bodies, by the angle's text."""
    return AngleCounter.model_validate({"counted": angle}, context={"names": Names(bodies)})
