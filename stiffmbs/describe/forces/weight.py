"""Weight: gravity on a body."""

from __future__ import annotations

from typing import Any, ClassVar

from .. import si
from ..element import Force, Symbolic
from ..marker import Marker


class Weight(Force):
    """The model's gravity on one body; made by the model, not written in scenes (hence without a kind)."""

    kind: ClassVar[str] = ""

    i: Marker
    mass: si.Mass
    gravity: tuple[si.Acceleration, si.Acceleration]

    @staticmethod
    def efforts(e: Symbolic) -> list[tuple[Any, Any]]:
        return [(e.mass * e.gravity[0], e.i.point[0]), (e.mass * e.gravity[1], e.i.point[1])]

    @staticmethod
    def potential(e: Symbolic) -> Any:
        return -e.mass * (e.gravity[0] * e.i.point[0] + e.gravity[1] * e.i.point[1])
