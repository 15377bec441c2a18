"""Friction in a joint, pressed by the joint's own reaction: what its kinds in the plane and in space share."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, ClassVar

from pydantic import Field

from ..element import Joint, JointReference, Symbolic
from ..units import si
from .friction import Friction


class RubbingJoint(Friction):
    """Base of the frictions in joints of the plane and of space (it has no kind: scenes name its subclasses).

    The multipliers that the pressure is made of are those of the same instant, friction included.

    Attributes
    ----------
    rubbing, round : tuples of str
        The kinds of joints that it is for, and those of them whose surfaces have a radius.
    """

    rubbing: ClassVar[tuple[str, ...]] = ()
    round: ClassVar[tuple[str, ...]] = ()

    joint: JointReference = Field(description="the joint")
    friction: si.NumberOrZero = Field(description="mu_d, coefficient of friction when sliding fast")
    radius: si.LengthOrZero = Field(0.0, description="R of a pin or ball, m")
    length: si.PositiveLength | None = Field(None, description="of a guide or bearing, for its moment, m")

    def refused(self, joints: Mapping[str, Joint]) -> Iterator[tuple[str, str]]:
        kind, known = joints[self.joint.joint].kind, self.rubbing
        if kind not in known:
            expected = f"{', '.join(known[:-1])} or {known[-1]}"
            yield "joint", f"found '{self.joint}', which is of type {kind}, expected a {expected} joint"
        if kind in self.round and self.radius == 0:
            part = "ball" if kind == "spherical" else "pin"
            yield "radius", f"found none for the {kind} joint '{self.joint}', expected the radius of its {part}"

    @staticmethod
    def point(e: Symbolic) -> Any:
        return e.joint.i.point
