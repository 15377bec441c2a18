"""Magic Formula tyre."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, Literal

from pydantic import Field, model_validator

from ....reading.units import si
from ...element import Symbolic
from ...roads.road import above_zero, magnitude
from ...tyres.coefficients import AnyProperties, TyreProperties
from ...tyres.names import SAMPLE
from ..relaxation import DEFLECTIONS
from ..tyre import Rolling, Tyre


class MagicFormulaTyre(Tyre):
    """Magic Formula tyre (Pacejka) of MF-Tyre 5.2 and PAC2002, with the coefficients of a property file (.tir).

    It gives longitudinal and lateral force, overturning, rolling and aligning torque. It includes pure and combined
    slip, camber, load, and relaxation lengths; USE_MODE selects them. Slip angle and camber enter as angles; Pacejka's
    book uses tan(alpha) and sin(gamma).

    The load is VERTICAL_STIFFNESS d + VERTICAL_DAMPING d', or that of [DEFLECTION_LOAD_CURVE] with the same damping. It
    is never negative; the load in the formula is limited to FZMAX. With BOTTOMING_RADIUS and [BOTTOMING_CURVE], the rim
    adds to the normal force and the overturning torque only. The rolling radius is UNLOADED_RADIUS - d0 (DREFF
    atan(BREFF d/d0) + FREFF d/d0), with d0 = FNOMIN/VERTICAL_STIFFNESS. A file without coefficients of combined slip
    uses the friction ellipse, and a note reports it.

    Pacejka, Tire and Vehicle Dynamics (2006), sec. 4.3.2; MSC Adams/Tire, PAC2002.
    """

    kind = "magic_formula_tyre"
    forms = (
        {"properties": TyreProperties(coefficients=SAMPLE)},
        {"properties": TyreProperties(coefficients={**SAMPLE, "PTX1": 1.0, "PTY1": 1.0})},
    )
    reflected = {"j": "z", "hand": "angle"}

    properties: AnyProperties = Field(
        description="the name of a property file (.tir) beside the scene, or coefficients"
    )
    hand: si.NumberNotZero = Field(1.0, description="-1 mounts the tyre of the file on the other side of the car")
    side: Literal["left", "right"] | None = Field(
        None, description="of the car that the tyre is mounted on: the tyre is mirrored if TYRESIDE is the other one"
    )
    transient: bool | None = Field(
        None, description="whether slips lag by relaxation lengths; as USE_MODE says by default"
    )

    @model_validator(mode="after")
    def _has_lengths(self) -> MagicFormulaTyre:
        if self.transient and not self.properties.has_lengths:
            raise ValueError("transient: found properties without PTX1 and PTY1, expected relaxation lengths")
        return self

    def valid_ranges(self) -> Mapping[str, tuple[float, float]]:
        """Return the valid ranges of the property file for each quantity, SI units; empty if the file has none."""
        ranges = self.properties.ranges
        return {"load": (-math.inf, math.inf), **ranges} if ranges else {}  # no range applies without contact

    def own_states(self) -> tuple[str, ...]:
        transient = self.properties.is_transient if self.transient is None else self.transient
        return DEFLECTIONS if transient else ()

    @classmethod
    def relaxation_lengths(cls, e: Symbolic, load: Any, camber: Any) -> tuple[Any, Any]:
        """Return the relaxation lengths by PTX1 to PTX3, and by PTY1, PTY2 and PKY3."""
        from ...tyres.magic_formula import relaxation_lengths

        return relaxation_lengths(e.properties, load, camber, e.named)

    @staticmethod
    def unloaded_radius(e: Symbolic) -> Any:
        return e.properties.UNLOADED_RADIUS

    @staticmethod
    def carried(e: Symbolic, deflection: Any, rate: Any) -> Any:
        p = e.properties
        spring = p.deflection_load or (lambda x: p.VERTICAL_STIFFNESS * x)
        return spring(deflection) + p.VERTICAL_DAMPING * rate

    @staticmethod
    def rim_contact(e: Symbolic, deflection: Any, camber: Any) -> tuple[Any, Any] | None:
        """Return the force of [BOTTOMING_CURVE] and its overturning torque; the rim is as wide as the tyre."""
        rim = e.properties.bottoming
        return (
            None if rim is None else bottomed(e, rim, deflection - (e.properties.UNLOADED_RADIUS - rim.radius), camber)
        )

    @classmethod
    def rolling_radius(cls, e: Symbolic, deflection: Any) -> Any:
        """Return the effective rolling radius by BREFF, DREFF and FREFF of the property file."""
        from sympy import atan

        p = e.properties
        nominal = e.named(p.FNOMIN / p.VERTICAL_STIFFNESS)
        part = e.named(deflection / nominal)
        return p.UNLOADED_RADIUS - nominal * (p.DREFF * atan(p.BREFF * part) + p.FREFF * part)

    @classmethod
    def law(cls, e: Symbolic, rolling: Rolling) -> tuple[Any, Any, Any, Any, Any]:
        """Return forces and moments by the Magic Formula."""
        from ...tyres.magic_formula import Slip, of_mode

        p = e.properties
        hand = e.hand if cls._is_as_measured(e) else -e.hand
        beyond = e.named(rolling.load - p.FZMAX)
        load = e.named(rolling.load - e.named(above_zero(beyond)))
        slip = Slip(
            load,
            rolling.slip,
            e.named(hand * rolling.slip_angle),
            e.named(hand * rolling.camber),
            e.named(rolling.speed / p.LONGVL),
            rolling.direction,
            rolling.friction,
        )
        fx, fy, mx, my, mz = of_mode(p.mode, p, slip, e.named, p.is_combined)
        return fx, hand * fy, hand * mx, my, hand * mz

    @staticmethod
    def _is_as_measured(e: Symbolic) -> bool:
        """Return True if the tyre is mounted as measured, apart from `hand`: by its side, and the sign of USE_MODE."""
        other_side = e.side is not None and e.properties.side in ("left", "right") and e.side != e.properties.side
        return bool(other_side == e.properties.is_mirrored)


NO_WIDTH = "1e-30"
"""Offset of divisors that contain half the difference of penetrations, m."""


def bottomed(e: Symbolic, rim: Any, depth: Any, camber: Any) -> tuple[Any, Any]:
    """Return the force of the rim (N) and its torque about the longitudinal axis (N m).

    The rim is a cylinder of the tyre's width W. With the penetration d at mid-width and the camber gamma, the
    penetration across the width is d + y tan(gamma). The force is that of a curve at the mean penetration. It acts at
    the centre of the penetrated area. MSC Adams/Tire, PAC2002, wheel bottoming.

    Parameters
    ----------
    e : SymbolicElement
    rim : Bottoming
    depth : Expr
        Penetration of the rim at mid-width, m; negative without contact.
    camber : Expr
        Camber, rad; positive if the top leans to the right.
    """
    from sympy import Float, Piecewise, tan

    slope = e.named(tan(camber))
    half = e.named(rim.width / 2 * magnitude(slope))
    edge = e.named(above_zero(e.named(depth + half)))
    whole = depth > half
    mean = e.read(Piecewise((depth, whole), (edge**2 / (4 * half + Float(NO_WIDTH)), True)))
    part = edge / (2 * half + Float(NO_WIDTH))  # of the width that is in contact
    of_whole = rim.width**2 * magnitude(slope) / (12 * magnitude(depth) + Float(NO_WIDTH))
    offset = e.read(Piecewise((of_whole, whole), (rim.width * (3 - 2 * part) / 6, True)))
    mean, offset = e.named(mean), e.named(offset)
    force = e.named(e.read(Piecewise((rim.load(mean), mean > 0), (0, True))))
    return force, -force * offset * slope / (magnitude(slope) + Float(NO_WIDTH))
