"""Element and section of a geometrically exact beam in the plane."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar

from pydantic import Field, WithJsonSchema, field_validator

from ...reading.marker import Marker
from ...reading.units import si
from ..element import Expr, Symbolic
from .beam_section import BeamSectionLaw
from .beam_strain import BeamStrain
from .elastic_matrix import check_symmetric, from_diagonal

_Forces = tuple[si.Force | None, si.Force | None, si.Torque | None]
_Three = tuple[si.Force, si.Force, si.Torque]
SectionStiffness = Annotated[
    tuple[_Forces, _Forces, tuple[si.Torque | None, si.Torque | None, si.BendingStiffness | None]],
    WithJsonSchema({"type": "array", "minItems": 3, "maxItems": 3}),
]
Strain = tuple[si.Number, si.Number, si.Curvature]
_described = "strain without load: 1, 0, and the curvature of the axis, rad/m"
UNLOADED: Any = Field((1.0, 0.0, 0.0), description=_described)


class ExactBeam(BeamStrain):
    """Massless beam from marker j to marker i with constant strain, for any displacement and rotation.

    The axes of both markers are tangents without load. The strain Gamma (stretch and shear) and kappa (curvature) is
    constant along the element, so its axis is an arc. With the position d of i's point from j's in j's axes and the
    angle theta of i's axis relative to j's::

        L (Gamma + (1, 0)) = T(theta)^-1 d,  L kappa = theta     (logarithm of the rigid displacement)
        (n, m) = K ((Gamma + (1, 0), kappa) - unloaded) + damping_ratio K (Gamma', kappa')

    With `bowing`, the axial strain is Gamma_1 + 1/2 sum b Gamma_k^2, and an axial force stiffens or softens the shear. A
    slender element of a beam, whose shear stands for bending between its nodes, then neither folds under tension nor
    buckles late. Its b is 6/5, as in the geometric stiffness matrix of beams (Przemieniecki 1968, ch. 15).

    n is the axial and the shear force and m the bending moment; they are reported as n1, n2 and m3. The element is
    objective and free of locking, and exact for a beam under end moments. The run stops where its ends are turned by
    three quarters of a turn against each other.

    The line body ``beam`` creates such elements together with their nodes (docs: Beams).

    Simo, A finite strain beam formulation, Comput. Methods Appl. Mech. Eng. 49 (1985) 55-70; Sonneville, Cardona, Bruls,
    Geometrically exact beam finite element formulated on the special Euclidean group SE(3), ibid. 268 (2014) 451-474.
    """

    kind: ClassVar[str] = "exact_beam"
    channels: ClassVar[tuple[str, ...]] = ("n1", "n2", "m3")
    forms: ClassVar[tuple[Mapping[str, object], ...]] = (
        {"stiffness": (1, 1, 1)},
        {"stiffness": (1, 1, 1), "bowing": (1.2,)},
    )
    reflected: ClassVar[dict[str, str] | None] = {"stiffness": "matrix", "unloaded": "components"}

    i: Marker = Field(description="marker at the end, on whose body force and torque are reported")
    j: Marker = Field(description="marker at the beginning")
    stiffness: SectionStiffness = Field(description="K: EA, GA (N), EI (N m^2), or a symmetric 3x3 matrix")
    unloaded: Strain = UNLOADED

    _diagonal = field_validator("stiffness", mode="before")(from_diagonal)
    _symmetric = field_validator("stiffness")(check_symmetric)

    @classmethod
    def powers(cls, e: Symbolic) -> list[tuple[Expr, Expr]]:
        return cls.relative_powers(e)


class BeamSection(BeamSectionLaw):
    """Elastic cross section at an inner point of a beam with 3 to 5 nodes, for any displacement and rotation.

    The rigid displacements from a reference node to the others have the screws xi_k. They are interpolated along the
    axis, xi(s) = sum shapes_k xi_k, and the strain of the curve exp(xi(s)) is::

        (Gamma + (1, 0), kappa) = T(xi) xi'
        (n, m) = K ((Gamma + (1, 0), kappa) - unloaded) + damping_ratio K (Gamma', kappa')

    n is the axial and the shear force and m the bending moment at the section; they are reported as n1, n2 and m3. The
    forces on the nodes follow from the strain energy, length times K/2 strain^2. The run stops where a node is turned by
    three quarters of a turn against the reference.

    The line body ``beam`` creates such sections together with their nodes (docs: Beams).

    Sonneville, Cardona, Bruls, Geometrically exact beam finite element formulated on the special Euclidean group SE(3),
    Comput. Methods Appl. Mech. Eng. 268 (2014) 451-474; Wang, Sprague, Jonkman, Johnson, BeamDyn: a high-fidelity wind
    turbine blade solver in the FAST modular framework, Wind Energy 20 (2017) 1439-1462 (Legendre spectral elements).
    """

    kind: ClassVar[str] = "beam_section"
    channels: ClassVar[tuple[str, ...]] = ("n1", "n2", "m3")

    nodes: tuple[Marker, ...] = Field(
        description="markers of the nodes, whose axes are tangents", min_length=3, max_length=5
    )
    unloaded: Strain = UNLOADED
    stiffness: tuple[_Three, _Three, tuple[si.Torque, si.Torque, si.BendingStiffness]] = Field(
        description="K: a symmetric 3x3 matrix of EA, GA (N), EI (N m^2)"
    )

    _symmetric = field_validator("stiffness")(check_symmetric)
