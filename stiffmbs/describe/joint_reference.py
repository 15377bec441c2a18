"""Whether a joint is of the sort that an element refers to."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from .element import Element, Joint, JointName


def unfit_joints(
    element: Element, joints: Mapping[str, Joint], wanted: Mapping[str, type[Joint]] | None = None
) -> Iterator[tuple[str, str]]:
    """The fields whose joint has no coordinate, or is not of the kind that `wanted` names for the field; and why.

    Parameters
    ----------
    element : Element
        With fields that name joints.
    joints : mapping of str to Joint
        The model's joints.
    wanted : mapping of str to type, optional
        The class of joint by field.
    """
    for field, name in element.parts(JointName):
        joint, base = joints[name], (wanted or {}).get(field)
        if base is not None and not isinstance(joint, base):
            yield field, f"found '{name}' of the type {joint.kind}, expected a {base.kind} joint"
        elif type(joint).coordinate is Joint.coordinate:
            yield (
                field,
                f"found '{name}' of the type {joint.kind}, expected a joint with a coordinate (revolute, prismatic or "
                "point_on_line)",
            )
