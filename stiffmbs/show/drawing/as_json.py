"""Drawings with their poses as plain numbers, for pages and other programs."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from .poses import Poses
from .scene_graph import LOAD, RAMP, Drawing, Link, Part, edge_color, face_color
from .solids import triangles

DIGITS = 6


def drawing_json(drawing: Drawing) -> dict[str, object]:
    """Return the drawables: vertices and triangles, lines, stretched profiles, names, colors.

    The result: lengths in metres, in the axes of bodies relative to their centres of mass; ready for `json.dumps`.
    """
    return {
        "name": drawing.name, "dimensions": drawing.dimensions, "size": drawing.size, "unit": drawing.unit, "bodies": list(drawing.bodies),
        "gravity": _numbers(drawing.gravity, drawing.size),
        "parts": [_part(part, drawing) for part in drawing.parts],
        "links": [_link(link, drawing) for link in drawing.links],
        "names": [
            {"text": name.text, "role": name.role, "body": name.anchor.body, "point": _numbers(name.anchor.point, drawing.size)}
            for name in drawing.names
        ],
        "loads": [
            {"name": name, "body": anchor.body, "point": _numbers(anchor.point, drawing.size)}
            for name, anchor in drawing.loads.items()
        ],
        "deformations": dict(drawing.deformations), "marks": dict(drawing.marks), "load_color": LOAD,
        "stress": drawing.stress, "ramp": RAMP,
    }  # fmt: skip


def poses_json(poses: Poses) -> dict[str, object]:
    """Return time, s; x, y, z (m) and quaternion of each body; force (N) of each element; one list per instant."""
    return {
        "time": poses.time.tolist(),
        "bodies": {
            name: np.column_stack([poses.points[name], poses.orientations[name]]).tolist() for name in poses.points
        },
        "forces": {name: force.tolist() for name, force in poses.forces.items()},
    }


def _numbers(values: np.ndarray, size: float) -> list[object]:
    """Round numbers to six digits of the mechanism's size."""
    return np.round(values, DIGITS - int(np.floor(np.log10(size)))).tolist()  # type: ignore[no-any-return]


def _by_body(shapes: Mapping[str, np.ndarray]) -> dict[str, object]:
    return {body: [_numbers(shape, np.abs(own).max() or 1.0) for shape in own] for body, own in shapes.items()}


def _part(part: Part, drawing: Drawing) -> dict[str, object]:
    return {
        "owner": part.owner, "role": part.role, "body": part.body, "color": face_color(drawing, part),
        "edge": edge_color(drawing, part.owner, part.role),
        "solids": [
            {"vertices": _numbers(solid.vertices, drawing.size), "triangles": triangles(solid).tolist(), "edges": solid.edges[:, :2].tolist(),
             "modes": _by_body(solid.modes), "stresses": _by_body(solid.stresses)}
            for solid in part.solids
        ],
        "lines": [
            {"points": _numbers(line.points, drawing.size), "width": line.width, "dashed": line.dashed} for line in part.lines
        ],
    }  # fmt: skip


def _link(link: Link, drawing: Drawing) -> dict[str, object]:
    return {
        "owner": link.owner, "role": link.role, "edge": edge_color(drawing, link.owner, link.role), "width": link.width,
        "dashed": link.dashed, "i": {"body": link.i.body, "point": _numbers(link.i.point, drawing.size)},
        "j": {"body": link.j.body, "point": _numbers(link.j.point, drawing.size)},
        "profiles": [profile.tolist() for profile in link.profiles],
    }  # fmt: skip
