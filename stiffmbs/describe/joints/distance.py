"""Distance joint: a rigid rod without mass."""

from __future__ import annotations

from typing import ClassVar

from ..marker import Marker
from .rod import Rod


class Distance(Rod[Marker]):
    """Rod: a point of body i and a point of body j keep their distance, (d . d - L^2)/(2 L) = 0.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), eq. 3.3.7, divided by 2 L: the multiplier
    is then the tension of the rod in N, and the equation stays smooth at every distance.  For a distance of zero the
    points coincide: that is a revolute joint.

    The reaction is a force along the rod, from point to point.
    """

    kind: ClassVar[str] = "distance"
    elastic: ClassVar[str] = "spring_damper"
    reflected: ClassVar[dict[str, str] | None] = {}
