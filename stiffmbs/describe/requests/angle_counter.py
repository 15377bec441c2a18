"""Counter of the full turns of an angle, for requests."""

from __future__ import annotations

from functools import lru_cache
from typing import ClassVar

from ..element import Element
from ..formula.field import OfPosition
from ..parts.names import Names

COUNTERS = 256
"""Size of the cache of counters; a run requires those of its model several times."""


class AngleCounter(Element):
    """Request for the integration to count the turns of a spatial angle, ``az(i, j)``; created by the model."""

    kind: ClassVar[str] = ""

    counted: OfPosition


@lru_cache(maxsize=COUNTERS)
def counter_of(angle: str, bodies: frozenset[str]) -> AngleCounter:
    """Return the counter of an angle between markers of these bodies, by the angle's text."""
    return AngleCounter.model_validate({"counted": angle}, context={"names": Names(bodies)})
