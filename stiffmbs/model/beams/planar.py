"""Beams in the plane."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from pydantic import Field

from ...reading.fields import Measured
from ...reading.units import si
from .beam import Beam

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from ...reading import given

Point = tuple[si.Length, si.Length]
Bending = Annotated[float, Measured("bending stiffness", above=0)]
InertiaPerLength = Annotated[float, Measured("inertia per length", above=0)]


class BeamBody(Beam):
    """Geometrically exact beam in the plane: rigid nodes with lumped mass, joined by elements `exact_beam`.

    Its nodes are bodies with the names ``start``, ``node1``, ``node2`` ..., ``end`` and those of its stations, after
    its own name and a dot. A node's axis is the tangent.

    Parameters
    ----------
    start, end : 2 floats
        Ends, m.
    through : 2 floats, optional
        Another point of an arc, m.
    points : sequence of 2 floats, optional
        In place of `start` and `end`: corners of straight pieces, rigidly connected, m.
    elements : int or sequence of int
        In all, or in each interval between ends, corners and stations.
    interpolation : {'pairs', 'spectral'}
        Of the strain: constant between two nodes, or by polynomials through three to five nodes, of higher order.
    section, material : mappings
        Cross section and material, or in their place `stiffness`, `mass_per_length` and `inertia_per_length`.
    section_end : mapping, optional
    damping : float
        Viscous over elastic stiffness, s.
    stations : mapping of str to float
        Further nodes by their distance from the start, m.
    velocity, omega : 2 floats, float
        Velocity of the start point and angular velocity of the whole beam at the start of the run, m/s, rad/s.
    """

    dimensions: ClassVar[int] = 2

    start: Point | None = Field(None, description="its start, m")
    end: Point | None = Field(None, description="its end, m")
    through: Point | None = Field(None, description="a further point of an arc from start to end, m")
    points: tuple[Point, ...] | None = Field(None, min_length=2, description="corners of straight pieces, m")
    stiffness: tuple[si.PositiveForce, si.PositiveForce, Bending] | None = Field(
        None, description="EA, GA (with the shear factor), EI: in place of section and material"
    )
    inertia_per_length: InertiaPerLength | None = Field(
        None, description="rho I, in place of section and material, kg m"
    )
    velocity: tuple[si.Velocity, si.Velocity] = Field((0.0, 0.0), description="of its start point, m/s")
    omega: si.AngularVelocity = Field(0.0, description="of the whole beam, rad/s")

    if TYPE_CHECKING:

        def __init__(
            self,
            *,
            elements: given.Number | Sequence[int],
            interpolation: str = "pairs",
            start: given.Numbers | None = None,
            end: given.Numbers | None = None,
            through: given.Numbers | None = None,
            points: Sequence[given.Numbers] | None = None,
            section: Mapping[str, Any] | None = None,
            section_end: Mapping[str, Any] | None = None,
            material: Mapping[str, Any] | None = None,
            stiffness: given.Numbers | None = None,
            mass_per_length: given.Number | None = None,
            inertia_per_length: given.Number | None = None,
            damping: given.Number = 0.0,
            stations: Mapping[str, given.Number] = ...,
            velocity: given.Numbers = ...,
            omega: given.Number = ...,
        ) -> None: ...
