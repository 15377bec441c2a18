"""Check of the coordinates of joints that an element refers to."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from ...reading.joint_name import COORDINATES, JointName
from ..element import Element, Joint


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
