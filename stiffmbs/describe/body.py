"""Planar rigid bodies."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Any

from pydantic import Field, field_validator

from .fields import DOTTED_PATTERN, Described
from .files.quoted import written
from .marker import Marker, Placement
from .units import si


class Body(Described):
    """A planar rigid body: coordinates x, y of its centre of mass and its angle phi.

    Parameters
    ----------
    mass : float
        kg, greater than zero.
    inertia : float
        About the centre of mass, kg m^2, greater than zero.
    position, angle : floats
        Where the centre of mass is and how the body is turned at the start (moved by assembly if joints ask), m, rad.
    velocity, omega : floats
        At the start, m/s, rad/s.
    markers : mapping of str to Placement
        Named points and directions on the body.
    """

    mass: si.PositiveMass = Field(description="mass, kg")
    inertia: si.PositiveInertia = Field(description="moment of inertia about the centre of mass, kg m^2")
    position: tuple[si.Length, si.Length] = Field((0.0, 0.0), description="centre of mass at the start, m")
    angle: si.Angle = Field(0.0, description="angle at the start, rad")
    velocity: tuple[si.Velocity, si.Velocity] = Field(
        (0.0, 0.0), description="velocity of the centre of mass at the start, m/s"
    )
    omega: si.AngularVelocity = Field(0.0, description="angular velocity at the start, rad/s")
    markers: dict[str, Placement] = Field(default_factory=dict, description="named points and directions on the body")

    @field_validator("markers")
    @classmethod
    def _named(cls, markers: dict[str, Placement]) -> dict[str, Placement]:
        check_names(markers, "marker")
        return markers

    def coordinates(self) -> tuple[float, ...]:
        """x, y (m) of the centre of mass and the angle phi (rad) at the start."""
        return (*self.position, self.angle)

    def rates(self) -> tuple[float, ...]:
        """The rates of `coordinates` at the start, m/s and rad/s."""
        return (*self.velocity, self.omega)

    def open_rates(self) -> tuple[bool, ...]:
        """Which of `rates` are not given: none."""
        return False, False, False

    def masses(self) -> tuple[float, ...]:
        """Diagonal of the body's mass matrix, kg, kg and kg m^2."""
        return self.mass, self.mass, self.inertia


class BodyHandle:
    """A body of a model, as `Model.add` returns it: a shorthand for its markers and coordinates."""

    def __init__(self, name: str) -> None:
        self.name = name

    def at(self, xi: float | str, eta: float | str, angle: float | str = 0.0) -> Marker:
        """The marker at a point of the body's own axes, m, turned by `angle`, rad."""
        return Marker(body=self.name, point=(xi, eta), angle=angle)

    def __getattr__(self, coordinate: str) -> Any:
        """The SymPy symbol of a coordinate (``x``, ``y``, ``angle``), for `ConstraintEquation`."""
        if coordinate not in ("x", "y", "angle"):
            raise AttributeError(f"a body has the coordinates x, y and angle, not '{coordinate}'")
        import sympy

        return sympy.Symbol(f"{self.name}.{coordinate}", real=True)


def check_names(names: Iterable[object], what: str) -> None:
    """Refuse names that could not stand in a formula or a channel."""
    for name in names:
        if not isinstance(name, str) or not re.match(DOTTED_PATTERN, name):
            shown = "no name" if name in (None, "") else f"the name {written(name)}"
            raise ValueError(f"found {what} with {shown}, expected letters, digits and _ not starting with a digit")
