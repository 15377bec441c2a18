"""References to joints and their coordinates by name."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Annotated

from pydantic import WithJsonSchema
from pydantic_core import CoreSchema

from .names import names_of

if TYPE_CHECKING:
    from ..elements.element import Joint

COORDINATES = ("angle", "displacement")
"""Names of the coordinates that drives, couplers and friction can name."""
FREE_COORDINATES = (*COORDINATES, "angle_1", "angle_2", "displacement_x", "displacement_y", "displacement_z")
"""Names of all free coordinates of joints, as channels and in formulas."""
ORDERS = ("", "_rate", "_acceleration")
"""Endings of the channels of a free coordinate, by its order in time: ``angle angle_rate angle_acceleration``."""


def joint_channels(coordinates: Iterable[str], orders: Sequence[str] = ORDERS) -> tuple[str, ...]:
    """Return the channels of free coordinates, with their derivatives in time."""
    return tuple(coordinate + order for coordinate in coordinates for order in orders)


JOINT_CHANNELS = frozenset(joint_channels(FREE_COORDINATES))
"""Channels of the free coordinates of all kinds of joints."""


class JointName(str):
    """Name of a joint of the model, or of one of its coordinates (``sleeve.angle``), in a field of another element."""

    @property
    def joint(self) -> str:
        """Name of the joint."""
        owner, _, last = self.rpartition(".")
        return owner if owner and last in COORDINATES else str(self)

    def coordinate_of(self, joint: Joint) -> str | None:
        """Return the coordinate of the joint that is meant; None if it does not exist or is ambiguous."""
        name = self[len(self.joint) + 1 :]
        if name:
            return name if name in joint.coordinates else None
        return joint.coordinates[0] if len(joint.coordinates) == 1 else None

    @classmethod
    def __get_pydantic_core_schema__(cls, source: object, handler: object) -> CoreSchema:
        from pydantic_core import core_schema

        return core_schema.with_info_after_validator_function(
            lambda text, info: cls(names_of(info).full(text)), core_schema.str_schema()
        )


JointReference = Annotated[
    JointName, WithJsonSchema({"type": "string", "description": "the name of a joint, or of one of its coordinates"})
]
