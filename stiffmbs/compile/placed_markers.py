"""Placement of markers of a compiled spatial element, from the numbers of its kernel."""

from __future__ import annotations

import numpy as np

from ..elements.spatial.marker import Placement
from .quaternions import rotated
from .system import System

UP_TO = {"choice": 0, "number": 1, "marker": len(Placement().numbers())}
"""Count of numbers of a field by shape, for shapes that may precede a marker."""
MATRIX = slice(3, 12)
"""Rotation matrix in a marker's numbers, by rows."""


def marker_axes(system: System, name: str, field: str, q: np.ndarray) -> np.ndarray | None:
    """Return the axes of a marker as columns in ground axes; None if the element has no such marker.

    `name`: element name. `field`: field with the marker, such as ``j``. `q` of shape (n_q,): the pose.
    """
    group = next(group for group in system.groups if name in group.names)
    e = group.names.index(name)
    at = int(group.index[e, 2 * group.kind.n_bodies])
    for found, shape in group.kind.fields:
        if shape[0] not in UP_TO:
            return None
        if found == field and shape[0] == "marker":
            own = group.numbers[at:][MATRIX].reshape(3, 3)
            body = int(group.bodies[e, shape[1]])
            if body == len(system.bodies):
                return own
            first = system.of_body.n_q * body + system.of_body.linear
            return rotated(q[first : first + 4], own.T).T
        at += UP_TO[shape[0]]
    return None
