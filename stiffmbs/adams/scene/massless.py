"""Parts without mass, which Adams allows if joints make their mass irrelevant."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from ...describe.spatial.massless import MASSLESS
from ..statements.bodies import Part


def lightest(parts: Iterable[Part]) -> float:
    """Return the smallest non-zero mass of the parts; zero if none has mass."""
    return min((part.mass for part in parts if part.mass > 0), default=0.0)


def weighed(part: Part, least: float) -> Part:
    """Return the part, with a small mass if it has none."""
    return part if part.ground or part.mass != 0 else replace(part, mass=MASSLESS * least)
