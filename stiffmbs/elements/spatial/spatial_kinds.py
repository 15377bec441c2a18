"""Kinds of spatial joints and forces, shipped and of users."""

from __future__ import annotations

from typing import Any

from ..element import Force, Joint
from ..kinds import Kinds, any_of
from . import forces, joints

JOINTS = Kinds(joints, Joint, 3)
FORCES = Kinds(forces, Force, 3)

AnyJoint: Any = any_of(JOINTS)
AnyForce: Any = any_of(FORCES)
