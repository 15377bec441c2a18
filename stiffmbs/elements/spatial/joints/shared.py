"""Joints common to the plane and space, with equations of distances, joint coordinates, or formulas."""

from ...joints.constraint_equation import ConstraintEquation
from ...joints.coupler import Coupler
from ...joints.distance import Rod
from ...joints.drive import Drive
from ...joints.gear import Gear
from ...joints.rack_and_pinion import RackAndPinion
from ...joints.velocity_equation import VelocityEquation
from ..marker import Marker

__all__ = ["ConstraintEquation", "Coupler", "Distance", "Drive", "Gear", "RackAndPinion", "VelocityEquation"]


class Distance(Rod[Marker]):
    """Rod with constant distance between a point of body i and a point of body j, (d . d - L^2)/(2 L) = 0.

    Both ends are free to rotate (spherical - spherical). The reaction is a force along the rod; the multiplier is its
    tension.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), section 9.4 (distance constraint).
    """

    elastic = "spring_damper"
