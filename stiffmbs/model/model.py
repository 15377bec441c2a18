"""Planar model: its kinds of joints and forces, and its named content."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Literal

import numpy as np
from pydantic import Field

from ..elements.body import Body, BodyHandle
from ..elements.element import Force
from ..elements.forces.weight import weights
from ..elements.initial_pose import InitialMarker
from ..elements.planar_kinds import FORCES, JOINTS, AnyForce, AnyJoint
from ..elements.requests.names import OF_PLANE
from ..elements.requests.output_field import PlanarRequest
from ..methods import ModelMethods
from ..reading.given import Numbers
from ..reading.marker import GROUND, MarkerReference, Placement
from ..reading.units import si
from .model_builder import ModelBuilder
from .model_data import ModelData


class PlanarData(ModelData):
    """Content of a planar model."""

    origin = Placement.model_construct()
    output_names = OF_PLANE

    dimensions: Literal[2] = Field(2, description="of the model: the plane")
    gravity: tuple[si.Acceleration, si.Acceleration] = Field(
        (0.0, 0.0), description="along the ground's x and y, m/s^2"
    )
    markers: dict[str, Placement] = Field(default_factory=dict, description="named points and directions of ground")
    bodies: dict[str, Body] = Field(description="bodies by name")
    joints: dict[str, AnyJoint] = Field(default_factory=dict, description="joints by name")  # type: ignore[valid-type]
    forces: dict[str, AnyForce] = Field(default_factory=dict, description="forces by name")  # type: ignore[valid-type]

    requests: dict[str, PlanarRequest] = Field(
        default_factory=dict, description="formulas to report, by channel name; or several by name under one"
    )

    def inertial(self, bodies: Mapping[str, Body]) -> Iterable[tuple[str, Force]]:
        """Return the weights of the bodies."""
        return weights(bodies, self.gravity)

    def initial_marker(self, marker: MarkerReference) -> InitialMarker:
        """Return the point and angle of a marker in the initial pose."""
        placed = self.place(marker)
        if marker.body == GROUND:
            return InitialMarker(np.array(placed.point), placed.angle)
        (x, y), phi = self.bodies[marker.body].position, self.bodies[marker.body].angle
        (xi, eta), c, s = placed.point, math.cos(phi), math.sin(phi)
        return InitialMarker(np.array([x + c * xi - s * eta, y + s * xi + c * eta]), phi + placed.angle)

    def carried(self, marker: MarkerReference) -> tuple[str, Placement]:
        return marker.body, self.place(marker)


class Model(ModelMethods, ModelBuilder[PlanarData, Body, BodyHandle]):
    """Planar model built in Python.

    Examples
    --------
    >>> from stiffmbs import Body, Model, Prismatic, Revolute
    >>> model = Model("cart-pendulum", gravity=(0, -9.81))
    >>> cart = model.add("cart", Body(mass=10, inertia=1))
    >>> bar = model.add("bar", Body(mass=1, inertia=0.03, position=(0.3, 0)))
    >>> model.add("rail", Prismatic(i="cart", j="ground"))
    >>> model.add("hinge", Revolute(i=bar.at(-0.3, 0), j="cart"))
    """

    data_type = PlanarData
    body_type = Body
    handle_type = BodyHandle
    kinds = JOINTS, FORCES

    def __init__(self, name: str = "", gravity: Numbers = (0.0, 0.0)) -> None:
        super().__init__(name, gravity)
