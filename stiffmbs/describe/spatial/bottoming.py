"""Contact of a wheel's rim with the road at large tyre deflections.

The rim is a cylinder of the tyre's width W. With the penetration d at mid-width and the camber gamma, the penetration
across the width is d + y tan(gamma). The force is that of a curve at the mean penetration. It acts at the centre of the
penetrated area. MSC Adams/Tire, PAC2002, wheel bottoming.
"""

from __future__ import annotations

from typing import Any

from ..element import Symbolic
from ..roads.road import above_zero, magnitude

NO_WIDTH = "1e-30"
"""Offset of divisors that contain half the difference of penetrations, m."""


def bottomed(e: Symbolic, rim: Any, depth: Any, camber: Any) -> tuple[Any, Any]:
    """Return the force of the rim (N) and its torque about the longitudinal axis (N m).

    Parameters
    ----------
    e : SymbolicElement
    rim : Bottoming
    depth : Expr
        Penetration of the rim at mid-width, m; negative without contact.
    camber : Expr
        Camber, rad; positive if the top leans to the right.
    """
    from sympy import Float, Piecewise, tan

    slope = e.named(tan(camber))
    half = e.named(rim.width / 2 * magnitude(slope))
    edge = e.named(above_zero(e.named(depth + half)))
    whole = depth > half
    mean = e.read(Piecewise((depth, whole), (edge**2 / (4 * half + Float(NO_WIDTH)), True)))
    part = edge / (2 * half + Float(NO_WIDTH))  # of the width that is in contact
    of_whole = rim.width**2 * magnitude(slope) / (12 * magnitude(depth) + Float(NO_WIDTH))
    offset = e.read(Piecewise((of_whole, whole), (rim.width * (3 - 2 * part) / 6, True)))
    mean, offset = e.named(mean), e.named(offset)
    force = e.named(e.read(Piecewise((rim.load(mean), mean > 0), (0, True))))
    return force, -force * offset * slope / (magnitude(slope) + Float(NO_WIDTH))
