"""Element and section of a geometrically exact beam in space."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Self

from pydantic import Field, field_validator, model_validator

from ....reading.units import si
from ...element import Expr, Symbolic
from ...forces.beam_section import BeamSectionLaw
from ...forces.beam_strain import BeamStrain, Stretch
from ...forces.elastic_matrix import check_symmetric
from ..elastic import AS_WRITTEN, six_rows, without_zeros
from ..marker import Marker
from ..wrench import Pairs, along_axes, force_at, torque_on

_F = si.Force | None
_T = si.Torque | None
_B = si.BendingStiffness | None
_Forces = tuple[_F, _F, _F, _T, _T, _T]
_Moments = tuple[_T, _T, _T, _B, _B, _B]
SectionStiffness = Annotated[tuple[_Forces, _Forces, _Forces, _Moments, _Moments, _Moments], AS_WRITTEN]
_Six = tuple[si.Force, si.Force, si.Force, si.Torque, si.Torque, si.Torque]
_SixMoments = tuple[si.Torque, si.Torque, si.Torque, si.BendingStiffness, si.BendingStiffness, si.BendingStiffness]
Strain = tuple[si.Number, si.Number, si.Number, si.Curvature, si.Curvature, si.Curvature]
UNLOADED: Any = Field(
    (1.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    description="strain without load: 1, 0, 0, and the torsion and curvatures of the axis, rad/m",
)


class ExactBeam(BeamStrain):
    """Massless beam from marker j to marker i with constant strain, for any displacement and rotation.

    The x axes of both markers are tangents without load. The strain Gamma (stretch and shear) and kappa (torsion and
    bending) is constant along the element, so its axis is a helix. With the position d of i's point from j's in j's
    axes and the rotation vector theta of i's axes relative to j's::

        L (Gamma + (1, 0, 0)) = T(theta)^-1 d,  L kappa = theta     (logarithm of the rigid displacement)
        (n, m) = K ((Gamma + (1, 0, 0), kappa) - unloaded) + damping_ratio K (Gamma', kappa')

    With `bowing`, the axial strain is Gamma_1 + 1/2 sum b Gamma_k^2, and an axial force stiffens or softens the shear. A
    slender element of a beam, whose shear stands for bending between its nodes, then neither folds under tension nor
    buckles late. Its b is 6/5, as in the geometric stiffness matrix of beams (Przemieniecki 1968, ch. 15).

    With `shear_centre` or `wagner`, these shears are those of the shear centre y, z, and torsion about it stretches the
    fibres of the section, on average by r^2/2 kappa_1^2 with r^2 = (EI2 + EI3)/EA + y^2 + z^2 (Wagner 1929): tension
    stiffens torsion. The part of this stretch that varies over the section adds w/2 kappa_1^2 to the curvatures
    (`wagner`): bending stiffens or softens torsion. Of both fields, one that is not given is zero.

    n is the axial force and the two shear forces, m the torque and the two bending moments, along the axes of the
    section; they are reported as n1, n2, n3, m1, m2, m3. Its properties, limits and sources are those of the planar
    `exact_beam`.
    """

    kind: ClassVar[str] = "exact_beam"
    channels: ClassVar[tuple[str, ...]] = ("n1", "n2", "n3", "m1", "m2", "m3")
    forms: ClassVar[tuple[Mapping[str, object], ...]] = (
        {"stiffness": (1,) * 6},
        {"stiffness": (1,) * 6, "bowing": (1.2, 1.2)},
        {"stiffness": (1,) * 6, "bowing": (1.2, 1.2), "shear_centre": (0, 1, 1), "wagner": (0, 1, 1)},
    )
    reflected: ClassVar[dict[str, str] | None] = {
        "stiffness": "matrix", "unloaded": "components", "shear_centre": "vector", "wagner": "rotations"
    }  # fmt: skip

    i: Marker = Field(description="marker at the end, on whose body force and torque are reported")
    j: Marker = Field(description="marker at the beginning")
    stiffness: SectionStiffness = Field(
        description="K: EA, GA2, GA3 (N), GJ, EI2, EI3 (N m^2), or a symmetric 6x6 matrix"
    )
    unloaded: Strain = UNLOADED
    shear_centre: si.Point3 | None = Field(
        None,
        description="place of the shear centre from the axis, along axes 1, 2, 3 of the section, for the stretch, m",
    )
    wagner: si.Point3 | None = Field(
        None, description="w of the curvatures by torsion, about axes 1, 2, 3 of the section, m"
    )

    _six_rows = field_validator("stiffness", mode="before")(six_rows)
    _symmetric = field_validator("stiffness")(check_symmetric)
    _sparse = field_validator("stiffness")(without_zeros)

    @model_validator(mode="after")
    def _with_radius(self) -> Self:
        if self.shear_centre is None and self.wagner is None:
            return self
        for k, name in ((0, "EA"), (4, "EI2"), (5, "EI3")):
            if self.stiffness[k][k] is None:
                raise ValueError(f"stiffness: found no {name}, expected it with shear_centre or wagner")
        return self

    @staticmethod
    def stretching(e: Symbolic, strain: list[Expr]) -> list[Stretch]:
        """Return the stretching by bowing and by torsion, with the strains at the shear centre."""
        if e.shear_centre is None and e.wagner is None:
            return BeamStrain.stretching(e, strain)
        _, y, z = e.shear_centre or (0, 0, 0)
        radius = (e.stiffness[4][4] + e.stiffness[5][5]) / e.stiffness[0][0] + y**2 + z**2
        sheared = ((strain[1] - z * strain[3], {1: 1, 3: -z}), (strain[2] + y * strain[3], {2: 1, 3: y}))
        return [
            *(Stretch(0, b, *shear) for b, shear in zip(e.bowing or (), sheared, strict=False)),
            Stretch(0, e.named(radius), strain[3], {3: 1}),
            *(Stretch(4 + k, w, strain[3], {3: 1}) for k, w in enumerate((e.wagner or ())[1:])),
        ]

    @classmethod
    def powers(cls, e: Symbolic) -> Pairs:
        """Return the force on the displacement of i relative to j and the torque on its rotation, in ground axes."""
        along = [effort for effort, _ in cls.relative_powers(e)]
        force, torque = (e.named(along_axes(part, e.j.axes)) for part in (along[:3], along[3:]))
        return [*force_at(e, force, e.i, e.j), *torque_on(torque, e.i, e.j)]


class BeamSection(BeamSectionLaw):
    """Elastic cross section at an inner point of a beam with 3 to 5 nodes, for any displacement and rotation.

    The rigid displacements from a reference node to the others have the screws xi_k. They are interpolated along the
    axis, xi(s) = sum shapes_k xi_k, and the strain of the curve exp(xi(s)) is::

        (Gamma + (1, 0, 0), kappa) = T(xi) xi'
        (n, m) = K ((Gamma + (1, 0, 0), kappa) - unloaded) + damping_ratio K (Gamma', kappa')

    With `stretch`, torsion adds r^2/2 kappa_1^2 to the axial strain, as in `exact_beam`, and tension stiffens torsion.

    n is the axial force and the two shear forces, m the torque and the two bending moments at the section; they are
    reported as n1, n2, n3, m1, m2, m3. Its forces, limits and sources are those of the planar `beam_section`.
    """

    kind: ClassVar[str] = "beam_section"
    channels: ClassVar[tuple[str, ...]] = ("n1", "n2", "n3", "m1", "m2", "m3")

    nodes: tuple[Marker, ...] = Field(
        description="markers of the nodes, whose axes are tangents", min_length=3, max_length=5
    )
    unloaded: Strain = UNLOADED
    stiffness: tuple[_Six, _Six, _Six, _SixMoments, _SixMoments, _SixMoments] = Field(
        description="K: a symmetric 6x6 matrix of EA, GA2, GA3 (N), GJ, EI2, EI3 (N m^2)"
    )
    stretch: si.NumberOrZero = Field(0.0, description="r^2 of the axial strain r^2/2 kappa_1^2 by torsion, m^2")

    _symmetric = field_validator("stiffness")(check_symmetric)
