"""Beams in space."""

from __future__ import annotations

from typing import ClassVar, Literal

from pydantic import Field

from ...reading.units import si
from .beam import Beam, Bending, InertiaPerLength


class BeamBody(Beam):
    """Geometrically exact beam in space: rigid nodes with lumped mass, joined by elements `exact_beam`.

    Its nodes are bodies with the names ``start``, ``node1``, ``node2`` ..., ``end`` and those of its stations, after
    its own name and a dot. A node's x axis is the tangent, y and z are axes 2 and 3 of the section.
    """

    dimensions: ClassVar[Literal[3]] = 3

    start: si.Point3 | None = Field(None, description="start point, m")
    end: si.Point3 | None = Field(None, description="end point, m")
    through: si.Point3 | None = Field(None, description="a further point of an arc from start to end, m")
    points: tuple[si.Point3, ...] | None = Field(
        None, min_length=2, description="in place of start and end: corners of straight pieces, rigidly connected, m"
    )
    up: tuple[si.Number, si.Number, si.Number] | None = Field(
        None, description="direction of axis 3 of the section; z by default, or x for a nearly vertical piece"
    )
    stiffness: tuple[si.PositiveForce, si.PositiveForce, si.PositiveForce, Bending, Bending, Bending] | None = Field(
        None, description="EA, GA2, GA3 (with shear factors), GJ, EI2, EI3: in place of section and material"
    )
    inertia_per_length: tuple[InertiaPerLength, InertiaPerLength, InertiaPerLength] | None = Field(
        None, description="moments of inertia per length about axes 1, 2, 3, in place of section and material, kg m"
    )
    velocity: si.Velocity3 = Field(
        (0.0, 0.0, 0.0), description="velocity of the start point at the start of the run, m/s"
    )
    omega: si.AngularVelocity3 = Field(
        (0.0, 0.0, 0.0), description="angular velocity of the whole beam at the start of the run, rad/s"
    )
