"""Bodies that carry the coordinates of a flexible body: its floating frame, and its modal coordinates."""

from __future__ import annotations

from typing import Any, ClassVar

from pydantic import Field

from ..body import Body

AXES_HELD, UNUSED_HELD = "{}_axes", "{}_unused"
"""Names of the joints that hold the axes, and the unused coordinates, of a body with modal coordinates."""


class ModalCoordinates(Body):
    """Three modal coordinates of a flexible body as x, y and z, without weight; its axes are held by a joint."""

    weighs: ClassVar[bool] = False
    rigid: ClassVar[bool] = False


class FloatingFrame(Body):
    """Floating frame of a flexible body: mean axes at the centre of mass, with the inertia of the undeformed body."""

    rigid: ClassVar[bool] = False

    # Numbers of inertia and elasticity (`stiffmbs.compile.machine.flexible.sums`) with zero gravity, with an ndarray
    # `array`.
    numbers: Any = Field(None, exclude=True, repr=False)
    modes: tuple[str, ...] = ()  # bodies with its modal coordinates
    # FlexibleBody, and the folder of its files.
    source: Any = Field(None, exclude=True, repr=False)
    notes: tuple[str, ...] = Field((), exclude=True, repr=False)  # on the reduction
