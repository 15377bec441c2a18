"""Names of joint coordinates and their initial values."""

from __future__ import annotations

import numpy as np

from ..statements.constraints import ROTATIONAL, TRANSLATIONAL, Joint
from .mechanism import Place

SORTS = {"REVOLUTE": ROTATIONAL, "TRANSLATIONAL": TRANSLATIONAL}
"""Type of displacement of the joints with one coordinate."""


def coordinate(joint: Joint, sort: str) -> str:
    """Return the scene name of a joint coordinate."""
    if joint.kind in SORTS:
        return joint.name
    return f"{joint.name}.{'angle' if sort == ROTATIONAL else 'displacement'}"


def initial_displacement(sort: str, i: Place, j: Place) -> float:
    """Return the displacement of a joint at the initial pose, m or rad."""
    a, b = i.initial, j.initial
    if sort != ROTATIONAL:
        return float((a.point - b.point) @ b.axes[:, 2])
    x = a.axes[:, 0]
    return float(np.arctan2(x @ b.axes[:, 1], x @ b.axes[:, 0]))
