"""Test for z axes of two markers that joints keep parallel."""

from __future__ import annotations

import numpy as np

from ...elements.spatial.joints.cylindrical import Cylindrical
from ...elements.spatial.joints.fixed import Fixed
from ...elements.spatial.joints.orientation import Orientation
from ...elements.spatial.joints.parallel import Parallel
from ...elements.spatial.joints.planar import Planar
from ...elements.spatial.joints.prismatic import Prismatic
from ...elements.spatial.joints.revolute import Revolute
from ...elements.spatial.orientation import matrix
from ...model.spatial_model import SpatialData
from ...reading.marker import MarkerReference
from ..statements.geometry import ROUNDING

ABOUT_Z = (Cylindrical, Parallel, Planar, Revolute)
"""Joints that allow rotation about their z axis only."""
NO_ROTATION = (Fixed, Orientation, Prismatic)


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
            if other.body not in known and (isinstance(joint, NO_ROTATION) or np.hypot(axis[0], axis[1]) <= ROUNDING):
                known[other.body] = _axes(scene, other) @ axis
                left.append(other.body)
    return j.body in known and bool(np.linalg.norm(np.cross(known[j.body], _axes(scene, j)[:, 2])) <= ROUNDING)


def _axes(scene: SpatialData, marker: MarkerReference) -> np.ndarray:
    """Return the axes of a marker in the axes of its body as columns, shape (3, 3)."""
    return np.asarray(matrix(scene.place(marker).orientation))
