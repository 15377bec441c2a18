"""What bushings, fields and beams share: six components of force between two markers held together elastically."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Self

from pydantic import Field, WithJsonSchema, field_validator

from ...element import Force, Symbolic
from ...files.quoted import written
from ...forces.matrix import check_symmetric, from_diagonal, product
from ...units import si
from ..marker import Marker
from ..nearest import nearest
from ..wrench import Pairs, along_axes, velocity

if TYPE_CHECKING:
    from ...model_data import ModelData

_Forces = tuple[
    si.Stiffness | None, si.Stiffness | None, si.Stiffness | None,
    si.CouplingStiffness | None, si.CouplingStiffness | None, si.CouplingStiffness | None,
]  # fmt: skip
_Torques = tuple[
    si.CouplingStiffness | None, si.CouplingStiffness | None, si.CouplingStiffness | None,
    si.TorsionalStiffness | None, si.TorsionalStiffness | None, si.TorsionalStiffness | None,
]  # fmt: skip
_ViscousForces = tuple[
    si.Damping | None, si.Damping | None, si.Damping | None,
    si.CouplingDamping | None, si.CouplingDamping | None, si.CouplingDamping | None,
]  # fmt: skip
_ViscousTorques = tuple[
    si.CouplingDamping | None, si.CouplingDamping | None, si.CouplingDamping | None,
    si.TorsionalDamping | None, si.TorsionalDamping | None, si.TorsionalDamping | None,
]  # fmt: skip
_NUMBER: dict[str, Any] = {"anyOf": [{"type": "number"}, {"type": "string"}]}


def _lists(*counts: int) -> dict[str, Any]:
    """The schema of lists in lists, so many in each."""
    if not counts:
        return _NUMBER
    return {"type": "array", "minItems": counts[0], "maxItems": counts[0], "items": _lists(*counts[1:])}


_AS_WRITTEN = WithJsonSchema({"anyOf": [_lists(6), _lists(2, 3), _lists(2, 3, 3), _lists(6, 6)]})
Stiffness = Annotated[
    tuple[_Forces, _Forces, _Forces, _Torques, _Torques, _Torques],
    _AS_WRITTEN,
]
Damping = Annotated[
    tuple[_ViscousForces, _ViscousForces, _ViscousForces, _ViscousTorques, _ViscousTorques, _ViscousTorques],
    _AS_WRITTEN,
]
"""Six by six numbers; None where directions are not coupled, so that nothing is computed for them."""
Preload = tuple[si.Force | None, si.Force | None, si.Force | None, si.Torque | None, si.Torque | None, si.Torque | None]
FORMS = "six numbers, two blocks (of three numbers or 3x3), or six rows of six"
NO_ROW = (None,) * 6
NO_MATRIX = (NO_ROW,) * 6


def six_rows(found: Any) -> Any:
    """The six by six entries that six numbers stand for as a diagonal, or two blocks, of three numbers or three by three."""
    if not isinstance(found, list | tuple):
        raise ValueError(f"found {written(found)}, expected {FORMS}")
    rows = _rows_of_blocks(found) if len(found) == 2 else from_diagonal(found)
    if len(rows) != 6 or any(not isinstance(row, list | tuple) or len(row) != 6 for row in rows):
        raise ValueError(f"found a list of {len(found)}, expected {FORMS}")
    return rows


def without_zeros(found: Any) -> Any:
    """Rows or numbers with None for each zero: what has no stiffness costs nothing, and may turn as far as it likes."""
    if isinstance(found, tuple):
        return tuple(without_zeros(part) for part in found)
    return found or None


def _rows_of_blocks(blocks: Any) -> list[Any]:
    """The rows of a matrix of which two blocks on the diagonal are given; fewer or shorter ones where they do not fit."""
    zeros = (None, None, None)
    first, second = (from_diagonal(block) if isinstance(block, list | tuple) else () for block in blocks)
    lists = [row for row in (*first, *second) if isinstance(row, list | tuple)]
    return [(*row, *zeros) if k < len(first) else (*zeros, *row) for k, row in enumerate(lists)]


class Elastic(Force):
    """Base of elastic connections of six components (it has no kind: scenes name its subclasses).

    The deformation s is the way from j's point to i's along the axes of j, and the rotation vector of i's axes against
    j's in these: its direction is the axis of rotation, its length the angle, rad.  For small angles it is what Adams
    calls a, b and c; it is smooth past half a turn, and the run stops at three quarters of one.  Without an elastic
    moment about just one of j's axes i turns freely about that, over any number of turns: the rotation vector is then
    that of the shortest rotation which takes this axis of j into i's, and the run stops at a tilt of 135 degrees.

    The elastic part of the force follows from a potential U(s): a force -dU/ds on i at its point, and the torque that
    has with the angular velocity the power of -dU/ds with the rates of the rotation vector.  The viscous part is
    -C (v, w), v being the velocity of i's point against j's body, and w the angular velocity, both in j's axes.
    j takes the opposite at the same point of space, so that momentum and angular momentum of both bodies are kept.
    """

    beyond: ClassVar[str] = (
        "found its bodies turned by three quarters of a turn against each other (an axis about which they are free: "
        "tilted by 135 degrees), expected less; a vibration that grows, as shimmy, is told by 'stiffmbs modes' with an earlier --at"
    )
    doubtful: ClassVar[float] = math.sqrt(0.5)  # at half a turn, and at a tilt of 90 degrees
    doubt: ClassVar[str] = (
        "turns its bodies by more than half a turn against each other (an axis about which they are free: tilts it by more than a "
        "right angle)"
    )

    i: Marker = Field(description="marker of the first body, on which force and torque are reported")
    j: Marker = Field(description="marker of the second body, whose axes orient the forces")

    def at_initial_pose(self, model: ModelData) -> Self:
        """Marker i with that sign of its quaternion with which the bodies are drawn less than half a turn apart."""
        return self.model_copy(update={"i": nearest(model, self.i, self.j)})

    @classmethod
    def resisted(cls, e: Symbolic) -> list[bool]:
        """Whether there is an elastic moment about x, y, z."""
        return [True, True, True]

    @classmethod
    def turned(cls, e: Symbolic) -> Any:
        """How marker i is turned, or only tilted, against marker j."""
        resisted = cls.resisted(e)
        return (
            e.shortest_rotation(e.i, e.j, resisted.index(False))
            if resisted.count(False) == 1
            else e.relative_rotation(e.i, e.j)
        )

    @classmethod
    def deformation(cls, e: Symbolic) -> list[Any]:
        """s, m and rad."""
        d = e.named(e.i.point - e.j.point)
        return e.named([*(d.dot(axis) for axis in cls.frame(e)), *cls.turned(e).rotation])

    @classmethod
    def elastic(cls, e: Symbolic) -> list[Any]:
        """-dU/ds: three forces, and three moments on the rates of the rotation vector."""
        raise NotImplementedError

    @classmethod
    def viscosity(cls, e: Symbolic) -> Any:
        """C, six rows."""
        return e.damping

    @classmethod
    def frame(cls, e: Symbolic) -> list[Any]:
        """The unit vectors along which force and way are."""
        return e.j.axes

    @classmethod
    def drift(cls, e: Symbolic) -> Any:
        """The velocity that the force has its power with: of i's point against j's body."""
        return e.rate(e.i.point) - velocity(e, e.j, e.i.point)

    @classmethod
    def powers(cls, e: Symbolic) -> Pairs:
        """A force on the way of i against j, a torque on its turning, both in ground axes: arms and axes then multiply sums."""
        v, w = e.named(cls.drift(e)), e.named(e.i.omega - e.j.omega)
        of_force, of_torque = cls.frame(e), e.j.axes
        rates = e.named([*(v.dot(axis) for axis in of_force), *(w.dot(axis) for axis in of_torque)])
        elastic, viscous = e.named(cls.elastic(e)), product(cls.viscosity(e), rates)
        acting = [*elastic[:3], *cls.turned(e).torque(elastic[3:])]
        along = e.named([f - g for f, g in zip(acting, viscous, strict=True)])
        force, torque = along_axes(along[:3], of_force), along_axes(along[3:], of_torque)
        return [*zip(e.named(force), v, strict=True), *zip(e.named(torque), w, strict=True)]

    @classmethod
    def limits(cls, e: Symbolic) -> Any:
        """How far the bodies may turn, where moments depend on it."""
        return [cls.turned(e).margin] if any(cls.resisted(e)) else []


class Connection(Elastic):
    """Base of elastic connections with a stiffness and damping of their own (it has no kind: scenes name its subclasses)."""

    stiffness: Stiffness = Field(NO_MATRIX, description="K: six numbers, two 3x3 matrices, or a symmetric 6x6 matrix")
    damping: Damping = Field(NO_MATRIX, description="C: six numbers, two 3x3 matrices, or a symmetric 6x6 matrix")

    _six_rows = field_validator("stiffness", "damping", mode="before")(six_rows)
    _symmetric = field_validator("stiffness", "damping")(check_symmetric)
    _sparse = field_validator("stiffness", "damping", "preload", check_fields=False)(without_zeros)

    @classmethod
    def resisted(cls, e: Symbolic) -> list[bool]:
        return has_moments(e.stiffness, e.preload)


def pull_back(stiffness: Any, s: list[Any], preload: Any) -> list[Any]:
    """preload - K s."""
    return [(p or 0) - resisting for p, resisting in zip(preload, product(stiffness, s), strict=True)]


def stored(stiffness: Any, s: list[Any], preload: Any) -> Any:
    """1/2 s^T K s - preload . s, J."""
    resisting = product(stiffness, s)
    return sum(resisting[k] * s[k] / 2 - (preload[k] or 0) * s[k] for k in range(6))


def has_moments(stiffness: Any, preload: Any) -> list[bool]:
    """Whether stiffness and preload have a part in the moments about x, y, z."""
    return [any(part is not None for part in (*stiffness[k], preload[k])) for k in (3, 4, 5)]
