"""Surroundings of a mechanism in space: the road below its tyres, or a floor below all that moves."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from ...elements.roads.crg import CrgRoad
from ...elements.roads.road import Road
from ...model.model_data import ModelData
from ...reading.marker import GROUND
from .poses import Poses
from .scene_graph import Drawing, Line, Part, Solid

OWNER, ASPHALT = "road", "#dcdcda"


@dataclass(frozen=True)
class SurroundingsParameters:
    """Extent and resolution of roads and floors, chosen by eye; lengths are relative to the mechanism's size."""

    margin: float = 0.5  # width of a road or floor outside the mechanism
    along: int = 240  # largest number of points along a road
    across: int = 9  # largest number of points across it
    dense: int = 160  # number of points of the uneven part of a road, if that part is short
    short: float = 10.0  # length of an uneven part that gets `dense` points
    lines: float = 0.25  # distance of the lines of a floor, before rounding to 1, 2 or 5
    instants: int = 24  # instants at which the lowest point is sought


CHOSEN = SurroundingsParameters()


def with_surroundings(drawing: Drawing, data: ModelData, poses: Poses) -> Drawing:
    """Return a drawing in space with its road, or a floor if it has gravity and moves above it."""
    if drawing.dimensions == 2 or not data.bodies:
        return drawing
    roads: dict[int, Road] = {}
    wheels: dict[int, list[str]] = {}
    for force in data.forces.values():
        road = getattr(force, "road", None)
        marker = getattr(force, "j", None)
        if isinstance(road, Road) and (marker is None or marker.body == GROUND):
            roads[id(road)] = road
            wheels.setdefault(id(road), []).append(force.i.body)  # type: ignore[attr-defined]  # a tyre
    if not roads:
        floor = _floor(drawing, poses)
        return drawing if floor is None else replace(drawing, parts=(floor, *drawing.parts))
    parts = tuple(_road(road, wheels[key], drawing, poses) for key, road in roads.items())
    return replace(drawing, parts=(*(part for part in parts if part is not None), *drawing.parts))


def _floor(drawing: Drawing, poses: Poses) -> Part | None:
    """Return a level floor through the lowest point of the whole motion; none without a vertical gravity."""
    up = int(np.argmax(np.abs(drawing.gravity)))
    strength = abs(drawing.gravity[up])
    if strength == 0 or strength < 0.999 * float(np.linalg.norm(drawing.gravity)):
        return None
    low, high = _reached(drawing, poses)
    level = low[up] if drawing.gravity[up] < 0 else high[up]
    if not np.isfinite([*low, *high]).all():
        return None
    border = CHOSEN.margin * max(drawing.size, float((high - low).max()))
    step = _round(max(CHOSEN.lines * drawing.size, float((high - low).max()) / 40))
    first, second = (k for k in range(3) if k != up)
    ends = [
        (step * math.floor((low[k] - border) / step), step * math.ceil((high[k] + border) / step))
        for k in (first, second)
    ]
    counts = [round((b - a) / step) + 1 for a, b in ends]
    grid = np.zeros((*counts, 3))
    grid[..., first] = np.linspace(*ends[0], counts[0])[:, None]
    grid[..., second] = np.linspace(*ends[1], counts[1])
    grid[..., up] = level
    corners = grid[[0, -1, -1, 0], [0, 0, -1, -1]]
    plane = Solid(corners, (np.arange(4),), closed=False)
    lines = (*(Line(row[[0, -1]], 0.5) for row in grid), *(Line(row[[0, -1]], 0.5) for row in grid.transpose(1, 0, 2)))
    return Part(OWNER, "floor", GROUND, (plane,), lines)


def _reached(drawing: Drawing, poses: Poses) -> tuple[np.ndarray, np.ndarray]:
    """Return the corners of the box that all bodies reach."""
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    count = len(poses.time)
    for k in np.unique(np.linspace(0, count - 1, min(count, CHOSEN.instants)).astype(int)):
        for part in drawing.parts:
            if part.role != "body" and part.body == GROUND:
                continue
            origin, axes = poses.pose(part.body, k)
            for shape in (*(poses.vertices(solid, k) for solid in part.solids), *(line.points for line in part.lines)):
                points = origin + shape @ axes.T
                low, high = np.minimum(low, points.min(axis=0)), np.maximum(high, points.max(axis=0))
    return low, high


def _round(length: float) -> float:
    """Return 1, 2 or 5 times a power of ten, at least a length."""
    base = 10.0 ** math.floor(math.log10(length))
    return next(factor * base for factor in (1, 2, 5, 10) if factor * base >= length * (1 - 1e-9))


def _road(road: Road, wheels: list[str], drawing: Drawing, poses: Poses) -> Part | None:
    """Return the surface of a road below its wheels; None if it states no heights."""
    if isinstance(road, CrgRoad):
        return _surface(road.surface_points(CHOSEN.along))
    path = np.vstack([poses.points[body] for body in wheels])
    path = path[np.isfinite(path).all(axis=1)]
    if not len(path):
        return None
    border = CHOSEN.margin * drawing.size
    low, high = path.min(axis=0) - border, path.max(axis=0) + border
    x = _along(road, float(low[0]), float(high[0]), drawing.size)
    y = np.linspace(low[1], high[1], CHOSEN.across)
    points = np.zeros((len(x), len(y), 3))
    points[..., 0], points[..., 1] = x[:, None], y
    try:
        points[..., 2] = road.heights(points[..., 0], points[..., 1])
    except NotImplementedError:
        return None
    return _surface(points) if np.isfinite(points).all() else None


def _along(road: Road, low: float, high: float, size: float) -> np.ndarray:
    """Return positions along a road: even ones, and dense ones on a short uneven part."""
    if road.level:
        count = int(np.clip((high - low) / _round(CHOSEN.lines * size), 2, CHOSEN.along))
        return np.linspace(low, high, count + 1)
    x = np.linspace(low, high, CHOSEN.along)
    extent = road.extent()
    if extent is not None and extent[1] - extent[0] < CHOSEN.short * size:
        margin = 0.02 * size
        x = np.union1d(x, np.linspace(extent[0] - margin, extent[1] + margin, CHOSEN.dense).clip(low, high))
    return x


def _surface(points: np.ndarray) -> Part:
    """Return a surface through points, shape (n, m, 3), with lines across it and at its sides."""
    n, m = points.shape[:2]
    number = np.arange(n * m).reshape(n, m)
    level = bool(np.ptp(points[..., 2]) == 0)
    quads = np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], axis=-1).reshape(-1, 4)
    corners = number[[0, -1, -1, 0], [0, 0, -1, -1]]
    faces = (corners,) if level else tuple(quads)
    every = max(1, n // 60)
    lines = (*(Line(row, 0.5) for row in points[::every]), *(Line(points[:, k], 0.5) for k in (0, m // 2, m - 1)))
    return Part(OWNER, "floor", GROUND, (Solid(points.reshape(-1, 3), faces, closed=False),), lines, ASPHALT)


def shadows(drawing: Drawing, poses: Poses, k: int) -> list[np.ndarray]:
    """Return the outlines of the shadows of all bodies on a level floor at the k-th instant, in ground axes."""
    from scipy.spatial import ConvexHull, QhullError

    floor = next((part for part in drawing.parts if part.role == "floor"), None)
    if floor is None or not drawing.gravity.any():
        return []
    up = int(np.argmax(np.abs(drawing.gravity)))
    heights = floor.solids[0].vertices[:, up]
    across = [n for n in range(3) if n != up]
    found = []
    for part in drawing.parts:
        if part.role != "body":
            continue
        origin, axes = poses.pose(part.body, k)
        for solid in part.solids:
            points = origin + poses.vertices(solid, k) @ axes.T
            points[:, up] = float(np.median(heights))
            try:
                corners = ConvexHull(points[:, across]).vertices
            except (QhullError, ValueError):  # seen edge on
                continue
            found.append(points[corners])
    return found
