"""Tyres of both sides of an axle that are mounted as tyres of one side."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from ..elements.spatial.body import Body
from ..elements.spatial.orientation import matrix, rotated
from ..elements.spatial.tyre import Tyre

ALONG = 0.1
"""Limit for two wheels on one axle: offset of one from the axis of the other, relative to the distance along it. The cosine
of the angle between their axes differs from 1 by less than the limit too."""
NAMED = 3
"""Number of coefficients in a note."""


@dataclass(frozen=True)
class _Wheel:
    name: str
    tyre: Tyre
    centre: np.ndarray
    axis: np.ndarray

    def to_the_left_of(self, other: _Wheel) -> float:
        """Return the distance along the axle of the other wheel, m; 0 if they are not on one axle."""
        between = self.centre - other.centre
        along = float(between @ other.axis)
        aside = np.linalg.norm(between - along * other.axis)
        return along if self.axis @ other.axis > 1 - ALONG and aside < ALONG * abs(along) else 0.0


def mounted_alike(bodies: Mapping[str, Body], forces: Mapping[str, object]) -> Iterator[str]:
    """Yield notes on axles whose outer tyres have the same hand, although left and right tyres differ."""
    wheels = [_wheel(bodies, name, tyre) for name, tyre in forces.items() if isinstance(tyre, Tyre)]
    for right in wheels:
        distances = [right.to_the_left_of(other) for other in wheels]
        if not any(distances) or max(distances) > 0:
            continue  # not the rightmost one of an axle
        left = wheels[int(np.argmin(distances))]
        data, hand, differing = right.tyre.mounted_side()
        if differing and (data, hand) == left.tyre.mounted_side()[:2]:
            names = ", ".join(differing[:NAMED]) + (" and others" if len(differing) > NAMED else "")
            yield (
                f"{left.name} and {right.name} are on both sides of an axle and not mirrored to each other: side forces of "
                f"ply steer and conicity ({names}) add up; hand: -1 mirrors one of them"
            )


def _wheel(bodies: Mapping[str, Body], name: str, tyre: Tyre) -> _Wheel:
    reference = tyre.i
    body = bodies[reference.body]
    placed = body.markers[reference.marker] if reference.marker else reference.placement()
    axes = matrix(body.orientation) @ matrix(placed.orientation)
    return _Wheel(name, tyre, np.array(body.position) + rotated(body.orientation, placed.point), axes[:, 1])
