"""Joints that are the same in space as in the plane: their equations are of joint coordinates, or of formulas, alone."""

from __future__ import annotations

from ...joints.constraint_equation import ConstraintEquation
from ...joints.coupler import Coupler
from ...joints.drive import Drive
from ...joints.gear import Gear
from ...joints.rack_and_pinion import RackAndPinion
from ...joints.velocity_equation import VelocityEquation

__all__ = ["ConstraintEquation", "Coupler", "Drive", "Gear", "RackAndPinion", "VelocityEquation"]
