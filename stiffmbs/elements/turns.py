"""Full turns of angles: which turn a relative rotation has where an element is set up (docs: Angles and turns).

Angles of bodies in the plane are numbers with full turns. In space, the sign of a quaternion tells an odd number of
turns from an even one. Coordinates of joints, springs and measures keep these turns. An element that holds or measures
a pose, such as a weld or a bushing, has a rotation within half a turn where it is set up.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any, Self

from ..reading.marker import GROUND, Marker

if TYPE_CHECKING:
    from ..model.model_data import ModelData

TURN = 2 * math.pi
GROUND_AXES = "ground_axes"
"""Marker of each node of a beam with axes parallel to those of the scene or part, for joints to bodies with such axes."""
INITIAL_COUNT = 1e-9
"""Centre of the angles within half a turn, rad: half a turn up to rounding counts as positive."""


def full_turns(angle: float, near: float = INITIAL_COUNT) -> int:
    """Return the number of full turns from the angle nearest to another one to a given angle, rad."""
    return round((angle - near) / TURN)


class WithinHalfATurn:
    """Elements that hold or measure the rotation of markers relative to others, within half a turn at their start.

    They have these markers as fields `i` and `j`, or override `_rotations` and `_with`.
    """

    def _rotations(self) -> Iterator[tuple[Any, Any]]:
        """Yield each marker with the marker relative to which its rotation is measured."""
        yield self.i, self.j  # type: ignore[attr-defined]

    def _with(self, markers: Sequence[Any]) -> Self:
        """Return the element with other markers in place of the rotated ones."""
        return self.model_copy(update={"i": markers[0]})  # type: ignore[attr-defined, no-any-return]

    def relative_turns(self, model: ModelData) -> tuple[int, ...]:
        """Return the full turns of the rotations in the poses of a model; in space 1 for an odd number."""
        between = _between_angles if model.dimensions == 2 else _between_quaternions
        return tuple(between(model, i, j) for i, j in self._rotations())

    def without_turns(self, model: ModelData, turns: Sequence[int]) -> Self:
        """Return the element with its rotations reduced by full turns."""
        if not any(turns):
            return self
        back = _angle_back if model.dimensions == 2 else _quaternion_back
        markers = (i for i, _ in self._rotations())
        return self._with([back(model, i, n) if n else i for i, n in zip(markers, turns, strict=True)])

    def at_initial_pose(self, model: ModelData) -> Self:
        """Return the element with rotations within half a turn."""
        return self.without_turns(model, self.relative_turns(model))


class KeepsDescribedTurns(WithinHalfATurn):
    """Elements whose angle counts all turns between the described angles of planar bodies.

    Nodes of beams have no described angles, but directions: an element on one starts within half a turn. So does an
    element that starts to act in a later pose, as in space.
    """

    def at_initial_pose(self, model: ModelData) -> Self:
        """Return the same element, or one with an angle within half a turn on a node of a beam."""
        owners = {marker.body for pair in self._rotations() for marker in pair} - {GROUND}
        directed = any(GROUND_AXES in model.bodies[body].markers for body in owners)
        return self.at_current_pose(model) if directed else self

    def at_current_pose(self, model: ModelData) -> Self:
        """Return the element with an angle within half a turn."""
        return self.without_turns(model, self.relative_turns(model))


def _between_angles(model: ModelData, i: Any, j: Any) -> int:
    return full_turns(model.initial_marker(i).angle - model.initial_marker(j).angle)


def _angle_back(model: ModelData, i: Any, turns: int) -> Any:
    placed = model.place(i)
    return Marker(body=i.body, point=placed.point, angle=placed.angle - TURN * turns)


def _between_quaternions(model: ModelData, i: Any, j: Any) -> int:
    """Return 1 for a rotation beyond half a turn. Half a turn is positive about z, else about y, else about x."""
    from .spatial.orientation import conjugate, product  # not loaded by planar models

    p, q = (_quaternion(model, marker) for marker in (i, j))
    w, x, y, z = product(conjugate(q), p)
    return int(next((part for part in (w, z, y, x) if abs(part) > INITIAL_COUNT / 2), 0) < 0)


def _quaternion_back(model: ModelData, i: Any, turns: int) -> Any:
    placed = model.place(i)
    sign = -1 if turns % 2 else 1
    return type(i)(body=i.body, point=placed.point, orientation=tuple(sign * part for part in placed.orientation))


def _quaternion(model: ModelData, marker: Any) -> Any:
    from .spatial.orientation import product  # not loaded by planar models

    own = model.place(marker).orientation
    return own if marker.body == GROUND else product(model.bodies[marker.body].orientation, own)
