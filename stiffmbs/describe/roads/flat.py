"""Level road."""

from __future__ import annotations

from typing import Any, ClassVar

from pydantic import Field

from ..element import Symbolic
from ..units import si
from .road import Road


class FlatRoad(Road):
    """Level road."""

    kind: ClassVar[str] = "flat"
    level: ClassVar[bool] = True

    z: si.Length = Field(0.0, description="its height, m")

    @staticmethod
    def height(r: Symbolic, x: Any, y: Any) -> Any:
        return r.z
