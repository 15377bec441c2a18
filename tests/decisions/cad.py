"""Decisions on assemblies of CAD programs: directions, numbers that are too large."""

from __future__ import annotations

import numpy as np

from stiffmbs.cad.assembly import WORLD, CadFault, Seat, at_angle, finite
from tests.solve.test_parameter_thresholds import count_while

from .common import BELOW

SEAT = Seat(None, WORLD)
LARGE = 0.9e95 * 2.0 ** (0.25 * np.arange(400))
"""Increasing numbers."""


def is_refused(call):
    """Return True if a call refuses the content of a file."""
    try:
        call()
    except CadFault:
        return True
    return False


DECISIONS = {
    "cad.assembly:PARALLEL": lambda: count_while(
        lambda cosine: at_angle("", SEAT, SEAT, float(cosine)).kind == "equation", BELOW
    ),
    "cad.assembly:LARGEST": lambda: count_while(lambda x: not is_refused(lambda: finite("", np.array([x]))), LARGE),
}
EXPECTED = {"cad.assembly:PARALLEL": 119, "cad.assembly:LARGEST": 68}
