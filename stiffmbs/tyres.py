"""Tyre properties, and the base class of user-defined tyres.

Examples
--------
>>> from stiffmbs.tyres import TyreProperties
>>> tyre = TyreProperties.from_file("front.tir")
>>> tyre.wrench(load=4000, slip_angle=0.05)["lateral"]
"""

from .describe.spatial.relaxation import DEFLECTIONS
from .describe.spatial.tyre import Rolling, Tyre
from .describe.tyres.coefficients import TyreProperties

__all__ = ["DEFLECTIONS", "Rolling", "Tyre", "TyreProperties"]
