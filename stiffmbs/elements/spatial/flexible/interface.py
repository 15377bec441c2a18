"""Interfaces of flexible bodies."""

from __future__ import annotations

from typing import Any, ClassVar

from pydantic import Field

from ...element import Joint, Symbolic
from ..marker import Marker
from ..primitives import COINCIDE, ORIENT, perpendicular


class FlexibleInterface(Joint):
    """Joint that moves a body with an interface of a flexible body; created with it.

    The point is that of the interface with its modal displacement psi q, and the axes are those of the frame turned by
    the small rotation theta q. The three equations of orientation are exact to the first order in that rotation.
    """

    kind: ClassVar[str] = "flexible_interface"
    equations: ClassVar[tuple[str, ...]] = (*COINCIDE, *ORIENT)
    transmits: ClassVar[tuple[str, ...]] = ("fx", "fy", "fz", "tx", "ty", "tz")

    i: Marker = Field(description="marker of the floating frame at the interface")
    j: Marker = Field(description="body of the interface")
    modes: tuple[Marker, ...] = Field(description="bodies with the modal coordinates")
    displacements: tuple[float, ...] = Field(description="displacement by mode along x, y and z")
    rotations: tuple[float, ...] = Field(description="rotation by mode about x, y and z")

    @staticmethod
    def position(e: Symbolic) -> Any:
        modal = [mode.body.origin[k] for mode in e.modes for k in range(3)]
        moved, turned = (
            [sum(y * shapes[3 * k + axis] for k, y in enumerate(modal)) for axis in range(3)]
            for shapes in (e.displacements, e.rotations)
        )
        x, y, z = e.i.axes
        theta = turned[0] * x + turned[1] * y + turned[2] * z
        x, y, z = (axis + theta.cross(axis) for axis in (x, y, z))
        apart = e.j.point - e.i.point - moved[0] * e.i.x - moved[1] * e.i.y - moved[2] * e.i.z
        return [*apart, perpendicular(x, e.j.y), perpendicular(y, e.j.z), perpendicular(z, e.j.x)]
