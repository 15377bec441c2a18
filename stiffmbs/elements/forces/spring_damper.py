"""Spring-damper between two points, in the plane and in space."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Generic

from pydantic import Field

from ...reading.formula.field import ForceOfDeflection, ForceOfRate
from ...reading.marker import M, Marker
from ...reading.units import si
from ..element import Expr, Force, Symbolic

if TYPE_CHECKING:
    from ..initial_pose import InitialPose


class Spring(Force):
    """Base of springs with dampers; scenes use its subclasses.

    At a deflection s and its rate v the restoring force is k s + spring_law(s) + c v + damper_law(v) + preload. A
    subclass has these numbers and laws as its fields, in the units of its deflection.
    """

    @classmethod
    def condensed_powers(cls, e: Symbolic) -> list[tuple[Expr, Expr]]:
        return cls.powers(e)

    @staticmethod
    def pull(e: Symbolic, s: Expr, v: Expr) -> Expr:
        """Return the restoring force or moment."""
        linear = e.stiffness * s + e.damping * v + e.preload
        laws = [law(x) for law, x in ((e.spring_law, s), (e.damper_law, v)) if law is not None]
        return sum(laws, linear)

    @staticmethod
    def stored(e: Symbolic, s: Expr, way: Expr) -> Expr:
        """Return the potential energy, J, zero without a closed form; the preload's is zero at `way` = 0."""
        of_law = e.integral(e.spring_law, s) if e.spring_law is not None else 0
        return e.stiffness * s**2 / 2 + e.preload * way + of_law if of_law is not None else 0


class LineSpring(Spring, Generic[M]):
    """Base of the planar and the spatial spring-damper."""

    kind = "spring_damper"
    reflected = {}
    symmetric_with = {"i": "point", "j": "point"}
    forms = (
        {"stiffness": ..., "damping": ..., "free_length": ...},
        {"spring_law": {"table": [[0, 0], [1, 1]]}, "damping": ...},
    )

    i: M = Field(description="marker of the first body, on which the force is reported")
    j: M = Field(description="marker of the second body")
    stiffness: si.Stiffness = Field(0.0, description="k, N/m")
    damping: si.Damping = Field(0.0, description="c, N s/m")
    free_length: si.LengthOrZero = Field(0.0, description="L0, the length without tension of the spring, m")
    preload: si.Force = Field(0.0, description="constant part of the tension, N")
    spring_law: ForceOfDeflection | None = Field(None, description="tension added over s = L - L0 (m), N")
    damper_law: ForceOfRate | None = Field(None, description="tension added over v = L' (m/s), N")

    def invalid_placement(self, pose: InitialPose) -> Iterator[str]:
        """Yield an error for coincident points, between which the force has no direction."""
        if (self.free_length or self.preload) and pose.at_one_place(self.i, self.j):
            yield (
                "found both of its points in the same place, where its force has no direction, expected them apart or "
                "neither free_length nor preload"
            )

    def spins_with(self) -> dict[str, str]:
        return {"i": "point", "j": "point"}

    @staticmethod
    def efforts(e: Symbolic) -> list[tuple[Expr, Expr]]:
        length = e.distance(e.i.point, e.j.point)
        return [(-Spring.pull(e, length - e.free_length, e.rate(length)), length)]

    @staticmethod
    def potential(e: Symbolic) -> Expr:
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
