"""Markers by name, and their motion in joint coordinates."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...dynamics.joint_tree import JointTree
from ...errors import InputError
from ...model.model_data import ModelData
from ...reading.marker import GROUND, MarkerReference, check_marker
from ...reading.names import Names


@dataclass(frozen=True)
class MarkerPose:
    """Pose of a marker in ground axes.

    Attributes
    ----------
    position : ndarray, shape (3,), or (2,) in the plane
        m.
    rotation : ndarray, shape (3, 3), or (2, 2) in the plane
        Rotation matrix, with the axes of the marker as columns.
    """

    position: np.ndarray
    rotation: np.ndarray


@dataclass(frozen=True)
class PlacedMarker:
    """Marker on a body: index of the body, None for ground, and its numbers for `JointTree.marker`, in ground axes."""

    body: int | None
    numbers: np.ndarray


def placed_marker(data: ModelData, tree: JointTree, given: str | MarkerReference) -> PlacedMarker:
    """Return a marker of a body or of ground; raise an InputError if it is unknown."""
    reference = given
    if isinstance(given, str):
        body, marker = Names(frozenset(data.bodies)).body_and_marker(given)
        reference = MarkerReference(body=body, marker=marker or None)
    if not isinstance(reference, MarkerReference):
        raise InputError(f"marker: found {given!r}, expected a body, body.marker, ground.marker, or a Marker")
    try:
        check_marker("marker", reference, data.bodies, data.markers)
    except ValueError as error:
        raise InputError(str(error)) from None
    owner, placed = data.carried(reference)
    numbers = np.array(placed.numbers(), dtype=float)
    if data.dimensions == 2:
        point, (c, s) = np.append(numbers[:2], 0.0), numbers[3:5]
        axes = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    else:
        point, axes = numbers[:3], numbers[3:12].reshape(3, 3)
    if owner == GROUND:
        return PlacedMarker(None, np.concatenate([point, axes.reshape(-1)]))
    bodies = tree.state.system.bodies
    if owner not in bodies:
        raise InputError(f"marker '{owner}': found a flexible body, expected a marker of a rigid body or of a node")
    k = bodies.index(owner)
    return PlacedMarker(k, tree.at_reference(k, point, axes))
