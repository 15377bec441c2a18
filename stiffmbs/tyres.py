"""Tyre properties, and the base class of user-defined tyres.

Examples
--------
>>> from stiffmbs.tyres import TyreProperties
>>> tyre = TyreProperties.from_file("front.tir")
>>> tyre.wrench(load=4000, slip_angle=0.05)["lateral"]
"""

from .elements.roads.envelope import Envelope
from .elements.spatial.relaxation import DEFLECTIONS
from .elements.spatial.tyre import Rolling, Tyre
from .elements.tyres.coefficients import TyreProperties

__all__ = ["DEFLECTIONS", "Envelope", "Rolling", "Tyre", "TyreProperties"]
