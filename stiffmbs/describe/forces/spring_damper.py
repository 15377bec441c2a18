"""Spring-damper between two points, in the plane and in space."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Generic, TypeVar

from pydantic import Field

from ..element import Symbolic
from ..formula.field import ForceOfDeflection, ForceOfRate
from ..marker import Marker, MarkerReference
from ..units import si
from .spring import Spring

if TYPE_CHECKING:
    from ..initial_pose import InitialPose

M = TypeVar("M", bound=MarkerReference)


class LineSpring(Spring, Generic[M]):
    """Base of the planar and the spatial spring-damper."""

    kind: ClassVar[str] = "spring_damper"
    reflected: ClassVar[dict[str, str] | None] = {}
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

    def invalid_placement(self, pose: InitialPose) -> Iterator[str]:
        """Yield an error for coincident points, between which the force has no direction."""
        if (self.free_length or self.preload) and pose.at_one_place(self.i, self.j):
            yield (
                "found both of its points at one place, where its force has no direction, expected them apart or "
                "neither free_length nor preload"
            )

    def spins_with(self) -> dict[str, str]:
        return {"i": "point", "j": "point"}

    @staticmethod
    def efforts(e: Symbolic) -> list[tuple[Any, Any]]:
        length = e.distance(e.i.point, e.j.point)
        return [(-Spring.pull(e, length - e.free_length, e.rate(length)), length)]

    @staticmethod
    def potential(e: Symbolic) -> Any:
        length = e.distance(e.i.point, e.j.point)
        return Spring.stored(e, length - e.free_length, length)


class SpringDamper(LineSpring[Marker]):
    """Spring and damper along the line between two points, linear or nonlinear.

    With the deflection s = L - L0 and its rate v = L' the tension is k s + spring_law(s) + c v + damper_law(v) +
    preload; tension pulls the points together.

    Negative damping is allowed; it adds energy. The points must not coincide if the spring has a free length. A spring
    law that is a table or a polynomial in s has a potential. With any other formula the element has none, and
    energy.total is not conserved.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), sec. 6.2 (TSDA).
    """
