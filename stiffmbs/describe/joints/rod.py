"""The rod between two points, in the plane and in space alike."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Generic, TypeVar

from pydantic import Field

from ..element import Joint, Symbolic
from ..fields import Measured
from ..marker import MarkerReference

M = TypeVar("M", bound=MarkerReference)


class Rod(Joint, Generic[M]):
    """Base of the rods of the plane and of space (it has no kind: scenes name its subclasses)."""

    equations: ClassVar[tuple[str, ...]] = ("length",)

    i: M = Field(description="marker of the first body, on which the reaction is reported")
    j: M = Field(description="marker of the second body")
    length: Annotated[float, Measured("length", above=0)] = Field(description="L, from point to point, m")

    @staticmethod
    def position(e: Symbolic) -> Any:
        d = e.i.point - e.j.point
        return [(d.dot(d) - e.length**2) / (2 * e.length)]
