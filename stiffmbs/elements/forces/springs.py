"""Bases of the springs with dampers, in the plane and in space."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Generic

from pydantic import Field

from ...reading.formula.field import ForceOfDeflection, ForceOfRate, TorqueOfDeflection, TorqueOfRate
from ...reading.marker import M
from ...reading.units import si
from ..element import Expr, Force, Symbolic
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
    def stored(e: Symbolic, s: Expr, coordinate: Expr) -> Expr:
        """Return the potential energy, J, zero without a closed form; that of the preload is zero at coordinate 0.

        `s`: deflection, m or rad. `coordinate`: length, m, or angle, rad.
        """
        of_law = e.integral(e.spring_law, s) if e.spring_law is not None else 0
        return e.stiffness * s**2 / 2 + e.preload * coordinate + of_law if of_law is not None else 0


class LineSpring(Spring, Generic[M]):
    """Base of the planar and the spatial spring-damper."""

    kind = "spring_damper"
    known_as = ("spring", "damper", "translational_spring")
    reflected = {}
    spin_conditions = {"i": "point", "j": "point"}
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

    @staticmethod
    def efforts(e: Symbolic) -> list[tuple[Expr, Expr]]:
        length = e.distance(e.i.point, e.j.point)
        return [(-Spring.pull(e, length - e.free_length, e.rate(length)), length)]

    @staticmethod
    def potential(e: Symbolic) -> Expr:
        length = e.distance(e.i.point, e.j.point)
        return Spring.stored(e, length - e.free_length, length)


class AngleSpring(Spring, Generic[M]):
    """Base of the planar and the spatial torsion spring."""

    kind = "torsion_spring"
    known_as = ("rotational_damper", "torsional_damper", "rotational_spring")
    reflected = {"free_angle": "angle", "preload": "angle", "spring_law": "angle", "damper_law": "angle"}
    forms = ({"stiffness": ..., "damping": ...},)

    i: M = Field(description="marker of the first body, on which the torque is reported")
    j: M = Field(description="marker of the second body")
    stiffness: si.TorsionalStiffness = Field(0.0, description="k, N m/rad")
    damping: si.TorsionalDamping = Field(0.0, description="c, N m s/rad")
    free_angle: si.Angle = Field(0.0, description="angle of i relative to j without moment of the spring, rad")
    preload: si.Torque = Field(0.0, description="constant part of the moment, N m")
    spring_law: TorqueOfDeflection | None = Field(
        None, description="moment added over s = angle - free_angle (rad), N m"
    )
    damper_law: TorqueOfRate | None = Field(None, description="moment added over v = angle' (rad/s), N m")

    @staticmethod
    def angle(e: Symbolic) -> Expr:
        """Return the angle of marker i relative to marker j, with full revolutions."""
        raise NotImplementedError

    @classmethod
    def efforts(cls, e: Symbolic) -> list[tuple[Expr, Expr]]:
        angle = cls.angle(e)
        return [(-Spring.pull(e, angle - e.free_angle, e.rate(angle)), angle)]

    @classmethod
    def potential(cls, e: Symbolic) -> Expr:
        angle = cls.angle(e)
        return Spring.stored(e, angle - e.free_angle, angle)
