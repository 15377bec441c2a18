"""Spatial rigid bodies."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field, ValidationInfo, WithJsonSchema, field_validator

from ...reading import given
from ...reading.fields import Described
from ...reading.formula.names import SPACE
from ...reading.handle import Handle
from ...reading.units import si
from ..body import check_names
from ..geometry import SpatialGeometry
from .marker import ORIGIN, Marker, Placement, Point
from .orientation import IDENTITY, Orientation, Quaternion, conjugate, from_matrix, product, rotated, unit_quaternion

Row = tuple[si.Inertia, si.Inertia, si.Inertia]
Inertia = Annotated[tuple[Row, Row, Row], WithJsonSchema({"type": "array", "minItems": 3, "maxItems": 3})]
MOMENT_ROUNDING = 1e-9
"""Tolerance of symmetry and of the triangle inequality, relative to the largest moment."""


class Body(Described):
    """Spatial rigid body, with its own origin and axes for everything on it."""

    weighs: ClassVar[bool] = True
    """False for a body without weight."""
    rigid: ClassVar[bool] = True
    """False for a body that carries coordinates of a flexible body, which cannot be merged with others."""

    mass: si.PositiveMass = Field(description="mass, kg")
    any_moments: bool = Field(
        False,
        description="whether a principal moment may be greater than the sum of the other two, which no mass distribution has",
    )
    inertia: Inertia = Field(
        description="Ixx, Iyy, Izz or the symmetric 3x3 tensor (off the diagonal minus the products of inertia) about the centre of mass in the body's own axes, kg m^2"
    )
    center_of_mass: Point = Field(ORIGIN, description="position relative to the body's origin, in its own axes, m")
    position: Point = Field(
        ORIGIN,
        description="position of the body's origin at the start, m; assembly changes the pose if joints require it",
    )
    orientation: Orientation = Field(IDENTITY, description="orientation of the body's own axes at the start")
    velocity: si.Velocity3 = Field(
        (0.0, 0.0, 0.0), description="velocity of the centre of mass at the start, in ground axes, m/s"
    )
    omega: si.AngularVelocity3 = Field(
        (0.0, 0.0, 0.0), description="angular velocity at the start, in the body's own axes, rad/s"
    )
    open: tuple[Literal["velocity", "omega"], ...] = Field(
        (),
        description="which of velocity and omega joints and drives determine at the start; the given value is used if they do not",
    )
    markers: dict[str, Placement] = Field(
        default_factory=dict, description="named points and orientations on the body, in its own axes"
    )
    geometry: SpatialGeometry = Field(
        (),
        description="shapes that drawings show: polyline, box, cylinder, sphere, mesh; by default derived from markers and joints",
    )

    @field_validator("inertia", mode="before")
    @classmethod
    def _diagonal(cls, found: object) -> object:
        """Return the tensor of three moments without products of inertia."""
        if not isinstance(found, list | tuple) or any(np.ndim(part) for part in found):
            return found
        if len(found) != 3:
            raise ValueError(f"found {len(found)} numbers, expected Ixx, Iyy, Izz or a 3x3 tensor")
        return tuple(tuple(part if k == row else 0.0 for k in range(3)) for row, part in enumerate(found))

    @field_validator("inertia")
    @classmethod
    def _of_a_body(cls, inertia: tuple[Row, Row, Row], info: ValidationInfo) -> tuple[Row, Row, Row]:
        largest = max(abs(part) for row in inertia for part in row)
        for row, column in itertools.combinations(range(3), 2):
            one, other = inertia[row][column], inertia[column][row]
            if abs(one - other) > MOMENT_ROUNDING * largest:
                raise ValueError(
                    f"found {one:g} in row {row + 1}, column {column + 1} and {other:g} across the diagonal, "
                    "expected a symmetric tensor"
                )
        small, middle, large = np.linalg.eigvalsh(np.array(inertia))
        if small <= 0:
            raise ValueError(f"found a principal moment of {small:g} kg m^2, expected all three greater than zero")
        if small + middle < large * (1 - MOMENT_ROUNDING) and not info.data.get("any_moments"):
            raise ValueError(
                f"found the principal moments {small:g}, {middle:g} and {large:g} kg m^2, expected none greater than "
                "the sum of the other two"
            )
        return inertia

    @field_validator("markers")
    @classmethod
    def _named(cls, markers: dict[str, Placement]) -> dict[str, Placement]:
        check_names(markers, "marker")
        return markers

    def principal_axes(self) -> Quaternion:
        """Return the orientation of the principal axes in the body's axes; the body's axes for a diagonal tensor."""
        return self._principal()[1]

    def principal_moments(self) -> tuple[float, float, float]:
        """Return the moments of inertia about the principal axes, kg m^2."""
        return self._principal()[0]

    def _principal(self) -> tuple[tuple[float, float, float], Quaternion]:
        (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = self.inertia
        if not any((xy, xz, yx, yz, zx, zy)):
            return (xx, yy, zz), IDENTITY
        moments, axes = np.linalg.eigh(self.inertia)
        axes[:, 2] *= np.sign(np.linalg.det(axes))  # right-handed
        return (float(moments[0]), float(moments[1]), float(moments[2])), from_matrix(axes)

    def coordinates(self) -> tuple[float, ...]:
        """Return the centre of mass (m) and the quaternion of the principal axes at the start, in ground axes."""
        centre = np.array(self.position) + rotated(self.orientation, self.center_of_mass)
        return (*(float(x) for x in centre), *product(self.orientation, self.principal_axes()))

    def in_pose(self, place: Sequence[float]) -> Body:
        """Return the body in another pose: its centre of mass (m) and the quaternion of its own axes, in ground axes."""
        x, y, z, q0, q1, q2, q3 = place
        turned = (q0, q1, q2, q3)
        position = np.array((x, y, z)) - rotated(turned, self.center_of_mass)
        return self.model_copy(update={"position": tuple(map(float, position)), "orientation": turned})

    def rates(self) -> tuple[float, ...]:
        """Return the velocity of the centre of mass in ground axes, m/s, and omega in the principal axes, rad/s."""
        omega = rotated(conjugate(self.principal_axes()), self.omega)
        return (*self.velocity, *(float(x) for x in omega))

    def open_rates(self) -> tuple[bool, ...]:
        """Return for each of `rates` whether it is not prescribed."""
        return (*("velocity" in self.open,) * 3, *("omega" in self.open,) * 3)

    def masses(self) -> tuple[float, ...]:
        """Return the diagonal of the mass matrix: three times the mass, kg, and the principal moments, kg m^2."""
        return self.mass, self.mass, self.mass, *self.principal_moments()

    def carried(self, placed: Placement) -> Placement:
        """Return a placement on the body relative to its centre of mass and principal axes."""
        turned = conjugate(self.principal_axes())
        x, y, z = rotated(turned, np.array(placed.point) - np.array(self.center_of_mass))
        orientation = unit_quaternion(product(turned, placed.orientation))
        return Placement.model_construct(point=(float(x), float(y), float(z)), orientation=orientation)


class BodyHandle(Handle):
    """Reference to a body of a spatial model, returned by `Model.add` (`stiffmbs.reading.handle.Handle`).

    Attributes
    ----------
    name : str
        Name of the body.
    x, y, z, q0, q1, q2, q3, vx, vy, vz, wx, wy, wz : SymPy symbol
        Coordinates and velocities of the body, for formulas.
    mass, inertia and other fields of the body
        Values in the model; assignment changes the model.
    """

    names = SPACE
    fields = Body.model_fields

    def at(
        self, x: given.Number, y: given.Number, z: given.Number, orientation: given.Orientation = IDENTITY
    ) -> Marker:
        """Return the marker at a point given in the body's axes, m, with an orientation relative to them."""
        return Marker(body=self.name, point=(x, y, z), orientation=orientation)
