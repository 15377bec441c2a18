"""Whether markers are drawn near enough to how a joint holds them.

The equations of axes are bilinear, and have other solutions too.  Newton's method finds the nearest one of sin(a) = 0
from less than 66.8 degrees off, where tan(a) = 2 a.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from ..model_data import ModelData
from .marker import Marker

FARTHEST = 60.0
"""deg; of frames this is also halfway to the next orientation (a third of a turn, x to y to z) that fulfils the same
equations."""
ANGLE_ROUNDING = 1e-6
"""deg, that rounding takes of an angle between written axes."""
HALF_TURNS = tuple(np.diag(signs) for signs in ((1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)))
"""None, and those about x, y and z."""


def initially_apart(model: ModelData, i: Marker, j: Marker) -> Iterator[str]:
    """Why a joint that keeps the axes z of two markers parallel or opposite cannot be assembled from the initial poses."""
    angle = _between_axes(model, i, j)
    if min(angle, 180 - angle) >= FARTHEST - ANGLE_ROUNDING:
        yield (
            f"found the z axes of its markers drawn {angle:.4g} degrees apart, expected less than {FARTHEST:g} or more "
            f"than {180 - FARTHEST:g} (the joint holds them parallel or opposite)"
        )


def initially_without_axis(model: ModelData, i: Marker, j: Marker) -> Iterator[str]:
    """Why a force about the axis z that two markers have in common has none where these are drawn."""
    angle = _between_axes(model, i, j)
    if min(angle, 180 - angle) >= FARTHEST - ANGLE_ROUNDING:
        yield (
            f"found the z axes of its markers drawn {angle:.4g} degrees apart, expected one common axis to turn about "
            "(a joint has to keep them parallel)"
        )


def initially_aligned(model: ModelData, i: Marker, j: Marker) -> Iterator[str]:
    """Why a joint that keeps the axes z of two markers at right angles cannot be assembled from the initial poses."""
    angle = _between_axes(model, i, j)
    if abs(angle - 90) >= FARTHEST - ANGLE_ROUNDING:
        yield (
            f"found the z axes of its markers drawn {angle:.4g} degrees apart, expected between {90 - FARTHEST:g} and "
            f"{90 + FARTHEST:g} (the joint holds them at right angles)"
        )


def initially_rotated(model: ModelData, i: Marker, j: Marker) -> Iterator[str]:
    """Why a joint that keeps all axes of two markers parallel cannot be assembled from the initial poses."""
    angle = _angle(_between_frames(model, i, j))
    if angle >= FARTHEST - ANGLE_ROUNDING:
        yield (
            f"found the axes of its markers drawn {angle:.4g} degrees apart, expected less than {FARTHEST:g} "
            "(the joint holds each parallel to its namesake)"
        )


def initially_twisted(model: ModelData, i: Marker, j: Marker, opposite: bool) -> Iterator[str]:
    """Why a joint that lets two shafts bend but not twist, or twist by half a turn, cannot be assembled.

    The twist is that about the axes z, which are one where the shafts are in line, in one sense or the other.
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
    """Why a joint that keeps each axis of a marker parallel or opposite to its namesake cannot be assembled."""
    turned = _between_frames(model, i, j)
    if min(_angle(turned @ half) for half in HALF_TURNS) >= FARTHEST - ANGLE_ROUNDING:
        yield (
            f"found the axes of its markers drawn {_angle(turned):.4g} degrees apart, expected less than {FARTHEST:g}, "
            "from no turn or from half a turn about an axis (the joint holds each along its namesake)"
        )


def _between_axes(model: ModelData, i: Marker, j: Marker) -> float:
    """The angle between the axes z at the initial pose, deg."""
    a, b = model.initial_marker(i), model.initial_marker(j)
    return math.degrees(math.acos(np.clip(a.z @ b.z, -1, 1)))


def _between_frames(model: ModelData, i: Marker, j: Marker) -> np.ndarray:
    """The rotation matrix from marker j to marker i at the initial pose."""
    a, b = model.initial_marker(i), model.initial_marker(j)
    return b.axes.T @ a.axes


def _angle(rotation: np.ndarray) -> float:
    """The angle of a rotation, deg."""
    return math.degrees(math.acos(np.clip((np.trace(rotation) - 1) / 2, -1, 1)))
