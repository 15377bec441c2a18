"""Checks that markers are initially near the intended solution of a joint's equations.

The equations of axes are bilinear and have several solutions. Newton's method converges to the nearest solution of
sin(a) = 0 from less than 66.8 degrees, where tan(a) = 2 a.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import numpy as np

from ..initial_pose import InitialPose
from .marker import Marker

FARTHEST = 60 - 1e-6
"""Largest initial angle, deg, less rounding. For frames it is also half the angle to the next orientation (a third of a
turn, x to y to z) that satisfies the same equations."""
HALF_TURNS = tuple(np.diag(signs) for signs in ((1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)))
"""Identity, and half turns about x, y and z."""


def initially_apart(pose: InitialPose, i: Marker, j: Marker) -> Iterator[str]:
    """Yield an error if z axes are too far from parallel or opposite for a joint that keeps them so."""
    expected = f"less than {FARTHEST:g} or more than {180 - FARTHEST:g} (the joint holds them parallel or opposite)"
    yield from _axes_apart(pose, i, j, lambda angle: min(angle, 180 - angle), expected)


def initially_without_axis(pose: InitialPose, i: Marker, j: Marker) -> Iterator[str]:
    """Yield an error if z axes are too far from parallel or opposite for a force about their common axis."""
    expected = "one common axis to turn about (a joint has to keep them parallel)"
    yield from _axes_apart(pose, i, j, lambda angle: min(angle, 180 - angle), expected)


def initially_aligned(pose: InitialPose, i: Marker, j: Marker) -> Iterator[str]:
    """Yield an error if z axes are too far from perpendicular for a joint that keeps them so."""
    expected = f"between {90 - FARTHEST:g} and {90 + FARTHEST:g} (the joint holds them at right angles)"
    yield from _axes_apart(pose, i, j, lambda angle: abs(angle - 90), expected)


def initially_rotated(pose: InitialPose, i: Marker, j: Marker) -> Iterator[str]:
    """Yield an error if the axes of two markers are too far from parallel for a joint that keeps them so."""
    angle = _angle(_between_frames(pose, i, j))
    expected = f"less than {FARTHEST:g} (the joint holds each parallel to its namesake)"
    yield from _too_far(angle, f"the axes of its markers drawn {angle:.4g} degrees apart", expected)


def initially_twisted(pose: InitialPose, i: Marker, j: Marker, opposite: bool) -> Iterator[str]:
    """Yield an error if shafts are too far from zero or half a turn of twist for a joint that constrains the twist.

    The twist is about the z axes, which coincide if the shafts are in line; `opposite` reverses one of them.
    """
    turned, sign = _between_frames(pose, i, j), 1 if opposite else -1
    twist = abs(math.degrees(math.atan2(turned[1, 0] + sign * turned[0, 1], turned[0, 0] - sign * turned[1, 1])))
    expected = f"less than {FARTHEST:g} or more than {180 - FARTHEST:g} (the joint holds their x axes parallel)"
    yield from _too_far(
        min(twist, 180 - twist), f"its shafts drawn {twist:.4g} degrees twisted against each other", expected
    )


def initially_askew(pose: InitialPose, i: Marker, j: Marker) -> Iterator[str]:
    """Yield an error if axes are too far from pairwise parallel or opposite for a joint that keeps them so."""
    turned = _between_frames(pose, i, j)
    found = f"the axes of its markers drawn {_angle(turned):.4g} degrees apart"
    expected = f"less than {FARTHEST:g}, from no turn or from half a turn about an axis (the joint holds each along its namesake)"
    yield from _too_far(min(_angle(turned @ half) for half in HALF_TURNS), found, expected)


def _too_far(angle: float, found: str, expected: str) -> Iterator[str]:
    if angle >= FARTHEST:
        yield f"found {found}, expected {expected}"


def _axes_apart(
    pose: InitialPose, i: Marker, j: Marker, departure: Callable[[float], float], expected: str
) -> Iterator[str]:
    """Yield an error if the angle between the z axes departs too far from the expected one."""
    a, b = pose.model.initial_marker(i), pose.model.initial_marker(j)
    angle = math.degrees(math.acos(np.clip(a.z @ b.z, -1, 1)))
    yield from _too_far(departure(angle), f"the z axes of its markers drawn {angle:.4g} degrees apart", expected)


def _between_frames(pose: InitialPose, i: Marker, j: Marker) -> np.ndarray:
    """Return the rotation matrix from marker j to marker i at the initial pose."""
    a, b = pose.model.initial_marker(i), pose.model.initial_marker(j)
    return b.axes.T @ a.axes


def _angle(rotation: np.ndarray) -> float:
    return math.degrees(math.acos(np.clip((np.trace(rotation) - 1) / 2, -1, 1)))
