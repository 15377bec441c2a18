"""The spring-damper between two points, in the plane and in space alike."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Generic, TypeVar

from pydantic import Field

from ..element import Symbolic
from ..formula.field import ForceOfDeflection, ForceOfRate
from ..marker import MarkerReference
from ..units import si
from .spring import Spring

if TYPE_CHECKING:
    from ..model_data import ModelData

M = TypeVar("M", bound=MarkerReference)


class LineSpring(Spring, Generic[M]):
    """Base of the spring-dampers of the plane and of space (it has no kind: scenes name its subclasses)."""

    forms: ClassVar[tuple[Mapping[str, Any], ...]] = (
        {"stiffness": 1, "damping": 1, "free_length": 1},
        {"spring_law": {"table": [[-1, -1], [0, 0], [1, 1]]}, "damping": 1},
    )

    i: M = Field(description="marker of the first body, on which the force is reported")
    j: M = Field(description="marker of the second body")
    stiffness: si.Stiffness = Field(0.0, description="k, N/m")
    damping: si.Damping = Field(0.0, description="c, N s/m")
    free_length: si.LengthOrZero = Field(0.0, description="L0, the length without tension of the spring, m")
    preload: si.Force = Field(0.0, description="tension added at every length, N")
    spring_law: ForceOfDeflection | None = Field(None, description="tension added over s = L - L0 (m), N")
    damper_law: ForceOfRate | None = Field(None, description="tension added over v = L' (m/s), N")

    def invalid_placement(self, model: ModelData) -> Iterator[str]:
        """Points at one place give the spring's force no direction."""
        if (self.free_length or self.preload) and model.at_one_place(self.i, self.j):
            yield (
                "found both of its points at one place, where its force has no direction, expected them apart or "
                "neither free_length nor preload"
            )

    @staticmethod
    def efforts(e: Symbolic) -> list[tuple[Any, Any]]:
        length = e.distance(e.i.point, e.j.point)
        return [(-Spring.pull(e, length - e.free_length, e.rate(length)), length)]

    @staticmethod
    def potential(e: Symbolic) -> Any:
        length = e.distance(e.i.point, e.j.point)
        return Spring.stored(e, length - e.free_length, length)
