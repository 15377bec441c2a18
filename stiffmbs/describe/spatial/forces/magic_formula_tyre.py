"""The Magic Formula tyre."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from pydantic import Field

from ...element import Symbolic
from ...roads.road import above_zero
from ...tyres.coefficients import AnyProperties, TyreProperties
from ...tyres.names import SAMPLE
from ...units import si
from ..tyre import Rolling, Tyre


class MagicFormulaTyre(Tyre):
    """Pacejka's Magic Formula in the form of MF-Tyre 5.2 and PAC2002, with the coefficients of a property file (.tir).

    Longitudinal and lateral force, overturning, rolling and aligning torque, pure and combined slip, camber, load.  Slip angle
    and camber enter as angles (Pacejka's book has tan(alpha) and sin(gamma) in their places).  The load is
    VERTICAL_STIFFNESS d + VERTICAL_DAMPING d', never below zero; the formula's load is at most FZMAX.  The rolling radius is
    UNLOADED_RADIUS - d0 (DREFF atan(BREFF d/d0) + FREFF d/d0), d0 = FNOMIN/VERTICAL_STIFFNESS.  Forces are those of steady
    slip.  A file without coefficients of combined slip has the friction ellipse, and a note says so.

    Pacejka, Tire and Vehicle Dynamics (2006), sec. 4.3.2; MSC Adams/Tire, PAC2002.
    """

    kind: ClassVar[str] = "magic_formula_tyre"
    forms: ClassVar[tuple[Mapping[str, Any], ...]] = ({"properties": TyreProperties(coefficients=SAMPLE)},)
    reflected: ClassVar[dict[str, str] | None] = {"j": "z", "hand": "angle"}

    properties: AnyProperties = Field(
        description="the name of a property file (.tir) beside the scene, or coefficients"
    )
    hand: si.NumberNotZero = Field(1.0, description="-1 mounts the tyre of the file on the other side of the car")

    @staticmethod
    def unloaded_radius(e: Symbolic) -> Any:
        return e.properties.UNLOADED_RADIUS

    @staticmethod
    def carried(e: Symbolic, deflection: Any, rate: Any) -> Any:
        return e.properties.VERTICAL_STIFFNESS * deflection + e.properties.VERTICAL_DAMPING * rate

    @classmethod
    def rolling_radius(cls, e: Symbolic, deflection: Any) -> Any:
        """The effective rolling radius by BREFF, DREFF and FREFF of the property file."""
        from sympy import atan

        p = e.properties
        nominal = e.named(p.FNOMIN / p.VERTICAL_STIFFNESS)
        part = e.named(deflection / nominal)
        return p.UNLOADED_RADIUS - nominal * (p.DREFF * atan(p.BREFF * part) + p.FREFF * part)

    @staticmethod
    def law(e: Symbolic, rolling: Rolling) -> tuple[Any, Any, Any, Any, Any]:
        """Forces and moments by the Magic Formula."""
        from ...tyres.magic_formula import Slip, wrench

        p = e.properties
        beyond = e.named(rolling.load - p.FZMAX)
        load = e.named(rolling.load - e.named(above_zero(beyond)))
        slip = Slip(
            load,
            rolling.slip,
            e.named(e.hand * rolling.slip_angle),
            e.named(e.hand * rolling.camber),
            e.named(rolling.speed / p.LONGVL),
            rolling.direction,
            rolling.friction,
        )
        fx, fy, mx, my, mz = wrench(p, slip, e.named, p.is_combined)
        return fx, e.hand * fy, e.hand * mx, my, e.hand * mz
