"""Planar rigid bodies."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, fields
from itertools import chain
from typing import TYPE_CHECKING, ClassVar, TypeAlias

from pydantic import Field, field_validator

from ..reading import given
from ..reading.fields import Described, is_name, other_letters
from ..reading.files.quoted import written
from ..reading.files.yaml_text import quotes_hint
from ..reading.formula.names import PLANE
from ..reading.handle import Handle
from ..reading.marker import Marker, Placement
from ..reading.units import si
from .geometry import PlanarGeometry

if TYPE_CHECKING:
    from .spatial.body import Body as SpatialBody

AnyBody: TypeAlias = "Body | SpatialBody"
"""Body of a planar or spatial model."""

FLEXIBLE = "flexible"
"""Type of a flexible body in a scene."""

SURFACE_LOAD = "surface_load"
"""Type of a load on a surface of a flexible body in a scene."""


def is_surface_load(entry: object) -> bool:
    """Return True for an entry of such a load, as it is written in a scene."""
    return isinstance(entry, dict) and entry.get("type") == SURFACE_LOAD


def is_flexible(entry: object) -> bool:
    """Return True for an entry of a flexible body, as it is written in a scene."""
    return isinstance(entry, dict) and entry.get("type") == FLEXIBLE


class Body(Described):
    """Planar rigid body with the coordinates x, y of its centre of mass and its angle phi."""

    written_as: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("center_of_mass", "centre_of_mass"),
        "points of joints and forces relative to the centre of mass, which is the origin of a planar body",
    )

    rigid: ClassVar[bool] = True
    """True for all planar bodies: fixed joints may merge them."""

    mass: si.PositiveMass = Field(description="mass, kg")
    inertia: si.PositiveInertia = Field(description="moment of inertia about the centre of mass, kg m^2")
    position: si.Point2 = Field(
        (0.0, 0.0), description="centre of mass at the start, m; assembly changes it if joints require it"
    )
    angle: si.Angle = Field(0.0, description="angle at the start, rad")
    velocity: si.Velocity2 = Field((0.0, 0.0), description="velocity of the centre of mass at the start, m/s")
    omega: si.AngularVelocity = Field(0.0, description="angular velocity at the start, rad/s")
    markers: dict[str, Placement] = Field(default_factory=dict, description="named points and directions on the body")
    geometry: PlanarGeometry = Field(
        (),
        description="shapes that drawings show: polyline, box, cylinder, sphere, mesh; by default derived from markers and joints",
    )

    @field_validator("markers")
    @classmethod
    def _named(cls, markers: dict[str, Placement]) -> dict[str, Placement]:
        check_names(markers, "marker")
        return markers

    def coordinates(self) -> tuple[float, ...]:
        """Return x, y (m) of the centre of mass and the angle phi (rad) at the start."""
        return (*self.position, self.angle)

    def in_pose(self, place: Sequence[float]) -> Body:
        """Return the body in another pose: x, y (m) of the centre of mass and the angle phi (rad)."""
        x, y, angle = place
        return self.model_copy(update={"position": (x, y), "angle": angle})

    def rates(self) -> tuple[float, ...]:
        """Return the rates of `coordinates` at the start, m/s and rad/s."""
        return (*self.velocity, self.omega)

    def open_rates(self) -> tuple[bool, ...]:
        """Return for each of `rates` whether it is left open: never in the plane."""
        return False, False, False

    def masses(self) -> tuple[float, ...]:
        """Return the diagonal of the body's mass matrix, kg, kg and kg m^2."""
        return self.mass, self.mass, self.inertia


class LineBody(Described):
    """Base of entries that consist of several bodies and elements, such as beams and flexible bodies."""

    def add_to(self, model: object, name: str) -> object:
        """Add the bodies and elements to a model built in Python, and return a handle."""
        raise NotImplementedError

    def depends_on(self) -> str:
        """Return the name of another one whose numbers it contains; an empty text for none."""
        return ""

    def allows(self, old: object, new: object) -> bool:
        """Return True if one of its bodies or elements in a model may be replaced alone."""
        return True


class BodyHandle(Handle):
    """Reference to a body of a planar model, returned by `Model.add` (`stiffmbs.reading.handle.Handle`).

    Attributes
    ----------
    name : str
        Name of the body.
    x, y, angle, vx, vy, omega : SymPy symbol
        Coordinates and velocities of the body, for formulas.
    mass, inertia and other fields of the body
        Values in the model; assignment changes the model.
    """

    names = PLANE
    fields = Body.model_fields

    def at(self, xi: given.Number, eta: given.Number, angle: given.Number = 0.0) -> Marker:
        """Return the marker at a point given in the body's axes, m, rotated by `angle`, rad."""
        return Marker(body=self.name, point=(xi, eta), angle=angle)


@dataclass(frozen=True)
class BodyNumbers:
    """Initial values and masses of all bodies, concatenated."""

    # coordinates, rates: described values at the start
    coordinates: tuple[float, ...]
    rates: tuple[float, ...]
    open_rates: tuple[bool, ...]  # True for each rate that is not given
    masses: tuple[float, ...]  # diagonal of the mass matrix


def body_numbers(bodies: Collection[AnyBody]) -> BodyNumbers:
    """Return the concatenated numbers of the given bodies."""
    names = (field.name for field in fields(BodyNumbers))
    return BodyNumbers(*(tuple(chain.from_iterable(getattr(body, name)() for body in bodies)) for name in names))


def check_names(names: Iterable[object], what: str) -> None:
    """Refuse names that are not valid in formulas and channels."""
    for name in names:
        if not is_name(name, dotted=True):
            shown = "no name" if name in (None, "") else f"the name {written(name)}"
            raise ValueError(
                f"found {what} with {shown}, expected letters, digits and _ not starting with a digit{quotes_hint(name)}{other_letters(name)}"
            )
