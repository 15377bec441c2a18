"""Interfaces of flexible bodies."""

from __future__ import annotations

from typing import ClassVar

from pydantic import Field

from ...element import Expr, Joint, Symbolic
from ..marker import Marker
from ..primitives import COINCIDE


class FlexibleInterface(Joint):
    """Joint that moves a body with an interface of a flexible body; created with it.

    The point is that of the interface with its modal displacement, and the axes are those of the frame turned by its
    modal rotation vector.
    """

    kind: ClassVar[str] = "flexible_interface"
    equations: ClassVar[tuple[str, ...]] = (*COINCIDE.rows, "about_x", "about_y", "about_z")
    transmits: ClassVar[tuple[str, ...]] = ("fx", "fy", "fz", "tx", "ty", "tz")

    i: Marker = Field(description="marker of the floating frame at the interface")
    j: Marker = Field(description="body of the interface")
    modes: tuple[Marker, ...] = Field(description="bodies with the modal coordinates")
    displacements: tuple[float, ...] = Field(description="displacement by mode along x, y and z")
    rotations: tuple[float, ...] = Field(description="rotation by mode about x, y and z")

    @staticmethod
    def position(e: Symbolic) -> list[Expr]:
        """Return the displacement and rotation of j relative to the interface as deformed by the modes."""
        modal = [mode.body.origin[k] for mode in e.modes for k in range(3)]
        along = []
        for row in range(6):
            shapes = e.displacements if row < 3 else e.rotations
            along.append(e.named(sum(y * shapes[3 * k + row % 3] for k, y in enumerate(modal))))
        moved = sum((d * axis for d, axis in zip(along, e.i.axes, strict=False)), e.i.point)
        turned = e.relative_rotation(e.j, e.i).rotation
        return [*(e.j.point - moved), *(angle - shape for angle, shape in zip(turned, along[3:], strict=True))]
