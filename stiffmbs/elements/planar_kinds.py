"""Kinds of planar joints and forces, shipped and of users."""

from __future__ import annotations

from typing import Any

from . import forces, joints
from .element import Force, Joint
from .kinds import Kinds, any_of

JOINTS = Kinds(joints, Joint, 2)
FORCES = Kinds(forces, Force, 2)

AnyJoint: Any = any_of(JOINTS)
AnyForce: Any = any_of(FORCES)
