"""Where the markers of a compiled element in space sit, read back from the numbers of its kernel."""

from __future__ import annotations

import numpy as np

from ..describe.spatial.marker import Placement
from .quaternions import rotated
from .system import System

UP_TO = {"choice": 0, "number": 1, "marker": len(Placement().numbers())}
"""Numbers of a field of each shape, of those that stand before a marker."""
MATRIX = slice(3, 12)
"""A marker's rotation matrix among its numbers, row by row."""


def marker_axes(system: System, name: str, field: str, q: np.ndarray) -> np.ndarray | None:
    """The axes of a marker as columns in ground axes; None where the element has no such marker.

    Parameters
    ----------
    name : str
        Of the element.
    field : str
        That holds the marker, such as ``j``.
    q : ndarray, shape (n_q,)
        The pose.
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
