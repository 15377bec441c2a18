"""Spatial model: its kinds of joints and forces, and its named content."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import Field, GetJsonSchemaHandler
from pydantic_core import CoreSchema, core_schema

from ..elements.element import Force
from ..elements.forces.weight import weights
from ..elements.initial_pose import InitialSpatialMarker, initial_element
from ..elements.requests.names import OF_SPACE
from ..elements.requests.order import channels_in
from ..elements.requests.output import CONTINUOUS_ANGLES
from ..elements.requests.output_field import SpatialRequest
from ..elements.spatial.body import Body, BodyHandle
from ..elements.spatial.forces.gyroscopic_torque import turnings
from ..elements.spatial.marker import Placement
from ..elements.spatial.orientation import matrix, product, rotated
from ..elements.spatial.spatial_kinds import FORCES, JOINTS, AnyForce, AnyJoint
from ..elements.turns import TURN
from ..methods import ModelMethods
from ..reading.given import Numbers
from ..reading.marker import GROUND, MarkerReference
from ..reading.units import si
from .model_builder import ModelBuilder
from .model_data import ModelData

if TYPE_CHECKING:
    from pydantic.json_schema import JsonSchemaValue

    from ..elements.states.equation import AngleCounter


class OrFlexible:
    """Marker of bodies that a scene may describe as flexible, for its schema."""

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        from .flexible import FlexibleBody

        FlexibleBody.model_rebuild()
        flexible = core_schema.definitions_schema(FlexibleBody.__pydantic_core_schema__, [])
        return {"anyOf": [handler(schema), handler(flexible)]}


class SpatialData(ModelData):
    """Content of a spatial model."""

    origin = Placement.model_construct()
    output_names = OF_SPACE

    dimensions: Literal[3] = Field(3, description="of the model: space")
    gravity: tuple[si.Acceleration, si.Acceleration, si.Acceleration] = Field(
        (0.0, 0.0, 0.0), description="along the ground's x, y and z, m/s^2"
    )
    markers: dict[str, Placement] = Field(default_factory=dict, description="named points and orientations of ground")
    bodies: dict[str, Annotated[Body, OrFlexible()]] = Field(description="bodies by name")
    joints: dict[str, AnyJoint] = Field(default_factory=dict, description="joints by name")  # type: ignore[valid-type]
    forces: dict[str, AnyForce] = Field(default_factory=dict, description="forces by name")  # type: ignore[valid-type]

    requests: dict[str, SpatialRequest] = Field(
        default_factory=dict, description="formulas to report, by channel name; or several by name under one"
    )

    def angle_counters(self) -> Iterator[tuple[str, AngleCounter]]:
        """Yield counters for the angles az(i, j) in requests; only the integration can count their turns reliably."""
        angles = (
            term for output in self.outputs().values() for term in output.terms if term.function in CONTINUOUS_ANGLES
        )
        of_joints = (name for output in self.outputs().values() for name in channels_in(output) if self._turns(name))
        counted = dict.fromkeys((*map(str, angles), *of_joints))
        if not counted:
            return
        from ..elements.states.equation import counter_of

        for angle in counted:
            yield angle, counter_of(angle, frozenset((*self.bodies, *self.joints)))

    def _turns(self, channel: str) -> bool:
        """Return True for an angle of a joint whose own equations do not count its turns."""
        owner, _, name = channel.rpartition(".")
        joint = self.joints.get(owner)
        return joint is not None and name in joint.free_coordinates() and name.startswith("angle")

    def described_angles(self) -> Mapping[str, float]:
        stated = {name: n for name, joint in self.joints.items() if (n := getattr(joint, "turns", None))}
        return {
            f"{name}.angle": self.joints[name].angle(initial_element(self.joints[name], self)) + TURN * n
            for name, n in {**stated, **self._turns_of_joints}.items()
        }

    def inertial(self, bodies: Mapping[str, Body]) -> Iterable[tuple[str, Force]]:
        """Yield the weights and gyroscopic torques of the bodies."""
        yield from weights({name: body for name, body in bodies.items() if body.weighs}, self.gravity)
        yield from turnings(bodies)
        if not all(body.rigid for body in bodies.values()):
            from ..elements.spatial.flexible.inertia import (
                flexible_inertias,  # models without flexible bodies do not load it
            )

            yield from flexible_inertias(bodies, self.gravity)

    def initial_marker(self, marker: MarkerReference) -> InitialSpatialMarker:
        """Return the point and axes of a marker in the initial pose."""
        placed = self.place(marker)
        if marker.body == GROUND:
            return InitialSpatialMarker(np.array(placed.point), *matrix(placed.orientation).T)
        body = self.bodies[marker.body]
        point = np.array(body.position) + rotated(body.orientation, placed.point)
        return InitialSpatialMarker(point, *matrix(product(body.orientation, placed.orientation)).T)

    def carried(self, marker: MarkerReference) -> tuple[str, Placement]:
        placed = self.place(marker)
        return marker.body, placed if marker.body == GROUND else self.bodies[marker.body].carried(placed)


class Model(ModelMethods, ModelBuilder[SpatialData, Body, BodyHandle]):
    """Spatial model built in Python.

    Examples
    --------
    >>> from stiffmbs.spatial import Body, Marker, Model, Revolute
    >>> model = Model("pendulum", gravity=(0, 0, -9.81))
    >>> bar = model.add("bar", Body(mass=1, inertia=(0.001, 0.03, 0.03), position=(0.3, 0, 0)))
    >>> across = {"z": (0, 1, 0)}
    >>> model.add("hinge", Revolute(i=bar.at(-0.3, 0, 0, across), j=Marker(body="ground", orientation=across)))
    """

    data_type = SpatialData
    body_type = Body
    handle_type = BodyHandle
    kinds = JOINTS, FORCES

    def __init__(self, name: str = "", gravity: Numbers = (0.0, 0.0, 0.0)) -> None:
        super().__init__(name, gravity)
