"""Components, such as roads, and joints to which an element's equations refer."""

from __future__ import annotations

from functools import cached_property, partial
from typing import TYPE_CHECKING, Any

import sympy as sp

from ...elements.element import Joint
from .element import SymbolicElement

if TYPE_CHECKING:
    from ...elements.loads import Loads
    from .spatial_frames import SpatialFrame


class SymbolicComponent:
    """Component with symbols for its numbers; its equations are methods."""

    def __init__(self, component: object, fields: dict[str, object]) -> None:
        self._component = component
        self.__dict__.update(fields)

    def __getattr__(self, name: str) -> Any:
        found = getattr(self._component, name)
        return partial(found, self) if callable(found) else found


class ReferredJoint(SymbolicElement):
    """Joint to which an element refers: its fields, its multipliers, and the referenced coordinate.

    `lam`: multipliers of its equations.
    """

    def __init__(
        self, of: SymbolicElement, joint: Joint, fields: dict[str, object], coordinate: str | None, slot: int
    ) -> None:
        super().__init__(of.frames, fields, of.derivatives, of.states)
        self.kind, self._joint, self._coordinate, self._slot = joint.kind, joint, coordinate, slot
        count = len(list(joint.position(self))) + len(list(joint.velocity(self)))
        self.lam = [sp.Symbol(f"joint{slot}_lam{k}", real=True) for k in range(count)]
        self.angles, self.joint_angles, self.breakpoints = of.angles, of.joint_angles, of.breakpoints

    @cached_property
    def velocity_level(self) -> list[sp.Expr]:
        """Velocity constraints in the order of the multipliers."""
        position = [self.rate(self.read(equation)) for equation in self._joint.position(self)]
        return [*position, *map(self.read, self._joint.velocity(self))]

    @property
    def point(self) -> sp.Matrix:
        """Reference point of its torque."""
        return self._joint.point(self)

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Names of its coordinates."""
        return tuple(self._joint.coordinates)

    @cached_property
    def loads(self) -> Loads:
        """Normal loads on its surfaces."""
        return self._joint.loads(self)

    def channel(self, name: str) -> sp.Expr:
        """Return a free coordinate of the joint, ``angle``, or its rate, ``angle_rate``."""
        coordinate = name.removesuffix("_rate")
        x = self._free(coordinate)
        return self.read(x) if name == coordinate else self.rate(x)

    @cached_property
    def coordinate(self) -> sp.Expr | None:
        """Referenced coordinate, or None; an angle gets a turn counter only if it is used."""
        return None if self._coordinate is None else self._free(self._coordinate)

    def _free(self, coordinate: str) -> sp.Expr:
        first = len(self.angles)
        x = getattr(self._joint, coordinate)(self)
        self.joint_angles.update(dict.fromkeys(range(first, len(self.angles)), (self._slot, coordinate)))
        return x


def measure(name: str, e: SymbolicElement, markers: list[Any]) -> sp.Expr:
    """Return a measure of marker a relative to marker b, optionally in the axes of a third marker.

    Displacements dx dy dz dm, their rates vx vy vz vr and the speed vm; continuous angles ax ay az about b's axes;
    angular velocities wx wy wz wm. Planar models have a subset.
    """
    a, b, *along = markers
    d = a.point - b.point
    match name:
        case "dm":
            return e.distance(a.point, b.point)
        case "vr":
            return e.rate(e.distance(a.point, b.point))
        case "vm":
            return e.distance(e.rate(d), 0 * d)
        case "ax" | "ay" | "az":
            return a.angle_about(name[1], b, e)
        case "wm":
            return e.distance(a.omega, b.omega)
    axes = along[0].axes if along else [sp.eye(len(d))[:, k] for k in range(len(d))]
    match name[0]:
        case "d":
            return d.dot(axes["xyz".index(name[1])])
        case "v":
            return e.rate(d).dot(axes["xyz".index(name[1])])
    return (a.omega - b.omega).dot(axes["xyz".index(name[1])]) if len(d) == 3 else e.rate(a.angle_about("z", b, e))


def own_coordinate(name: str, marker: SpatialFrame) -> sp.Expr:
    """Return a component of a body's quaternion or angular velocity in the body's own axes, those of `marker`."""
    if name[0] == "w":
        return marker.own_omega["xyz".index(name[1])]
    return marker.quaternion[int(name[1])]
