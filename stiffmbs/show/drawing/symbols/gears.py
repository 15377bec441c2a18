"""Gears and racks by their pitch lines, planar and spatial."""

from __future__ import annotations

import numpy as np

from .. import solids
from ..draft import Draft, Site
from ..scene_graph import Line


def gear(d: Draft) -> None:
    """Pitch circles, each with a stroke that rotates."""
    one, two = d.joint_site("joint_1"), d.joint_site("joint_2")
    if one is None or two is None:
        return
    apart = float(np.linalg.norm(one.in_ground - two.in_ground))
    ratio = d.element.ratio
    first = apart / abs(1 + ratio) if abs(1 + ratio) > 1e-9 else apart / 2
    for site, radius in ((one, first), (two, abs(ratio) * first)):
        _wheel(d, site, radius)


def _wheel(d: Draft, site: Site, radius: float) -> None:
    mark = np.array([[0.75 * radius, 0, 0], [radius, 0, 0]])
    d.put(site.at((0, 0, d.front)), "joint", Line(solids.circle(radius, corners=48), 1.3, dashed=True), Line(mark, 1.3))


def rack_and_pinion(d: Draft) -> None:
    """Pitch circle of the pinion, and the rack."""
    pinion, rack = d.joint_site("pinion"), d.joint_site("rack")
    if pinion is not None:
        _wheel(d, pinion, abs(d.element.pitch_radius))
    if rack is not None:
        ends = np.zeros((2, 3))
        ends[:, 0 if d.front else 2] = -0.3 * d.size, 0.3 * d.size  # along the axis of the prismatic joint
        d.put(rack.at((0, 0, d.front)), "joint", Line(ends, 1.5, dashed=True))
