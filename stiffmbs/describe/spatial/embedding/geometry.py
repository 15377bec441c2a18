"""Planar shapes in space: their depth is half their smaller width, centred on the plane."""

from __future__ import annotations

from ...geometry import planar
from ...geometry.shape import Shape
from .markers import Written, point, turned


def shape(found: Shape) -> Written:
    """Return a shape in the form of a spatial scene."""
    written: Written = {"type": found.type}
    if found.color is not None:
        written["color"] = found.color
    match found:
        case planar.Polyline():
            closed = {"closed": True} if found.closed else {}
            return written | {"points": [[*place, 0] for place in found.points], **closed}
        case planar.Box():
            written["size"] = [*found.size, min(found.size) / 2]
        case planar.Cylinder():
            written |= {"radius": found.radius, "length": found.radius}
        case planar.Sphere():
            written["radius"] = found.radius
        case planar.Mesh():
            written |= {"file": found.file, "scale": list(found.scale)}
    assert isinstance(found, planar.Placed)
    return written | point(found.point) | turned(found.angle)
