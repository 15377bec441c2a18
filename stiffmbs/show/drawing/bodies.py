"""Shapes of bodies: given by the scene, read from mesh files, or derived from the points of joints and forces."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import InputError
from ...reading.files.files_read import content_of
from . import solids
from .scene_graph import Line, Part, Solid
from .solids import axes_along, rotation

HEAD = np.dtype([("text", "S80"), ("facets", "<u4")])
FACET = np.dtype([("floats", "<f4", 12), ("rest", "<u2")])
"""Layout of a binary STL."""


def read_mesh(path: Path, where: str) -> Solid:
    """Read the mesh of a file, in the file's units.

    `path`: name in .stl or .obj. `where`: name of the shape in messages. Raises InputError if the file cannot be read.
    """
    try:
        data = content_of(path)
    except OSError as error:
        raise InputError(f"{where}: {path}: {error.strerror}, expected a mesh") from None
    try:
        mesh = _obj(data) if path.suffix.lower() == ".obj" else _stl(data)
    except (ValueError, IndexError, UnicodeDecodeError):
        mesh = None
    if mesh is None or not mesh.faces or not np.isfinite(mesh.vertices).all():
        raise InputError(f"{where}: {path}: found no triangles, expected a mesh in the format of its ending")
    return mesh


def _stl(data: bytes) -> Solid:
    count = int(np.frombuffer(data, HEAD, 1)["facets"][0]) if len(data) >= HEAD.itemsize else -1
    if len(data) == HEAD.itemsize + FACET.itemsize * count:
        facets = np.frombuffer(data, FACET, offset=HEAD.itemsize)
        corners = facets["floats"][:, 3:].reshape(-1, 3).astype(float)
    else:
        words = [line.split() for line in data.decode("utf-8").splitlines()]
        corners = np.array([[float(x) for x in line[1:4]] for line in words if line[:1] == ["vertex"]])
    vertices, of_corner = np.unique(corners, axis=0, return_inverse=True)
    return Solid(vertices, tuple(of_corner.reshape(-1, 3)))


def _obj(data: bytes) -> Solid:
    vertices, faces = [], []
    for line in data.decode("utf-8", errors="replace").splitlines():
        match line.split():
            case ["v", x, y, z, *_]:
                vertices.append([float(x), float(y), float(z)])
            case ["f", *corners] if len(corners) >= 3:
                numbers = [int(corner.split("/")[0]) for corner in corners]
                faces.append(np.array([k - 1 if k > 0 else len(vertices) + k for k in numbers]))
    if any(face.min() < 0 or face.max() >= len(vertices) for face in faces):
        raise ValueError("a face of vertices that are not there")
    return Solid(np.array(vertices).reshape(-1, 3), tuple(faces))


Shapes = tuple[tuple[Solid, ...], tuple[Line, ...]]
SAME_WHEEL = 0.2
"""Difference of radii below which a cylinder is the wheel that a tyre draws, relative."""
SAME_POINT = 1e-3
"""Distance below which points count as one, relative to the mechanism's size."""


def given_shapes(name: str, body: Any, dimensions: int, wheel: float = 0.0) -> list[Part]:
    """Return the shapes of a body in its scene; cylinders of the radius of a drawn wheel are left out.

    Raises InputError if a mesh cannot be read.
    """
    origin = np.zeros(3) if dimensions == 2 else -np.array(body.center_of_mass)
    parts = []
    for k, shape in enumerate(body.geometry):
        if wheel and shape.type == "cylinder" and abs(shape.radius / wheel - 1) < SAME_WHEEL:
            continue
        found, lines = _shape(shape, dimensions, f"bodies.{name}.geometry.{k}")
        point, axes = np.zeros(3), np.eye(3)
        if shape.type != "polyline":
            point[: len(shape.point)] = shape.point
            half = getattr(shape, "angle", 0.0) / 2
            turn = getattr(shape, "orientation", (math.cos(half), 0.0, 0.0, math.sin(half)))
            axes = rotation(np.array(turn))
        parts.append(
            Part(
                name, "body", name,
                tuple(solids.moved(solid, origin + point, axes) for solid in found),
                tuple(solids.moved_line(line, origin + point, axes) for line in lines), shape.color or "",
            )
        )  # fmt: skip
    return parts


def _shape(shape: Any, dimensions: int, where: str) -> Shapes:
    """Return a shape in its own axes."""
    match shape.type:
        case "polyline":
            points = np.zeros((len(shape.points), 3))
            points[:, :dimensions] = shape.points
            if shape.closed:
                return ((solids.flat(points),) if dimensions == 2 else ()), (solids.outline(points, 1.3),)
            return (), (Line(points, 2.0),)
        case "mesh":
            mesh = read_mesh(Path(shape.file), where)
            scale = np.array(shape.scale)
            flipped = np.prod(scale) < 0
            faces = tuple(face[::-1] if flipped else face for face in mesh.faces)
            solid = Solid(mesh.vertices * scale, faces)
            return (solids.edged(solid) if len(faces) < solids.MOST_FACES else solid,), ()
        case "box" if dimensions == 3:
            return _with_edges(solids.box(shape.size))
        case "box":
            corners = solids.rectangle(*shape.size)
            return (solids.flat(corners),), (solids.outline(corners),)
        case "cylinder" if dimensions == 3:
            return _with_edges(solids.cylinder(shape.radius, shape.length, 32))
    if dimensions == 3:
        return (solids.sphere(shape.radius, 24),), ()
    ring = solids.circle(shape.radius, corners=40)
    return (solids.flat(ring[:-1]),), (Line(ring), Line(np.array([[0.6 * shape.radius, 0, 0], [shape.radius, 0, 0]])))


def _with_edges(solid: Solid) -> Shapes:
    return (solids.edged(solid),), ()


def derived_shape(
    name: str, body: object, dimensions: int, points: Sequence[np.ndarray], size: float, thick: float
) -> Part:
    """Return a shape through a body's points: a bar, a plate or a hull; a block for a single point."""
    found = _distinct(points, SAME_POINT * size)
    if len(found) == 1 and np.linalg.norm(found[0]) > SAME_POINT * size:
        found = [found[0], _far_end(body, dimensions, found[0])]
    if len(found) < 2:
        shapes = _block(body, dimensions, size)
    elif dimensions == 2:
        shapes = _planar(np.array(found), thick)
    else:
        shapes = _spatial(np.array(found), thick)
    return Part(name, "body", name, *shapes)


def _distinct(points: Sequence[np.ndarray], near: float) -> list[np.ndarray]:
    found: list[np.ndarray] = []
    for point in points:
        if all(np.linalg.norm(point - other) > near for other in found):
            found.append(np.asarray(point, dtype=float))
    return found


def _far_end(body: Any, dimensions: int, point: np.ndarray) -> np.ndarray:
    """Return the other end of a bar with one joint: beyond the centre of mass, with the length from L^2 = 12 I/m."""
    moment = body.inertia if dimensions == 2 else max(body.principal_moments())
    reach = float(np.linalg.norm(point))
    return -point / reach * min(math.sqrt(3 * moment / body.mass), reach)


def _block(body: Any, dimensions: int, size: float) -> Shapes:
    """Return a block with the body's moments of inertia, neither tiny nor larger than the mechanism."""
    low, high = 0.05 * size, 0.16 * size
    if dimensions == 2:
        radius = float(np.clip(math.sqrt(2 * body.inertia / body.mass), low / 2, high / 2))
        ring = solids.circle(radius, corners=40)
        return (solids.flat(ring[:-1]),), (Line(ring), Line(np.array([[0.5 * radius, 0, 0], [radius, 0, 0]])))
    a, b, c = body.principal_moments()
    widths = np.sqrt(np.maximum(6 / body.mass * np.array([b + c - a, c + a - b, a + b - c]), 0))
    widths *= min(1.0, high * 1.5 / (widths.max() or 1.0))
    widths = np.maximum(widths, max(0.12 * widths.max(), 0.3 * low))
    block = solids.moved(
        solids.box((float(widths[0]), float(widths[1]), float(widths[2]))), np.zeros(3), rotation(body.principal_axes())
    )
    return _with_edges(block)


def _planar(points: np.ndarray, thick: float) -> Shapes:
    """Return a bar or plate with round corners: the hull of circles about the points."""
    from scipy.spatial import ConvexHull

    around = np.vstack([point + solids.circle(thick, corners=16)[:-1] for point in points])
    corners = around[ConvexHull(around[:, :2]).vertices]
    return (solids.flat(corners),), (solids.outline(corners),)


def _spatial(points: np.ndarray, thick: float) -> Shapes:
    """Return a rod through points on a line, or else rods: a triangle of three points, a star of more."""
    spread = points - points.mean(axis=0)
    _, widths, directions = np.linalg.svd(spread, full_matrices=False)
    if len(widths) < 2 or widths[1] < 0.5 * thick:
        along = spread @ directions[0]
        a, b = points[np.argmin(along)], points[np.argmax(along)]
        return _with_edges(_rod(a, b, 0.5 * thick))
    ends = [(k, (k + 1) % 3) for k in range(3)] if len(points) == 3 else [(k, -1) for k in range(len(points))]
    places = points if len(points) == 3 else np.vstack([points, points.mean(axis=0)])
    rods = [_rod(places[a], places[b], 0.36 * thick) for a, b in ends if np.linalg.norm(places[a] - places[b]) > 0]
    balls = [solids.moved(solids.sphere(0.5 * thick, 10), place, np.eye(3)) for place in places]
    return (*rods, *balls), ()


def _rod(a: np.ndarray, b: np.ndarray, radius: float) -> Solid:
    rod = solids.cylinder(radius, float(np.linalg.norm(b - a)), 12)
    return solids.moved(rod, (a + b) / 2, axes_along(b - a))
