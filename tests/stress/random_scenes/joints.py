"""Random joints between two bodies, consistent with their poses."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np
from scipy.interpolate import CubicSpline

from .draft import Content, Coordinate, Draft, Unfit, about_x, about_z

EQUATIONS: Mapping[int, Mapping[str, int]] = MappingProxyType(
    {
        2: {"revolute": 2, "prismatic": 2, "fixed": 3, "point_on_line": 1, "distance": 1, "point_on_curve": 1},
        3: {
            "revolute": 5, "prismatic": 5, "cylindrical": 4, "spherical": 3, "universal": 4, "fixed": 6, "planar": 3, "parallel": 2,
            "perpendicular": 1, "orientation": 3, "point_on_line": 2, "point_on_plane": 1, "point_on_curve": 2, "tangent_to_curve": 3,
            "distance": 1, "revolute_spherical": 2, "constant_velocity": 4, "screw": 5, "thread": 5,
        },
    }
)  # fmt: skip
"""Number of equations of each kind; a thread includes its cylindrical joint."""
COORDINATES: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "revolute": ("angle",), "prismatic": ("displacement",), "point_on_line": ("displacement",), "cylindrical": ("displacement", "angle"),
        "screw": ("angle",),
    }
)  # fmt: skip
HALF_PITCH = 0.05
"""Largest advance of a screw per radian, m."""


def add_joint(draft: Draft, kind: str, i: str, j: str) -> str:
    """Add a joint of a kind between two bodies and return its name.

    Raises
    ------
    Unfit
        When too few degrees of freedom are left.
    """
    equations = EQUATIONS[draft.dimensions][kind]
    if draft.freedoms <= equations:
        raise Unfit
    at, axes = draft.near(i), draft.axes()
    own, there, theirs, fields = at, at, axes, Content()
    turned = axes
    match kind:
        case "prismatic" | "cylindrical" | "point_on_line":
            there = at + draft.uniform(-0.3, 0.3) * draft.slide(axes)
        case "planar" | "point_on_plane":
            there = at + axes[:, :2] @ draft.vector(0.3, 2)
        case "parallel" | "orientation" | "perpendicular":
            there = draft.near(j)
        case "distance":
            there = draft.near(j, 0.5)
            fields["length"] = float(np.linalg.norm(there - at))
        case "revolute_spherical":
            way = axes[:, :2] @ draft.vector(0.6, 2)
            there = at + way
            fields["length"] = float(np.linalg.norm(way))
        case "point_on_curve" | "tangent_to_curve":
            fields, offset, tangent = _curve(draft, kind)
            there = at - axes @ offset
            turned = axes @ tangent
        case "constant_velocity":
            turned = axes @ about_x(draft.uniform(-0.5, 0.5))
        case "screw" | "thread":
            fields["pitch"] = draft.choice([-1, 1]) * draft.uniform(0.3, 1) * 2 * np.pi * HALF_PITCH
            there = at + draft.uniform(-0.3, 0.3) * axes[:, 2]
    if kind in ("universal", "perpendicular"):
        turned = axes @ about_x(np.pi / 2)
    markers = {"i": draft.marker(i, own, turned), "j": draft.marker(j, there, theirs)}
    draft.freedoms -= equations
    if kind == "thread":
        draft.add("joints", "sleeve", type="cylindrical", **markers)
    name = draft.add("joints", kind, type=kind, **markers, **fields)
    draft.coordinates += [
        Coordinate(name if len(COORDINATES[kind]) == 1 and kind != "screw" else f"{name}.{sort}", sort, i, j)
        for sort in COORDINATES.get(kind, ())
    ]
    return name


def _curve(draft: Draft, kind: str) -> tuple[Content, np.ndarray, np.ndarray]:
    """Return the fields of a curve, a point on it in its axes, and axes with x along the tangent there."""
    sort = draft.choice(["slot", "table", "cam"])
    if sort == "cam":
        radius, part = draft.uniform(0.5, 1), draft.uniform(-0.1, 0.1)
        fields: Content = {"radius": f"{radius!r} + {part!r}*cos(2*angle)"}
        return fields, np.array([radius + part, 0.0, 0.0]), about_z(np.pi / 2)
    if sort == "table":
        heights = [draft.uniform(-0.1, 0.1) for _ in range(6)]
        points = [[-2.0 + 0.8 * k, height] for k, height in enumerate(heights)]
        fields = {"y": {"table": points, "ends": "natural"}}
        x = draft.uniform(-1, 1)
        curve = CubicSpline(*np.transpose(points), bc_type="natural")
        return fields, np.array([x, float(curve(x)), 0.0]), about_z(float(np.arctan(curve(x, 1))))
    a, b, x = draft.uniform(0.05, 0.2), draft.uniform(0.5, 2), draft.uniform(-0.5, 0.5)
    slope = a * b * np.cos(b * x)
    fields = {"y": f"{a!r}*sin({b!r}*x)"}
    if draft.in_space and kind == "point_on_curve" and draft.chance(0.3):
        c = draft.uniform(-0.2, 0.2)
        return {**fields, "z": f"{c!r}*x^2"}, np.array([x, a * np.sin(b * x), c * x * x]), np.eye(3)
    return fields, np.array([x, a * np.sin(b * x), 0.0]), about_z(float(np.arctan(slope)))
