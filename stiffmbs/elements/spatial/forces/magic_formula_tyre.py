"""Magic Formula tyre."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any, Literal

from pydantic import Field, model_validator

from ....reading.units import si
from ...element import Expr, Symbolic, sp
from ...roads.envelope import Envelope
from ...roads.road import above_zero, magnitude
from ...tyres.coefficients import PRESSED, AnyProperties, TyreProperties
from ...tyres.file_fields import PLAUSIBLE
from ...tyres.names import SAMPLE, SAMPLE_6, SAMPLE_FIALA
from ...tyres.property_file import VERSIONS
from ..contact_point import ContactPoint
from ..pressed_tyre import pressed, pressure_increment
from ..relaxation import DEFLECTIONS
from ..tyre import Rolling, Touch, Tyre


class MagicFormulaTyre(Tyre):
    """Magic Formula tyre (Pacejka) or Fiala tyre with the coefficients of a property file (.tir).

    The files are those of MF-Tyre 5.2, 6.1 and 6.2, of Adams' PAC2002, and of Adams' Fiala model. FITTYP of the file
    selects the version, or PROPERTY_FILE_FORMAT.

    The Magic Formula gives longitudinal and lateral force, overturning, rolling and aligning torque. It includes pure and
    combined slip, camber, load, and relaxation lengths; USE_MODE selects them. Slip angle and camber enter as angles;
    Pacejka's book uses tan(alpha) and sin(gamma).

    In version 5.2 the load is VERTICAL_STIFFNESS d + VERTICAL_DAMPING d', or that of [DEFLECTION_LOAD_CURVE] with the
    same damping. The rolling radius is UNLOADED_RADIUS - d0 (DREFF atan(BREFF d/d0) + FREFF d/d0), with d0 =
    FNOMIN/VERTICAL_STIFFNESS. PAC2002 with IP_NOM depends on inflation pressure. In 6.1 and 6.2 load and radii depend on
    pressure, spin, camber and the forces along the road (`stiffmbs.elements.tyres.deflection_6`), and turn slip can be
    included.

    The load is never negative; the load in the formula is limited to FZMAX. With BOTTOMING_RADIUS and [BOTTOMING_CURVE],
    or in 6.1 and 6.2 with BOTTOM_STIFF, the rim adds to the normal force and the overturning torque only. A file without
    coefficients of combined slip uses the friction ellipse, and a note reports it.

    A file of the format FIALA has the forces of `fiala_tyre` with CSLIP, CALPHA, UMAX and UMIN, the load of 5.2, and the
    loaded radius as rolling radius.

    Pacejka, Tire and Vehicle Dynamics (2012), sec. 4.3; MSC Adams/Tire, PAC2002 and Fiala tire models; Besselink,
    Schmeitz, Pacejka, Vehicle System Dynamics 48 suppl. 1 (2010) 337-352.
    """

    kind = "magic_formula_tyre"
    forms = (
        {"properties": TyreProperties.model_construct(coefficients=SAMPLE)},
        {"properties": TyreProperties.model_construct(coefficients={**SAMPLE, "PTX1": 1.0, "PTY1": 1.0})},
        {"properties": TyreProperties.model_construct(coefficients=SAMPLE_6, version="6.2")},
        {"properties": TyreProperties.model_construct(coefficients=SAMPLE_FIALA, version="Fiala")},
        {"properties": TyreProperties.model_construct(coefficients={**SAMPLE, "PPX1": 0.1, "IP_NOM": 1.0, "IP": 1.2})},
    )
    reflected = {"j": "z", "hand": "angle"}

    properties: AnyProperties = Field(
        description="the name of a property file (.tir), relative to the folder of the file that names it, or coefficients"
    )
    hand: si.NumberNotZero = Field(1.0, description="-1 mounts the tyre of the file on the other side of the car")
    side: Literal["left", "right"] | None = Field(
        None, description="of the car that the tyre is mounted on: the tyre is mirrored if TYRESIDE is the other one"
    )
    transient: bool | None = Field(
        None, description="whether slips lag by relaxation lengths; by default according to USE_MODE"
    )
    envelope: Envelope | Literal["file"] | None = Field(  # type: ignore[assignment]
        None, description="elliptical cams for short obstacles: their sizes, or 'file' for ELLIPS_LENGTH and so on"
    )
    pressure: si.PositivePressure | None = Field(
        None, description="inflation pressure of a tyre of 6.1, 6.2 or PAC2002, Pa; that of the file by default"
    )
    turn_slip: bool | None = Field(
        None, description="whether the yaw rate acts on the forces (6.1, 6.2); by default according to USE_MODE"
    )

    @model_validator(mode="after")
    def _has_coefficients(self) -> MagicFormulaTyre:
        p = self.properties
        if abs(self.hand) != 1:
            raise ValueError(f"hand: found {self.hand:g}, expected 1 or -1")
        if not p.has_stiffness:
            raise ValueError(
                "properties: found no VERTICAL_STIFFNESS, expected one: the load follows from the deflection"
            )
        if self.transient and not p.has_lengths:
            missing = " and ".join(p.names_of_lengths)
            raise ValueError(f"transient: found properties without {missing}, expected relaxation lengths")
        if self.pressure is not None and not p.has_pressure:
            raise ValueError(f"pressure: found one for a tyre of version {p.version}, expected {PRESSED}")
        least, most = PLAUSIBLE["INFLPRES"]
        if self.pressure is not None and not least <= self.pressure <= most:
            raise ValueError(f"pressure: found {self.pressure:g} Pa, expected {least:g} to {most:g} Pa")
        if self._turns and not p.has_turn_slip:
            raise ValueError("turn_slip: found properties without its coefficients, expected some such as PDYP1, PHYP1")
        return self

    def cams(self) -> Envelope | None:
        """Return the given cams, or those of the file."""
        if self.envelope != "file":
            return self.envelope
        if self.properties.envelope is None:
            raise ValueError(
                "envelope: found properties without ELLIPS_SHIFT, ELLIPS_LENGTH, ELLIPS_HEIGHT and Q_RA1, expected a file with these"
            )
        return self.properties.envelope

    @property
    def _turns(self) -> bool:
        return self.properties.takes_turn_slip if self.turn_slip is None else self.turn_slip

    def own_notes(self) -> Iterator[str]:
        """Yield a note on a pressure outside the range of the file."""
        low, high = self.properties.ranges.get("pressure", (-math.inf, math.inf))
        pressure = self.properties.nominal_pressure if self.pressure is None else self.pressure
        if pressure is not None and not low <= pressure <= high:
            yield f"the pressure of {pressure:g} Pa is outside the valid range of its data, {low:g} to {high:g} Pa"

    def valid_ranges(self) -> Mapping[str, tuple[float, float]]:
        ranges = {name: range for name, range in self.properties.ranges.items() if name != "pressure"}
        return {"load": (-math.inf, math.inf), **ranges} if ranges else {}  # no range applies without contact

    def mounted_side(self) -> tuple[object, float, tuple[str, ...]]:
        return self.properties, float(self.hand_of(self)), self.properties.one_sided

    def own_states(self) -> tuple[str, ...]:
        transient = self.properties.is_transient if self.transient is None else self.transient
        return DEFLECTIONS if transient else ()

    @classmethod
    def touching(cls, e: Symbolic) -> Touch:
        if VERSIONS[e.properties.formula].is_6:
            return pressed(e, cls.hand_of(e), cls.takes_turns(e))
        return super().touching(e)

    @staticmethod
    def takes_turns(e: Symbolic) -> bool:
        """Return True if the yaw rate acts on the forces."""
        return bool(e.properties.mode == "5" if e.turn_slip is None else e.turn_slip)

    @classmethod
    def relaxation_lengths(cls, e: Symbolic, load: Expr, camber: Expr) -> tuple[Expr, Expr]:
        """Return the relaxation lengths of 5.2 or Fiala."""
        lengths = VERSIONS[e.properties.formula].equations.relaxation_lengths
        assert lengths is not None
        return lengths(e.properties, load, camber, e.named)

    @staticmethod
    def unloaded_radius(e: Symbolic) -> Expr:
        return e.properties.UNLOADED_RADIUS

    @staticmethod
    def carried(e: Symbolic, deflection: Expr, rate: Expr) -> Expr:
        """Return the vertical force, N, by deflection, m, and its rate, m/s, of 5.2, PAC2002 with pressure, or Fiala."""
        p = e.properties
        spring = p.deflection_load or (lambda x: p.VERTICAL_STIFFNESS * x)
        stiffer = 1 if p.NOMPRES is None else 1 + p.QPFZ1 * pressure_increment(e)
        return spring(deflection) * stiffer + p.VERTICAL_DAMPING * rate

    @staticmethod
    def rim_contact(e: Symbolic, deflection: Expr, contact: ContactPoint) -> tuple[Expr, Expr] | None:
        """Return the rim's normal force, N, and overturning torque, N m, by the properties of bottoming, or None."""
        p, rim = e.properties, e.properties.bottoming
        if rim is None:
            return None
        if VERSIONS[p.formula].is_6:
            depth = e.named(rim.radius - contact.radius)
        else:
            depth = deflection - (p.UNLOADED_RADIUS - rim.radius)
        return bottomed(e, rim, depth, contact.camber)

    @classmethod
    def belt_couple(cls, e: Symbolic, touch: Touch) -> Expr:
        """Return the gyroscopic couple of the belt, as the lateral deflection turns it about the heading.

        M = QTZ1 LGYR MBELT V dy/dt, with the rolling speed V and the deflection y; MSC Adams/Tire, PAC2002. Pacejka, Tire and
        Vehicle Dynamics (2012), sec. 5.4.2.
        """
        belt = e.properties.belt
        if belt is None or not touch.rates:
            return 0
        rolling = e.named(cls.rolling_radius(e, touch.deflection))
        return belt * rolling * touch.contact.spin * e.named(touch.rates[1])

    @classmethod
    def rolling_radius(cls, e: Symbolic, deflection: Expr) -> Expr:
        """Return the effective rolling radius of 5.2 or Fiala."""
        radius = VERSIONS[e.properties.formula].equations.rolling_radius
        assert radius is not None
        return radius(e.properties, deflection, e.named)

    @classmethod
    def law(cls, e: Symbolic, rolling: Rolling) -> tuple[Expr, Expr, Expr, Expr, Expr]:
        """Return Fx, Fy, Mx, My, Mz by the Magic Formula, up to the largest load of the file, N and N m."""
        from ...tyres.magic_formula import Slip, of_mode
        from ...tyres.magic_formula_6 import PressedSlip

        p, hand = e.properties, cls.hand_of(e)
        beyond = e.named(rolling.load - p.FZMAX)
        load = e.named(rolling.load - e.named(above_zero(beyond)))
        alpha, gamma = e.named(hand * rolling.slip_angle), e.named(hand * rolling.camber)
        speed, dpi = e.named(rolling.speed / p.LONGVL), pressure_increment(e)
        slip: Any = Slip(load, rolling.slip, alpha, gamma, speed, rolling.direction, rolling.friction, dpi)
        version = VERSIONS[p.formula]
        if version.is_6:
            turn = None if rolling.turn is None else e.named(hand * rolling.turn)
            slip = PressedSlip(*(*vars(slip).values(), turn, rolling.rolling))
        fx, fy, mx, my, mz = of_mode(version.equations, p.mode, p, slip, e.named, p.ellipse)
        return fx, hand * fy, hand * mx, my, hand * mz

    @staticmethod
    def hand_of(e: Symbolic) -> Expr:
        """Return -1 for a tyre that is mirrored, by `hand`, by its side, or by the sign of USE_MODE, else 1."""
        other_side = e.side is not None and e.properties.side in ("left", "right") and e.side != e.properties.side
        return e.hand if other_side == e.properties.is_mirrored else -e.hand


NO_WIDTH = "1e-30"
"""Offset of divisors that contain half the difference of penetrations, m."""


def bottomed(e: Symbolic, rim: Any, depth: Expr, camber: Expr) -> tuple[Expr, Expr]:
    """Return the force of the rim (N) and its torque about the longitudinal axis (N m).

    The rim is a cylinder of the tyre's width W. With the penetration d at mid-width and the camber gamma, the
    penetration across the width is d + y tan(gamma). The force is that of a curve at the mean penetration. It acts at
    the centre of the penetrated area. MSC Adams/Tire, PAC2002, wheel bottoming. `depth`: penetration of the rim at
    mid-width, m; negative without contact. `camber`: camber, rad; positive if the top leans to the right.
    """
    slope = e.named(sp.tan(camber))
    half = e.named(rim.width / 2 * magnitude(slope))
    edge = e.named(above_zero(e.named(depth + half)))
    whole = depth > half
    mean = e.read(sp.Piecewise((depth, whole), (edge**2 / (4 * half + sp.Float(NO_WIDTH)), True)))
    part = edge / (2 * half + sp.Float(NO_WIDTH))  # of the width that is in contact
    of_whole = rim.width**2 * magnitude(slope) / (12 * magnitude(depth) + sp.Float(NO_WIDTH))
    offset = e.read(sp.Piecewise((of_whole, whole), (rim.width * (3 - 2 * part) / 6, True)))
    mean, offset = e.named(mean), e.named(offset)
    force = e.named(e.read(sp.Piecewise((rim.load(mean), mean > 0), (0, True))))
    return force, -force * offset * slope / (magnitude(slope) + sp.Float(NO_WIDTH))
