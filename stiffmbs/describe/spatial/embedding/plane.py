"""Constraints that keep bodies in the plane: their joints, or additional planar joints."""

from __future__ import annotations

from collections.abc import Iterator

from ...marker import GROUND, MarkerReference
from ...model import PlanarData


def loose(data: PlanarData) -> Iterator[str]:
    """Yield one body of each group that is connected in a common plane, but not to the ground's plane."""
    independent_of = {body: body for body in (GROUND, *data.bodies)}
    for joint in data.joints.values():
        if joint.keeps_in_plane:
            one, other = (independent_of[marker.body] for _, marker in joint.parts(MarkerReference))
            kept, dropped = (other, one) if other == GROUND else (one, other)
            independent_of = {body: kept if own == dropped else own for body, own in independent_of.items()}
    yield from (body for body in data.bodies if independent_of[body] == body)
