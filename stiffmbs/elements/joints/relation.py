"""Base of gears, racks and couplers: a linear equation between two joint coordinates."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Self, cast

from ...reading.joint_name import COORDINATES, JointName
from ...reading.units import si
from ..element import Element, Expr, Joint, Symbolic
from ..initial_pose import initial_element

if TYPE_CHECKING:
    from ...model.model_data import ModelData


class OffsetConstraint(Joint):
    """Base of the joints with an `offset` in their single equation; scenes use its subclasses.

    The default `offset` is the value for which the equation holds in the described poses, so assembly does not move the
    bodies.
    """

    same_in_each_pose = True

    offset: si.Anything | None = None

    @staticmethod
    def relation(e: Symbolic) -> Expr:
        """Return the residual of the equation, including the offset."""
        raise NotImplementedError

    @classmethod
    def position(cls, e: Symbolic) -> list[Expr]:
        return [cls.relation(e)]

    def at_initial_pose(self, model: ModelData) -> Self:
        """Return the relation for the described poses of the bodies, at the start of a run."""
        if self.offset is not None:
            return self
        without = self.model_copy(update={"offset": 0.0})
        at_start = self.relation(initial_element(without, model, model.known_own_angle(self)))
        return self.model_copy(update={"offset": float(at_start)})


class Relation(OffsetConstraint):
    """Base of the joints that relate two joint coordinates; scenes use its subclasses."""

    # required coordinate, ``angle`` or ``displacement``, of a field, if not every coordinate is possible
    wanted: ClassVar[Mapping[str, str]] = {}
    carried: ClassVar[bool] = False  # whether both joints must have the same body, the carrier, as their marker j

    def validation_errors(self, joints: Mapping[str, Joint]) -> Iterator[tuple[str, str]]:
        """Yield joints without the required coordinate, repeated coordinates, and joints without a common carrier."""
        yield from unfit_joints(self, joints, self.wanted)
        (_, first), (field, second) = self.parts(JointName)
        one, two = (cast(Any, joints[name.joint]) for name in (first, second))
        if one is two and first.coordinate_of(one) == second.coordinate_of(two):
            yield field, f"found '{second}' a second time, expected two different joints"
        if self.carried and one.j.body != two.j.body:
            yield (
                field,
                f"found marker j of '{second}' on '{two.j.body}' and that of '{first}' on '{one.j.body}', expected both "
                "on the carrier, the body in which both turn or slide",
            )


def unfit_joints(
    element: Element, joints: Mapping[str, Joint], wanted: Mapping[str, str] | None = None
) -> Iterator[tuple[str, str]]:
    """Yield the fields whose joint lacks a coordinate, or has another one than `wanted`, with the reason.

    `element`: with fields that name joints. `joints`: joints of the model. `wanted`: ``angle`` or ``displacement`` by
    field.
    """
    for field, name in element.parts(JointName):
        joint, sort = joints[name.joint], (wanted or {}).get(field)
        found, meant = f"found '{name}' of the type {joint.kind}, expected", name.coordinate_of(joint)
        if joint.coordinates and meant is None:
            yield field, f"{found} {' or '.join(f'{name.joint}.{own}' for own in joint.coordinates)}"
        elif meant not in COORDINATES or sort not in (None, meant):
            yield field, f"{found} {SORTS[sort]}"


SORTS = {
    None: "a joint with a coordinate, such as a revolute or prismatic one",
    "angle": "a revolute joint, or another one's angle",
    "displacement": "a prismatic joint, or another one's displacement",
}
"""Joints with a coordinate, or with a certain one, for messages."""
