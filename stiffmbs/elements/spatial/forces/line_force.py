"""Spatial force along the line between two points."""

from ...forces.line_force import ForceAlongLine
from ..marker import Marker


class LineForce(ForceAlongLine[Marker]):
    """Force along the line between two points in space: constant, or a formula of any measured quantity.

    A positive force pushes the points apart, as in Adams' translational SFORCE. A constant force has a potential, other
    forces have none.
    """
