"""Rigid bodies and elastic elements of a beam, as entries of a scene."""

from __future__ import annotations

import itertools
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from ...elements.spatial.orientation import IDENTITY, from_matrix
from ...elements.turns import GROUND_AXES
from ...reading.files.yaml_text import Content
from .discretise import Element, Line, Node, discretise
from .drawn_shapes import planar_shape, spatial_shapes

if TYPE_CHECKING:
    from .beam import Beam
    from .planar import BeamBody as PlanarBeam
    from .spatial import BeamBody as SpatialBeam

IN_PLANE: Final = [0, 1, 5]
"""Components of strain in the plane."""


@dataclass(frozen=True)
class Expanded:
    """Bodies and forces of a beam, as entries of a scene, and its nodes and elements."""

    bodies: Content
    forces: Content
    line: Line


def expanded(name: str, beam: Any) -> Expanded:
    """Return the bodies and forces of a beam; ValueError as for `discretise`."""
    line = discretise(beam)
    planar = beam.dimensions == 2
    neighbours = _neighbours(line)
    body = _planar_body if planar else _spatial_body
    bodies = {
        f"{name}.{node.name}": body(node, beam, line.nodes[0], neighbours[k]) for k, node in enumerate(line.nodes)
    }
    if planar:
        _unwrap([*bodies.values()])
    forces = {f"{name}.element{k + 1}": _force(name, element, beam) for k, element in enumerate(line.elements)}
    return Expanded(bodies, forces, line)


def _neighbours(line: Line) -> list[list[np.ndarray]]:
    """Return for each node the points from half way to its neighbours, in its axes, for drawings."""
    points = [node.point for node in line.nodes]
    half = [(a + b) / 2 for a, b in itertools.pairwise(points)]
    polylines = [[*half[max(k - 1, 0) : k], point, *half[k : k + 1]] for k, point in enumerate(points)]
    return [
        [node.axes.T @ (p - node.point) for p in polyline] for node, polyline in zip(line.nodes, polylines, strict=True)
    ]


def _numbers(vector: Iterable[float]) -> list[float]:
    return [float(part) for part in vector]


def _planar_body(node: Node, beam: PlanarBeam, start: Node, shape: list[np.ndarray]) -> dict[str, object]:
    arm = node.point - start.point
    return {
        "mass": node.mass, "inertia": float(node.inertia[2, 2]), "position": _numbers(node.point[:2]),
        "angle": _angle(node.axes), "markers": {GROUND_AXES: {"angle": -_angle(node.axes)}}, "omega": beam.omega,
        "velocity": [beam.velocity[0] - beam.omega * float(arm[1]), beam.velocity[1] + beam.omega * float(arm[0])],
        "geometry": [planar_shape(node, shape)],
    }  # fmt: skip


def _unwrap(bodies: list[Content]) -> None:
    """Add whole turns to the angles of nodes, so that neighbours differ by less than half a turn."""
    for body, angle in zip(bodies, np.unwrap([body["angle"] for body in bodies]), strict=True):
        body["angle"] = float(angle)


def _spatial_body(node: Node, beam: SpatialBeam, start: Node, shape: list[np.ndarray]) -> dict[str, object]:
    omega = np.array(beam.omega)
    velocity = np.array(beam.velocity) + np.cross(omega, node.point - start.point)
    return {
        "mass": node.mass, "inertia": [_numbers(row) for row in (node.inertia + node.inertia.T) / 2],
        "position": _numbers(node.point), "orientation": list(from_matrix(node.axes)),
        "markers": {GROUND_AXES: {"orientation": list(from_matrix(node.axes.T))}},
        "velocity": _numbers(velocity), "omega": _numbers(node.axes.T @ omega),
        "geometry": spatial_shapes(node, shape),
    }  # fmt: skip


def _angle(axes: np.ndarray) -> float:
    return float(np.arctan2(axes[1, 0], axes[0, 0]))


def _planar_marker(body: str, turned: np.ndarray) -> dict[str, object]:
    return {"body": body, "angle": _angle(turned)}


def _spatial_marker(body: str, turned: np.ndarray) -> dict[str, object]:
    straight = np.allclose(turned, np.eye(3), rtol=0, atol=1e-14)
    return {"body": body, "orientation": list(IDENTITY if straight else from_matrix(turned))}


def _of_torsion(element: Element) -> dict[str, object]:
    """Return the fields of an element whose torsion stretches and bends it."""
    return {name: [0.0, *_numbers(np.array(getattr(element, name)))] for name in ("shear_centre", "wagner")}


def _force(name: str, element: Element, beam: Beam) -> Content:
    """Return the entry of an element."""
    marker, components = (_planar_marker, IN_PLANE) if beam.dimensions == 2 else (_spatial_marker, list(range(6)))
    first, *others = (f"{name}.{node.name}" for node in element.nodes)
    i, j = {"body": others[-1]}, marker(first, element.turned)
    K = element.stiffness[np.ix_(components, components)].tolist()
    common = {
        "length": element.length, "unloaded": _numbers(element.unloaded[components]),
        **({"damping_ratio": beam.damping} if beam.damping else {}),
    }  # fmt: skip
    if len(others) == 1:
        of_pair: Content = {"stiffness": [[part or None for part in row] for row in K]}
        of_pair["bowing"] = _numbers(element.bowing[: len(components) // 3])
        torsion = _of_torsion(element) if element.stretch else {}
        return {"type": "exact_beam", **of_pair, **torsion, **common, "i": i, "j": j}
    stretch = {"stretch": element.stretch} if element.stretch else {}
    return {
        "type": "beam_section", "stiffness": K, **stretch, **common, "nodes": [j, *({"body": body} for body in others)],
        "reference": element.reference, "shapes": _numbers(element.shapes), "slopes": _numbers(element.slopes),
    }  # fmt: skip
