"""What keeps the bodies in the plane: joints that do so, and for those without one a joint that does nothing else."""

from __future__ import annotations

from collections.abc import Iterator

from ...marker import GROUND, MarkerReference
from ...model import PlanarData


def loose(data: PlanarData) -> Iterator[str]:
    """One body of each group of bodies that hold each other in a plane, but not in that of the ground."""
    independent_of = {body: body for body in (GROUND, *data.bodies)}
    for joint in data.joints.values():
        if joint.keeps_in_plane:
            one, other = (independent_of[marker.body] for _, marker in joint.parts(MarkerReference))
            kept, dropped = (other, one) if other == GROUND else (one, other)
            independent_of = {body: kept if own == dropped else own for body, own in independent_of.items()}
    yield from (body for body in data.bodies if independent_of[body] == body)
