"""Base of bushings, fields and beams: six-component elastic forces between two markers."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated, Any

from pydantic import Field, WithJsonSchema, field_validator

from ...reading.files.quoted import written
from ...reading.units import si
from ..element import Expr, Force, Matrix, Symbolic
from ..forces.elastic_matrix import C, Cc, Ct, K, Kc, Kt, Rows, check_symmetric, from_diagonal, times
from ..turns import INITIAL_COUNT, WithinHalfATurn
from .marker import Marker
from .wrench import Pairs, along_axes, velocity

_Forces = tuple[K, K, K, Kc, Kc, Kc]
_Torques = tuple[Kc, Kc, Kc, Kt, Kt, Kt]
_ViscousForces = tuple[C, C, C, Cc, Cc, Cc]
_ViscousTorques = tuple[Cc, Cc, Cc, Ct, Ct, Ct]
_NUMBER: dict[str, object] = {"anyOf": [{"type": "number"}, {"type": "string"}]}


def _lists(*counts: int) -> dict[str, object]:
    """Return the schema of nested lists of the given lengths."""
    if not counts:
        return _NUMBER
    return {"type": "array", "minItems": counts[0], "maxItems": counts[0], "items": _lists(*counts[1:])}


AS_WRITTEN = WithJsonSchema({"anyOf": [_lists(6), _lists(2, 3), _lists(2, 3, 3), _lists(6, 6)]})
Stiffness = Annotated[tuple[_Forces, _Forces, _Forces, _Torques, _Torques, _Torques], AS_WRITTEN]
Damping = Annotated[
    tuple[_ViscousForces, _ViscousForces, _ViscousForces, _ViscousTorques, _ViscousTorques, _ViscousTorques], AS_WRITTEN
]
"""Symmetric 6 x 6 matrix; None for uncoupled directions, for which nothing is computed."""
Preload = tuple[si.Force | None, si.Force | None, si.Force | None, si.Torque | None, si.Torque | None, si.Torque | None]
FORMS = "six numbers, two blocks (of three numbers or 3x3), or six rows of six"
NO_ROW = (None,) * 6
NO_MATRIX = (NO_ROW,) * 6


def six_rows(found: object) -> Any:
    """Return the 6 x 6 entries of a diagonal of six numbers, or of two blocks of three numbers or 3 x 3."""
    if not isinstance(found, list | tuple):
        raise ValueError(f"found {written(found)}, expected {FORMS}")
    rows = _rows_of_blocks(found) if len(found) == 2 else from_diagonal(found)
    if len(rows) != 6 or any(not isinstance(row, list | tuple) or len(row) != 6 for row in rows):
        raise ValueError(f"found a list of {len(found)}, expected {FORMS}")
    return rows


def without_zeros(found: object) -> object:
    """Replace zeros by None: a direction without stiffness requires no computation, and its rotation is unlimited."""
    if isinstance(found, tuple):
        return tuple(without_zeros(part) for part in found)
    return found or None


def _rows_of_blocks(blocks: Any) -> list[Any]:
    """Return the rows of a matrix with two diagonal blocks; fewer or shorter ones if they do not fit."""
    zeros = (None, None, None)
    first, second = (from_diagonal(block) if isinstance(block, list | tuple) else () for block in blocks)
    lists = [row for row in (*first, *second) if isinstance(row, list | tuple)]
    return [(*row, *zeros) if k < len(first) else (*zeros, *row) for k, row in enumerate(lists)]


class Elastic(WithinHalfATurn, Force):
    """Base of elastic connections of six components; scenes use its subclasses.

    The deformation s is the displacement of i's point from j's and the rotation vector of i's axes relative to j's,
    both in the axes of j. Its direction is the axis of rotation, its length the angle, rad. For small angles it is
    Adams' a, b and c. It is smooth beyond half a turn, and the run stops at three quarters of a turn. Without an
    elastic moment about exactly one of j's axes i can rotate about it without limit. The rotation vector is then that
    of the shortest rotation that takes this axis of j to i's, and the run stops at a tilt of 135 degrees.

    The elastic part follows from a potential U(s): the force -dU/ds on i at its point, and the torque conjugate to the
    rates of the rotation vector. The viscous part is -C (v, w), with the velocity v of i's point relative to j's body
    and the relative angular velocity w, both in j's axes. The opposite acts on j at the same point of space, so linear
    and angular momentum are conserved.
    """

    beyond = (
        "found its bodies rotated by three quarters of a revolution relative to each other (an axis about which they are free: "
        "tilted by 135 degrees), expected less; a vibration that grows, as shimmy, is shown by 'stiffmbs modes' with an earlier --at"
    )
    doubtful = math.sqrt(0.5) - INITIAL_COUNT / 2  # half a turn up to rounding, or a tilt of 90 degrees
    doubt = (
        "rotates its bodies by more than half a revolution relative to each other (an axis about which they are free: tilts it by more than a "
        "right angle)"
    )

    i: Marker = Field(description="marker of the first body, on which force and torque are reported")
    j: Marker = Field(description="marker of the second body, whose axes orient the forces")

    @classmethod
    def resisted(cls, e: Symbolic) -> list[bool]:
        """Return True for each axis x, y, z with an elastic moment."""
        return [True, True, True]

    @classmethod
    def turned(cls, e: Symbolic) -> Expr:
        """Return the rotation, or only the tilt, of marker i relative to marker j."""
        resisted = cls.resisted(e)
        if resisted.count(False) == 1:
            return e.shortest_rotation(e.i, e.j, resisted.index(False))
        return e.relative_rotation(e.i, e.j)

    @classmethod
    def deformation(cls, e: Symbolic) -> list[Expr]:
        """Return s, m and rad."""
        d = e.named(e.i.point - e.j.point)
        return e.named([*(d.dot(axis) for axis in cls.frame(e)), *cls.turned(e).rotation])

    @classmethod
    def elastic(cls, e: Symbolic) -> list[Expr]:
        """Return -dU/ds: three forces, and three moments on the rates of the rotation vector."""
        raise NotImplementedError

    @classmethod
    def viscosity(cls, e: Symbolic) -> Rows:
        """Return C, six rows."""
        return e.damping

    @classmethod
    def frame(cls, e: Symbolic) -> list[Matrix]:
        """Return the unit vectors along which force and displacement are resolved."""
        return e.j.axes

    @classmethod
    def drift(cls, e: Symbolic) -> Matrix:
        """Return the velocity conjugate to the force: that of i's point relative to j's body."""
        return e.rate(e.i.point) - velocity(e, e.j, e.i.point)

    @classmethod
    def velocities(cls, e: Symbolic) -> tuple[Matrix, Matrix]:
        """Return the velocity v and the angular velocity w of i relative to j, in ground axes."""
        return e.named(cls.drift(e)), e.named(e.i.omega - e.j.omega)

    @classmethod
    def components(cls, e: Symbolic) -> list[Expr]:
        """Return those of (v, w) along the axes of the deformation."""
        v, w = cls.velocities(e)
        return e.named([*(v.dot(axis) for axis in cls.frame(e)), *(w.dot(axis) for axis in e.j.axes)])  # type: ignore[no-any-return]

    @classmethod
    def load(cls, e: Symbolic) -> list[Expr]:
        """Return force and torque on i along the axes of the deformation: the elastic part less C (v, w)."""
        rates = cls.components(e)
        elastic, viscous = e.named(cls.elastic(e)), times(cls.viscosity(e), rates)
        acting = [*elastic[:3], *cls.turned(e).torque(elastic[3:])]
        return e.named([f - g for f, g in zip(acting, viscous, strict=True)])  # type: ignore[no-any-return]

    @classmethod
    def powers(cls, e: Symbolic) -> Pairs:
        """Return the force on the velocity of i relative to j and the torque on its rotation, in ground axes."""
        (v, w), load = cls.velocities(e), cls.load(e)
        force, torque = along_axes(load[:3], cls.frame(e)), along_axes(load[3:], e.j.axes)
        return [*zip(e.named(force), v, strict=True), *zip(e.named(torque), w, strict=True)]

    @classmethod
    def condensed_powers(cls, e: Symbolic) -> Pairs:
        return list(zip(cls.load(e), cls.components(e), strict=True))

    @classmethod
    def limits(cls, e: Symbolic) -> list[Expr]:
        """Return the margin of the relative rotation, if there are moments."""
        return [cls.turned(e).margin] if any(cls.resisted(e)) else []


class Connection(Elastic):
    """Base of elastic connections with fields for stiffness and damping; scenes use its subclasses."""

    stiffness: Stiffness = Field(NO_MATRIX, description="K: six numbers, two 3x3 matrices, or a symmetric 6x6 matrix")
    damping: Damping = Field(NO_MATRIX, description="C: six numbers, two 3x3 matrices, or a symmetric 6x6 matrix")

    _six_rows = field_validator("stiffness", "damping", mode="before")(six_rows)
    _symmetric = field_validator("stiffness", "damping")(check_symmetric)
    _sparse = field_validator("stiffness", "damping", "preload", check_fields=False)(without_zeros)

    @classmethod
    def resisted(cls, e: Symbolic) -> list[bool]:
        return has_moments(e.stiffness, e.preload)


def pull_back(stiffness: Rows, s: list[Expr], preload: Sequence[Expr | None]) -> list[Expr]:
    """Return preload - K s."""
    return [(p or 0) - resisting for p, resisting in zip(preload, times(stiffness, s), strict=True)]


def has_moments(stiffness: Rows, preload: Sequence[Expr | None]) -> list[bool]:
    """Return True for each axis x, y, z about which stiffness or preload has a moment."""
    return [any(part is not None for part in (*stiffness[k], preload[k])) for k in (3, 4, 5)]
