"""Checks that markers are initially near the intended solution of a joint's equations.

The equations of axes are bilinear and have several solutions. Newton's method converges to the nearest solution of
sin(a) = 0 from less than 66.8 degrees, where tan(a) = 2 a.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from ..model_data import ModelData
from .marker import Marker

FARTHEST = 60.0
"""Largest initial angle, deg. For frames it is also half the angle to the next orientation (a third of a turn, x to y
to z) that satisfies the same equations."""
ANGLE_ROUNDING = 1e-6
"""Rounding tolerance of an angle between axes, deg."""
HALF_TURNS = tuple(np.diag(signs) for signs in ((1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)))
"""Identity, and half turns about x, y and z."""


def initially_apart(model: ModelData, i: Marker, j: Marker) -> Iterator[str]:
    """Yield an error if z axes are too far from parallel or opposite for a joint that keeps them so."""
    angle = _between_axes(model, i, j)
    if min(angle, 180 - angle) >= FARTHEST - ANGLE_ROUNDING:
        yield (
            f"found the z axes of its markers drawn {angle:.4g} degrees apart, expected less than {FARTHEST:g} or more "
            f"than {180 - FARTHEST:g} (the joint holds them parallel or opposite)"
        )


def initially_without_axis(model: ModelData, i: Marker, j: Marker) -> Iterator[str]:
    """Yield an error if z axes are too far from parallel or opposite for a force about their common axis."""
    angle = _between_axes(model, i, j)
    if min(angle, 180 - angle) >= FARTHEST - ANGLE_ROUNDING:
        yield (
            f"found the z axes of its markers drawn {angle:.4g} degrees apart, expected one common axis to turn about "
            "(a joint has to keep them parallel)"
        )


def initially_aligned(model: ModelData, i: Marker, j: Marker) -> Iterator[str]:
    """Yield an error if z axes are too far from perpendicular for a joint that keeps them so."""
    angle = _between_axes(model, i, j)
    if abs(angle - 90) >= FARTHEST - ANGLE_ROUNDING:
        yield (
            f"found the z axes of its markers drawn {angle:.4g} degrees apart, expected between {90 - FARTHEST:g} and "
            f"{90 + FARTHEST:g} (the joint holds them at right angles)"
        )


def initially_rotated(model: ModelData, i: Marker, j: Marker) -> Iterator[str]:
    """Yield an error if the axes of two markers are too far from parallel for a joint that keeps them so."""
    angle = _angle(_between_frames(model, i, j))
    if angle >= FARTHEST - ANGLE_ROUNDING:
        yield (
            f"found the axes of its markers drawn {angle:.4g} degrees apart, expected less than {FARTHEST:g} "
            "(the joint holds each parallel to its namesake)"
        )


def initially_twisted(model: ModelData, i: Marker, j: Marker, opposite: bool) -> Iterator[str]:
    """Yield an error if shafts are too far from zero or half a turn of twist for a joint that constrains the twist.

    The twist is about the z axes, which coincide if the shafts are in line; `opposite` reverses one of them.
    """
    turned = _between_frames(model, i, j)
    across, along = (
        (turned[1, 0] + turned[0, 1], turned[0, 0] - turned[1, 1])
        if opposite
        else (turned[1, 0] - turned[0, 1], turned[0, 0] + turned[1, 1])
    )
    twist = abs(math.degrees(math.atan2(across, along)))
    if min(twist, 180 - twist) >= FARTHEST - ANGLE_ROUNDING:
        yield (
            f"found its shafts drawn {twist:.4g} degrees twisted against each other, expected less than {FARTHEST:g} or "
            f"more than {180 - FARTHEST:g} (the joint holds their x axes parallel)"
        )


def initially_askew(model: ModelData, i: Marker, j: Marker) -> Iterator[str]:
    """Yield an error if axes are too far from pairwise parallel or opposite for a joint that keeps them so."""
    turned = _between_frames(model, i, j)
    if min(_angle(turned @ half) for half in HALF_TURNS) >= FARTHEST - ANGLE_ROUNDING:
        yield (
            f"found the axes of its markers drawn {_angle(turned):.4g} degrees apart, expected less than {FARTHEST:g}, "
            "from no turn or from half a turn about an axis (the joint holds each along its namesake)"
        )


def _between_axes(model: ModelData, i: Marker, j: Marker) -> float:
    a, b = model.initial_marker(i), model.initial_marker(j)
    return math.degrees(math.acos(np.clip(a.z @ b.z, -1, 1)))


def _between_frames(model: ModelData, i: Marker, j: Marker) -> np.ndarray:
    """Return the rotation matrix from marker j to marker i at the initial pose."""
    a, b = model.initial_marker(i), model.initial_marker(j)
    return b.axes.T @ a.axes


def _angle(rotation: np.ndarray) -> float:
    return math.degrees(math.acos(np.clip((np.trace(rotation) - 1) / 2, -1, 1)))
