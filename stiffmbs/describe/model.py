"""The model: bodies, joints and forces by name, checked as a whole."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from functools import reduce
from operator import or_
from typing import Annotated, Any, cast

from pydantic import Field, field_validator, model_validator

from ..errors import InputError
from . import forces, joints, si
from .body import Body, BodyHandle, check_names
from .element import Element, Force, Joint, JointName, kinds
from .fields import Described
from .forces.weight import Weight
from .formula import UNIT
from .formula_field import TIME, Formula, OfMotion
from .marker import GROUND, Marker, Placement
from .quantity import UNITS
from .request import Request

JOINTS = kinds(joints, Joint)
FORCES = kinds(forces, Force)
RESERVED = (GROUND, "energy", "constraint", "time", TIME, UNIT)

AnyJoint: Any = Annotated[reduce(or_, JOINTS.values()), Field(discriminator="type")]
AnyForce: Any = Annotated[reduce(or_, FORCES.values()), Field(discriminator="type")]


class ModelData(Described):
    """What a model holds, as it stands in a scene; checked as a whole.

    Parameters
    ----------
    name : str
        Shown in summaries.
    gravity : tuple of float
        Acceleration along the ground's x and y, m/s^2.
    bodies, joints, forces, requests : mappings by name
        Names are shared by all, as channels are named after them.
    """

    name: str = Field("", description="shown in summaries")
    gravity: tuple[si.Acceleration, si.Acceleration] = Field(
        (0.0, 0.0), description="along the ground's x and y, m/s^2"
    )
    bodies: dict[str, Body] = Field(description="bodies by name")
    joints: dict[str, AnyJoint] = Field(default_factory=dict, description="joints by name")  # type: ignore[valid-type]
    forces: dict[str, AnyForce] = Field(default_factory=dict, description="forces by name")  # type: ignore[valid-type]
    requests: dict[str, OfMotion] = Field(default_factory=dict, description="formulas to report, by channel name")

    @field_validator("bodies", "joints", "forces", "requests", mode="before")
    @classmethod
    def _names(cls, named: Any, info: Any) -> Any:
        if isinstance(named, dict):
            check_names(named, "entry")
            for name in named:
                if name in RESERVED:
                    raise ValueError(f"found the name '{name}', which is reserved, expected another")
        return named

    @field_validator("requests", mode="before")
    @classmethod
    def _no_unit_meant_as_a_request(cls, named: Any) -> Any:
        if isinstance(named, dict):
            units = "|".join(re.escape(name) for name in named if name in UNITS)
            for text in named.values():
                used = re.search(rf"(?<![\w.])({units})(?![\w.(])", text) if units and isinstance(text, str) else None
                if used:
                    name = used.group()
                    raise ValueError(
                        f"found '{name}' in '{text}', which is a unit and a request, expected one or the other"
                    )
        return named

    @model_validator(mode="after")
    def _whole(self) -> ModelData:
        if not self.bodies:
            raise ValueError("bodies: found no body, expected at least one")
        seen: dict[str, str] = {}
        for section in ("bodies", "joints", "forces", "requests"):
            for name in getattr(self, section):
                if name in seen:
                    raise ValueError(f"{section}.{name}: found a name that {seen[name]} has too, expected another")
                seen[name] = f"{section}.{name}"
        for section in ("joints", "forces"):
            for name, element in getattr(self, section).items():
                check_element(f"{section}.{name}", element, self.bodies, self.joints)
        for name, formula in self.requests.items():
            check_element(f"requests.{name}", Request(formula=formula), self.bodies, self.joints)
        return self

    def elements(self) -> Iterator[tuple[str, Element]]:
        """Every joint, force, request and weight with its name (a weight has its body's)."""
        for name, element in (*self.joints.items(), *self.forces.items()):
            yield name, element.as_drawn(self)
        for name, formula in self.requests.items():
            yield name, Request(formula=formula)
        if self.gravity != (0.0, 0.0):
            for name, body in self.bodies.items():
                yield name, Weight(i=name, mass=body.mass, gravity=self.gravity)

    def size(self) -> float:
        """Diagonal of the box around all bodies and markers at the start, m; 1 where it is a single point."""
        points = [body.position for body in self.bodies.values()]
        for _, element in (*self.joints.items(), *self.forces.items()):
            points += [self.point(marker) for _, marker in element.markers()]
        width, height = (max(p[k] for p in points) - min(p[k] for p in points) for k in (0, 1))
        return math.hypot(width, height) or 1.0

    def point(self, marker: Marker) -> tuple[float, float]:
        """Where a marker is in ground axes at the start, m."""
        xi, eta = self.place(marker).point
        if marker.body == GROUND:
            return xi, eta
        (x, y), phi = self.bodies[marker.body].position, self.bodies[marker.body].angle
        return x + math.cos(phi) * xi - math.sin(phi) * eta, y + math.sin(phi) * xi + math.cos(phi) * eta

    def place(self, marker: Marker) -> Placement:
        """Where a marker sits on its body."""
        if marker.marker is None:
            return Placement(point=marker.point, angle=marker.angle)
        return self.bodies[marker.body].markers[marker.marker]


def check_element(where: str, element: Element, bodies: dict[str, Body], joints: dict[str, Joint]) -> None:
    """Refuse an element that names an unknown body, marker or joint, or that joins a body to itself."""
    for field, marker in element.markers():
        if marker.body != GROUND and marker.body not in bodies:
            raise ValueError(f"{where}.{field}: found the unknown body '{marker.body}', expected {_listed(bodies)}")
        if marker.marker is not None:
            own = {} if marker.body == GROUND else bodies[marker.body].markers
            if marker.marker not in own:
                raise ValueError(
                    f"{where}.{field}: found '{marker.label}', expected one of its markers ({', '.join(own) or 'none'})"
                )
    for field, joint in element.parts(JointName):
        if joint not in joints:
            raise ValueError(
                f"{where}.{field}: found the unknown joint '{joint}', expected one of {', '.join(joints) or 'none'}"
            )
        if next(joints[joint].parts(JointName), None):
            raise ValueError(
                f"{where}.{field}: found '{joint}', which refers to a joint itself, expected one between markers"
            )
    for field, reason in element.refused(joints):
        raise ValueError(f"{where}.{field}: {reason}")
    for field, formula in element.parts(Formula):
        for body in formula.bodies():
            if body not in (*bodies, GROUND):
                raise ValueError(f"{where}.{field}: found the unknown body '{body}', expected {_listed(bodies)}")
    placed = [marker.body for _, marker in element.parts(Marker)]
    if len(placed) > 1 and len(set(placed)) == 1:
        raise ValueError(f"{where}: found '{placed[0]}' on both sides, expected two different bodies")


def _listed(bodies: dict[str, Body]) -> str:
    names = list(bodies)
    return ", ".join([*names[:8], *(["..."] if len(names) > 8 else []), GROUND])


class Model:
    """A model built in Python, piece by piece.

    Examples
    --------
    >>> from stiffmbs import Body, Model, Prismatic, Revolute
    >>> model = Model("cart-pendulum", gravity=(0, -9.81))
    >>> cart = model.add("cart", Body(mass=10, inertia=1))
    >>> bar = model.add("bar", Body(mass=1, inertia=0.03, position=(0.3, 0)))
    >>> model.add("rail", Prismatic(i="cart", j="ground"))
    >>> model.add("hinge", Revolute(i=bar.at(-0.3, 0), j="cart"))
    """

    def __init__(self, name: str = "", gravity: tuple[float | str, float | str] = (0.0, 0.0)) -> None:
        self.name = name
        self.gravity = gravity
        self.bodies: dict[str, Body] = {}
        self.joints: dict[str, Joint] = {}
        self.forces: dict[str, Force] = {}
        self.requests: dict[str, Formula] = {}

    def add(self, name: str, part: Body | Joint | Force) -> BodyHandle | None:
        """Add a body (its handle is returned), a joint or a force under a name.

        Raises
        ------
        InputError
            When the name is taken, reserved or no identifier, or the part names an unknown body.
        """
        section: dict[str, Any]
        match part:
            case Body():
                section = cast(dict[str, Any], self.bodies)
            case Joint():
                section = cast(dict[str, Any], self.joints)
            case Force():
                section = cast(dict[str, Any], self.forces)
            case _:
                raise InputError(f"{name}: found {part!r}, expected a body, a joint or a force")
        self._check(name, part)
        section[name] = part
        return BodyHandle(name) if isinstance(part, Body) else None

    def request(self, name: str, formula: str) -> None:
        """Report a formula of coordinates, velocities, measures and time as a channel of the given name.

        Raises
        ------
        InputError
            As for `add`, and for a formula that cannot be read.
        """
        request = Request(formula=formula)  # type: ignore[arg-type]
        self._check(name, request)
        self.requests[name] = request.formula  # type: ignore[assignment]

    def _check(self, name: str, part: Body | Element) -> None:
        taken = {*self.bodies, *self.joints, *self.forces, *self.requests, *RESERVED}
        if name in taken:
            raise InputError(f"{name}: found a name that is taken or reserved, expected another")
        try:
            check_names({name: part}, "part")
            if isinstance(part, Element):
                check_element(name, part, self.bodies, self.joints)
        except ValueError as error:
            raise InputError(str(error)) from None

    def data(self) -> ModelData:
        """The model as it would stand in a scene.

        Raises
        ------
        InputError
            When the model has no body.
        """
        return ModelData(
            name=self.name, gravity=self.gravity, bodies=self.bodies, joints=self.joints, forces=self.forces,
            requests=self.requests,
        )  # fmt: skip
