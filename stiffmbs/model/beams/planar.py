"""Beams in the plane."""

from __future__ import annotations

from typing import ClassVar, Literal

from pydantic import Field

from ...reading.units import si
from .beam import Beam, Bending, InertiaPerLength


class BeamBody(Beam):
    """Geometrically exact beam in the plane: rigid nodes with lumped mass, joined by elements `exact_beam`.

    Its nodes are bodies with the names ``start``, ``node1``, ``node2`` ..., ``end`` and those of its stations, after
    its own name and a dot. A node's axis is the tangent.
    """

    dimensions: ClassVar[Literal[2]] = 2

    start: si.Point2 | None = Field(None, description="its start, m")
    end: si.Point2 | None = Field(None, description="its end, m")
    through: si.Point2 | None = Field(None, description="a further point of an arc from start to end, m")
    points: tuple[si.Point2, ...] | None = Field(
        None, min_length=2, description="in place of start and end: corners of straight pieces, rigidly connected, m"
    )
    stiffness: tuple[si.PositiveForce, si.PositiveForce, Bending] | None = Field(
        None, description="EA, GA (with the shear factor), EI: in place of section and material"
    )
    inertia_per_length: InertiaPerLength | None = Field(
        None, description="rho I, in place of section and material, kg m"
    )
    velocity: si.Velocity2 = Field((0.0, 0.0), description="of its start point at the start of the run, m/s")
    omega: si.AngularVelocity = Field(0.0, description="of the whole beam at the start of the run, rad/s")
