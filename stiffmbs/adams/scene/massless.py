"""Parts without mass, which Adams takes where joints leave them nothing to do with it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from ...describe.spatial.massless import MASSLESS
from ..statements.bodies import Part


def lightest(parts: Iterable[Part]) -> float:
    """The least mass of any part that has one; zero where none has."""
    return min((part.mass for part in parts if part.mass > 0), default=0.0)


def weighed(part: Part, least: float) -> Part:
    """The part as it is, or with a slight mass if it has none."""
    return part if part.ground or part.mass != 0 else replace(part, mass=MASSLESS * least)
