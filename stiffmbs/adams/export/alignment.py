"""Test for z axes of two markers that joints keep parallel."""

from __future__ import annotations

import numpy as np

from ...describe.marker import MarkerReference
from ...describe.spatial.joints.cylindrical import Cylindrical
from ...describe.spatial.joints.fixed import Fixed
from ...describe.spatial.joints.orientation import Orientation
from ...describe.spatial.joints.parallel import Parallel
from ...describe.spatial.joints.planar import Planar
from ...describe.spatial.joints.prismatic import Prismatic
from ...describe.spatial.joints.revolute import Revolute
from ...describe.spatial.model import SpatialData
from ...describe.spatial.orientation import matrix

ABOUT_Z = (Cylindrical, Parallel, Planar, Revolute)
"""Joints that allow rotation about their z axis only."""
NO_ROTATION = (Fixed, Orientation, Prismatic)
SAME = 1e-9
"""Sine of the largest angle between two axes of a body that count as parallel."""


def kept_parallel(scene: SpatialData, i: MarkerReference, j: MarkerReference) -> bool:
    """Return True if joints keep the z axes of two markers parallel, directly or through other bodies."""
    known = {i.body: _axes(scene, i)[:, 2]}
    left = [i.body]
    while left:
        body = left.pop()
        for joint in scene.joints.values():
            if not isinstance(joint, (*ABOUT_Z, *NO_ROTATION)) or body not in (joint.i.body, joint.j.body):
                continue
            own, other = (joint.i, joint.j) if joint.i.body == body else (joint.j, joint.i)
            axis = _axes(scene, own).T @ known[body]
            if other.body not in known and (isinstance(joint, NO_ROTATION) or np.hypot(axis[0], axis[1]) <= SAME):
                known[other.body] = _axes(scene, other) @ axis
                left.append(other.body)
    return j.body in known and bool(np.linalg.norm(np.cross(known[j.body], _axes(scene, j)[:, 2])) <= SAME)


def _axes(scene: SpatialData, marker: MarkerReference) -> np.ndarray:
    """Return the axes of a marker in the axes of its body as columns, shape (3, 3)."""
    return np.asarray(matrix(scene.place(marker).orientation))
