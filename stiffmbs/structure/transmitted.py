"""What joints in space transmit."""

from __future__ import annotations

COMPONENTS = ("fx", "fy", "fz", "tx", "ty", "tz")
TRANSMITTED: dict[str, tuple[str, ...]] = {
    "fixed": COMPONENTS,
    "revolute": ("fx", "fy", "fz", "tx", "ty"),
    "prismatic": ("fx", "fy", "tx", "ty", "tz"),
    "cylindrical": ("fx", "fy", "tx", "ty"),
    "spherical": ("fx", "fy", "fz"),
    "universal": ("fx", "fy", "fz"),
    "planar": ("fz", "tx", "ty"),
    "point_on_line": ("fx", "fy"),
    "point_on_plane": ("fz",),
    "orientation": ("tx", "ty", "tz"),
    "parallel": ("tx", "ty"),
}
"""By kind: forces along the axes of marker j, and torques about them at the point of marker i.  What does not lie along one
of them, as the torque of a universal joint, is left out."""
