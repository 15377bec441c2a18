"""Distance joint in space: a rigid rod without mass."""

from __future__ import annotations

from typing import ClassVar

from ...joints.rod import Rod
from ..marker import Marker


class Distance(Rod[Marker]):
    """Rod: a point of body i and a point of body j keep their distance, (d . d - L^2)/(2 L) = 0.

    It turns freely about both of its ends (spherical - spherical).  The reaction is a force along the rod; the
    multiplier is its tension.

    Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), section 9.4 (distance constraint).
    """

    kind: ClassVar[str] = "distance"
    elastic: ClassVar[str] = "spring_damper"
    reflected: ClassVar[dict[str, str] | None] = {}
