"""Spatial model: its kinds of joints and forces, and its named content."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any, Literal

import numpy as np
from pydantic import Field

from ..building.runnable_model import RunnableModel
from ..element import Force, Joint
from ..forces.weight import weights
from ..given import Numbers
from ..kinds import Kinds, any_of
from ..marker import GROUND, MarkerReference
from ..model_data import ModelData
from ..requests.angle_counter import AngleCounter, counter_of
from ..requests.names import OF_SPACE
from ..requests.output import CONTINUOUS_ANGLES
from ..requests.output_field import SpatialRequest
from ..units import si
from . import forces, joints
from .body import Body, BodyHandle
from .forces.gyroscopic_torque import turnings
from .initial_pose import InitialMarker
from .marker import Placement
from .orientation import matrix, product, rotated

JOINTS = Kinds(joints, Joint, 3)
FORCES = Kinds(forces, Force, 3)

AnyJoint: Any = any_of(JOINTS)
AnyForce: Any = any_of(FORCES)


class SpatialData(ModelData):
    """Content of a spatial model."""

    origin = Placement()
    output_names = OF_SPACE

    dimensions: Literal[3] = Field(3, description="of the model: space")
    gravity: tuple[si.Acceleration, si.Acceleration, si.Acceleration] = Field(
        (0.0, 0.0, 0.0), description="along the ground's x, y and z, m/s^2"
    )
    markers: dict[str, Placement] = Field(default_factory=dict, description="named points and orientations of ground")
    bodies: dict[str, Body] = Field(description="bodies by name")
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
        for term in dict.fromkeys(angles):
            yield str(term), counter_of(str(term), frozenset(self.bodies))

    def inertial(self, bodies: Mapping[str, Body]) -> Iterable[tuple[str, Force]]:
        """Yield the weights and gyroscopic torques of the bodies."""
        yield from weights(bodies, self.gravity)
        yield from turnings(bodies)

    def initial_marker(self, marker: MarkerReference) -> InitialMarker:
        """Return a marker with numbers, in ground axes, at the initial pose."""
        placed = self.place(marker)
        if marker.body == GROUND:
            return InitialMarker(np.array(placed.point), matrix(placed.orientation))
        body = self.bodies[marker.body]
        point = np.array(body.position) + rotated(body.orientation, placed.point)
        return InitialMarker(point, matrix(product(body.orientation, placed.orientation)))

    def carried(self, marker: MarkerReference) -> tuple[str, Placement]:
        """Return the body that carries a marker, and the placement from its centre of mass in the principal axes."""
        placed = self.place(marker)
        return marker.body, placed if marker.body == GROUND else self.bodies[marker.body].carried(placed)


class Model(RunnableModel[SpatialData, Body, BodyHandle]):
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
