"""Planar joints in space."""

from __future__ import annotations

import math
from typing import Any

from ....errors import InputError
from ...initial_pose import initial_element
from ...joint_name import JointName
from ...joints.relation import Relation
from ..branches import FARTHEST
from .angles import TURN, Angles
from .fields import oriented, same
from .markers import Written, along


def prismatic(joint: Any, angles: Angles) -> Written:
    """Return a joint along z of rotated markers, which would keep a half turn between the markers if drawn so."""
    apart = math.degrees(abs(math.remainder(angles.initial(joint.i, joint.j), TURN)))
    if apart >= FARTHEST:
        raise InputError(f"found its markers drawn {apart:.4g} degrees apart, expected less than {FARTHEST:g} in space")
    return point_on_line(joint, angles)


def point_on_line(joint: Any, angles: Angles) -> Written:
    """Return a joint along z of rotated markers."""
    return same(joint, angles, i=oriented(joint.i, angles, along), j=oriented(joint.j, angles, along))


def relation(joint: Relation, angles: Angles) -> Written:
    """Return a relation whose offset is corrected for coordinates that are measured differently in space."""
    if joint.offset is None:
        return same(joint, angles)
    data = angles.data
    e = initial_element(joint.model_copy(update={"offset": 0.0}), data)
    for field, name in joint.parts(JointName):
        coordinate = getattr(e, field)
        counted = name.coordinate_of(data.joints[name.joint]) == "angle"
        coordinate.coordinate = TURN * round(coordinate.coordinate / TURN) if counted else 0.0
    return same(joint, angles, offset=joint.offset - float(joint.relation(e)))
