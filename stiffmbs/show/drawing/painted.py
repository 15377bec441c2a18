"""Projection of a drawing at an instant: polygons and lines of a plane, the farthest first."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from ...reading.marker import GROUND
from ...results.scales import ROUNDING
from .poses import FAR, Poses
from .scene_graph import (
    LOAD,
    LOAD_NOT_UNIQUE,
    Drawing,
    Line,
    Link,
    Part,
    Solid,
    edge_color,
    face_color,
    on_ramp,
    shaded,
)
from .solids import across, face_normal
from .surroundings import shadows
from .view import View

LIGHT = np.array([0.35, 0.5, 0.8])
"""Direction towards the light: to the right, up, towards the viewer."""
SYMBOLS_BEFORE = 0.03
"""Distance of symbols in front of the bodies around them, relative to the size."""
FOREMOST = 0.004
"""Distance of lines in front of faces at the same place, relative to the size."""
FLOOR_DEPTH, SHADOW = 1e3, 0.07
"""Distance of the floor below all else, relative to the size, and opacity of one shadow."""
LONGEST_ARROW = 0.22
"""Length of the longest force arrow, relative to the size."""
HEAD = 1.25
"""Length of the longest arrow head, in units of symbols."""


@dataclass(frozen=True, eq=False)
class Patch:
    """Polygon or line of the picture."""

    points: np.ndarray  # shape (n, 2)
    depth: float  # coordinate towards the viewer
    # face, edge: colors; empty for none
    face: str = ""
    edge: str = ""
    width: float = 1.0  # width of its line
    dashed: bool = False
    opacity: float = 1.0


def painted(drawing: Drawing, poses: Poses, k: int, view: View, longest: float = 0.0) -> list[Patch]:
    """Return the picture at the k-th instant. `longest`: force of the longest arrow, N; no arrows are drawn for 0."""
    found: list[Patch] = []
    for part in drawing.parts:
        found += _part(drawing, part, poses, k, view)
    found += _shadows(drawing, poses, k, view)
    for link in drawing.links:
        found += _link(drawing, link, poses, k, view)
    if longest > 0:
        found += _loads(drawing, poses, k, view, longest)
    return sorted(found, key=lambda patch: patch.depth)


def _shadows(drawing: Drawing, poses: Poses, k: int, view: View) -> Iterator[Patch]:
    """Yield faint shadows of the bodies on a level floor, over the floor and below all else."""
    for points in shadows(drawing, poses, k):
        yield Patch(view.seen(points)[:, :2], -FLOOR_DEPTH * drawing.size / 2, face="#000000", opacity=SHADOW)


def _wider(drawing: Drawing, owner: str) -> float:
    """Return the factor on the width of an element's lines."""
    return 2.2 if owner in drawing.marks else 1.0


def _part(drawing: Drawing, part: Part, poses: Poses, k: int, view: View) -> Iterator[Patch]:
    origin, axes = poses.pose(part.body, k)
    face, edge = face_color(drawing, part), edge_color(drawing, part.owner, part.role)
    wider = _wider(drawing, part.owner)
    nearer = np.zeros(3)
    nearer[2] = 0.0 if part.role == "body" or drawing.dimensions == 2 else SYMBOLS_BEFORE * drawing.size
    if part.role == "floor":
        nearer[2] = -FLOOR_DEPTH * drawing.size
    for solid in part.solids:
        seen = view.seen(origin + poses.vertices(solid, k) @ axes.T) + nearer
        colors: str | list[str] = face
        if drawing.stress > 0 and solid.stresses:
            stress = poses.stresses(solid, np.array([k]))[0] / drawing.stress
            colors = [on_ramp(float(stress[corners].mean())) for corners in solid.faces]
        yield from _solid(seen, solid, colors, (edge, wider), drawing.dimensions == 2)
    for line in part.lines:
        seen = view.seen(origin + line.points @ axes.T) + nearer
        yield from _line(seen, line, edge, wider, FOREMOST * drawing.size)


def _solid(
    seen: np.ndarray, solid: Solid, colors: str | list[str], edge: tuple[str, float], flat: bool
) -> Iterator[Patch]:
    """Yield the faces towards the viewer, in one color or in one for each face, and their edges."""
    light = LIGHT / np.linalg.norm(LIGHT)
    towards = np.zeros(len(solid.faces), dtype=bool)
    for number, corners in enumerate(solid.faces):
        points = seen[corners]
        normal = face_normal(points)
        towards[number] = not solid.closed or normal[2] > 0
        if towards[number]:
            normal = normal if normal[2] >= 0 else -normal
            color = colors if isinstance(colors, str) else colors[number]
            shade = color if flat else shaded(color, 0.62 + 0.42 * max(0.0, float(normal @ light)))
            yield Patch(points[:, :2], float(points[:, 2].mean()), face=shade, opacity=0.9 if flat else 1.0)
    for a, b, one, other in solid.edges:
        if towards[one] or towards[other]:
            ends = seen[[a, b]]
            near = max(float(seen[solid.faces[k], 2].mean()) for k in (one, other) if towards[k])
            yield Patch(ends[:, :2], near, edge=edge[0], width=0.7 * edge[1])


def _line(seen: np.ndarray, line: Line, color: str, wider: float, lift: float) -> Iterator[Patch]:
    yield Patch(seen[:, :2], float(seen[:, 2].mean()) + lift, edge=color, width=line.width * wider, dashed=line.dashed)


def _link(drawing: Drawing, link: Link, poses: Poses, k: int, view: View) -> Iterator[Patch]:
    ends = [poses.pose(end.body, k)[0] + poses.pose(end.body, k)[1] @ end.point for end in (link.i, link.j)]
    edge, wider = edge_color(drawing, link.owner, link.role), _wider(drawing, link.owner)
    for profile in link.profiles:
        seen = view.seen(stretched(profile, *ends))
        yield Patch(
            seen[:, :2], float(seen[:, 2].mean()) + FOREMOST * drawing.size, edge=edge, width=link.width * wider,
            dashed=link.dashed,
        )  # fmt: skip


def stretched(profile: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Return a profile stretched from one point to another, shape (n, 3)."""
    vector = end - start
    first, second = across(vector)
    return start + profile[:, :1] * vector + profile[:, 1:2] * first + profile[:, 2:3] * second


def _loads(drawing: Drawing, poses: Poses, k: int, view: View, longest: float) -> Iterator[Patch]:
    """Yield arrows of the forces on first bodies, from their points of application."""
    for name, anchor in drawing.loads.items():
        if name not in poses.forces:
            continue
        force = poses.forces[name][k]
        length = float(np.linalg.norm(force)) / longest * LONGEST_ARROW * drawing.size
        if not np.isfinite(length) or length < 0.01 * drawing.size:
            continue
        origin, axes = poses.pose(anchor.body, k)
        start = view.seen((origin + axes @ anchor.point)[None])[0]
        vector = view.seen(force[None] / np.linalg.norm(force))[0][:2]
        color = LOAD_NOT_UNIQUE if drawing.marks.get(name) else LOAD
        yield from _arrow(start[:2], vector * length, color, drawing.size, drawing.unit)


def _arrow(start: np.ndarray, vector: np.ndarray, color: str, size: float, unit: float) -> Iterator[Patch]:
    length = float(np.linalg.norm(vector))
    if length < 1e-6 * size:
        return
    head = min(0.35 * length, HEAD * unit)
    along = vector / length
    side = np.array([-along[1], along[0]])
    tip, neck = start + vector, start + vector - along * head
    front = 1e3 * size
    yield Patch(np.array([start, neck]), front, edge=color, width=2.2)
    yield Patch(np.array([tip, neck + 0.45 * head * side, neck - 0.45 * head * side]), front, face=color)


def largest_force(drawing: Drawing, poses: Poses) -> float:
    """Return the largest force of any drawn element, N; zero if all are rounding."""
    sizes = [np.linalg.norm(poses.forces[name], axis=1) for name in drawing.loads if name in poses.forces]
    largest = max((float(np.nanmax(size)) for size in sizes if np.isfinite(size).any()), default=0.0)
    return largest if largest > ROUNDING * drawing.weight else 0.0


def _far(drawing: Drawing, part: Part, poses: Poses, k: int) -> bool:
    """Return True for a part of the ground that a travelling mechanism has left."""
    if part.body != GROUND or not drawing.heaviest:
        return False
    place = poses.pose(drawing.heaviest, k)[0]
    shapes = (*(solid.vertices for solid in part.solids), *(line.points for line in part.lines))
    return all(float(np.linalg.norm(points - place, axis=1).min()) > FAR * drawing.size for points in shapes)


def extent(drawing: Drawing, poses: Poses, view: View, longest: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Return the lower left and upper right corners of the drawing over all instants; parameters as for `painted`."""
    low, high = np.full(2, np.inf), np.full(2, -np.inf)
    count = len(poses.time)
    shown = tuple(part for part in drawing.parts if part.role != "floor")
    for k in np.unique(np.linspace(0, count - 1, min(count, 24)).astype(int)):
        bare = replace(drawing, parts=tuple(part for part in shown if not _far(drawing, part, poses, k)))
        for patch in painted(bare, poses, k, view, longest):
            low, high = np.minimum(low, patch.points.min(axis=0)), np.maximum(high, patch.points.max(axis=0))
    return low, high
