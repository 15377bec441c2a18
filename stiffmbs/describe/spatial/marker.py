"""A marker in space: a point and an orientation fixed on a body, or on ground."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from pydantic import Field

from ..fields import Described
from ..marker import MarkerReference
from ..units import si
from .orientation import IDENTITY, Orientation, matrix

if TYPE_CHECKING:
    from .. import given
    from ..building.handle import Handle

Point = tuple[si.Length, si.Length, si.Length]
ORIGIN = (0.0, 0.0, 0.0)


class Placement(Described):
    """Where a named marker sits on its body."""

    point: Point = Field(ORIGIN, description="position in the body's own axes, from its origin, m")
    orientation: Orientation = Field(IDENTITY, description="of the marker's axes against the body's")

    if TYPE_CHECKING:

        def __init__(self, *, point: given.Numbers = ORIGIN, orientation: given.Orientation = IDENTITY) -> None: ...

    def numbers(self) -> tuple[float, ...]:
        """What a kernel takes: the point, the rotation matrix row by row, and the quaternion."""
        return (*self.point, *(float(part) for part in matrix(self.orientation).ravel()), *self.orientation)


class Marker(MarkerReference):
    """A marker used by an element: of a body by name, or given on the spot.

    Written as ``cart`` (the body's origin with its own axes), ``bar.end`` (a marker that the body names), ``ground``, or
    ``{body: bar, point: [-300 mm, 0, 0], orientation: {z: [1, 0, 0]}}``.

    Parameters
    ----------
    body : str
        The body, or ``"ground"``.
    marker : str, optional
        A marker that the body names; excludes `point` and `orientation`.
    point : tuple of float
        Position in the body's own axes, from its origin, m.
    orientation : Orientation
        Of the marker's axes against the body's.  The axis of a joint is z.
    """

    dimensions: ClassVar[int | None] = 3

    point: Point = Field(ORIGIN, description="position in the body's own axes, from its origin, m")
    orientation: Orientation = Field(IDENTITY, description="of the axes against the body's; a joint's axis is z")

    if TYPE_CHECKING:

        def __init__(
            self,
            *,
            body: str | Handle,
            marker: str | None = None,
            point: given.Numbers = ORIGIN,
            orientation: given.Orientation = IDENTITY,
        ) -> None: ...

    def placement(self) -> Placement:
        """Where it sits on its body, as given on the spot."""
        return Placement.model_construct(point=self.point, orientation=self.orientation)  # checked already
