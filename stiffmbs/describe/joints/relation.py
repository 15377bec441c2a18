"""Base of gears, racks and couplers: a linear equation between two joint coordinates."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, ClassVar

from ..element import Joint
from ..joint_name import JointName
from ..joint_reference import unfit_joints
from .offset_constraint import OffsetConstraint


class Relation(OffsetConstraint):
    """Base of the joints that relate two joint coordinates; scenes use its subclasses.

    Attributes
    ----------
    wanted : mapping of str to str
        Required coordinate, ``angle`` or ``displacement``, of a field, if not every coordinate is possible.
    carried : bool
        Whether both joints must have the same body, the carrier, as their marker j.
    """

    wanted: ClassVar[Mapping[str, str]] = {}
    carried: ClassVar[bool] = False

    def validation_errors(self, joints: Mapping[str, Joint]) -> Iterator[tuple[str, str]]:
        """Yield joints without the required coordinate, repeated coordinates, and joints without a common carrier."""
        yield from unfit_joints(self, joints, self.wanted)
        (_, first), (field, second) = self.parts(JointName)
        if (
            first.joint == second.joint
            and len({name.coordinate_of(joints[name.joint]) for name in (first, second)}) == 1
        ):
            yield field, f"found '{second}' a second time, expected two different joints"
        if self.carried:
            yield from self._on_two_carriers(field, first, second, joints)

    @staticmethod
    def _on_two_carriers(
        field: str, first: JointName, second: JointName, joints: Mapping[str, Any]
    ) -> Iterator[tuple[str, str]]:
        carrier, other = joints[first.joint].j.body, joints[second.joint].j.body
        if carrier != other:
            yield (
                field,
                f"found marker j of '{second}' on '{other}' and that of '{first}' on '{carrier}', expected both "
                "on the carrier, the body in which both turn or slide",
            )

    def in_space(self, angles: Any) -> dict[str, Any]:
        from ..spatial.embedding.joints import relation

        return relation(self, angles)
