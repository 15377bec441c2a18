"""Coefficients of a tyre of the Magic Formula or of Fiala, from a property file or by name."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Annotated, Any, Final, Literal

import numpy as np
from pydantic import Field, model_validator

from ...errors import InputError, prefixed
from ...reading.did_you_mean import did_you_mean
from ...reading.files.files_read import file_beside
from ...reading.files.quoted import quoted, written
from ...reading.files.requested import unused_notes
from ...reading.table import Table
from ..element import Component
from ..read_by import Context, JsonSchema, ReadBy
from ..roads.envelope import MOST_TRACKS, Envelope
from . import file_fields
from .file_fields import Bottoming
from .names import COMBINED, OF_PAC2002, OF_PRESSURE, OF_THE_FILE, ONE_SIDED, POSITIVE, REASONS, TURN_SLIP
from .passivity import active_notes
from .property_file import NOMINAL_PRESSURE, VERSIONS, PropertyFile, Version, digits, read_property_file

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

WITH_TURN_SLIP: Final = 5
"""Last digit of USE_MODE with turn slip."""


class TyreProperties(Component):
    """Coefficients of the Magic Formula, or of Fiala's formula, by their names in property files, in SI units.

    Parameters
    ----------
    coefficients : mapping of str to float
        Omitted coefficients are 0, omitted scale factors 1.
    """

    coefficients: dict[str, float] = Field(description="by name, SI units")
    version: Literal["5.2", "6.1", "6.2", "Fiala"] = Field(
        "5.2", description="of the Magic Formula; 5.2 includes PAC2002; or Fiala's formula"
    )
    use_mode: int | None = Field(None, description="USE_MODE; 4, or 14 with relaxation lengths, by default")
    side: Literal["", "left", "right", "symmetric"] = Field("", description="TYRESIDE, that the tyre was measured on")
    ranges: dict[str, tuple[float, float]] = Field(
        {}, description="valid ranges of slip, slip_angle (rad), camber (rad), load (N) and pressure (Pa)"
    )
    deflection_load: Table | None = Field(
        None, description="load (N) over deflection (m), in place of VERTICAL_STIFFNESS; 5.2 and Fiala"
    )
    bottoming: Bottoming | None = Field(None, description="contact of the rim with the road")
    is_pac2002: bool = Field(
        False, description="whether the formula is that of PAC2002: its friction ellipse, and QSX4-11 and QSY5-7"
    )
    belt: float = Field(0.0, description="QTZ1 LGYR MBELT of the belt's gyroscopic couple, kg; 5.2 alone")
    remarks: tuple[str, ...] = ()

    @model_validator(mode="after")
    def _complete(self) -> TyreProperties:
        known = self.formula.numbers
        for name in self.coefficients:
            if name not in known:
                raise ValueError(
                    f"found the unknown coefficient '{quoted(name)}'{did_you_mean(name, known)}, expected one such as {', '.join(self.formula.required[-3:])}"
                )
        for name in self.formula.required:
            if name not in self.coefficients:
                raise ValueError(f"found no {name}, expected one")
            if not self.coefficients[name] and name not in self.formula.may_vanish:
                raise ValueError(f"found {name} = 0, expected a number other than zero")
        if self.use_mode is not None and not self.formula.has_mode(self.use_mode):
            raise ValueError(file_fields.wrong_mode(self.use_mode, self.formula))
        for name in POSITIVE:
            if self.coefficients.get(name, 1.0) <= 0:
                raise ValueError(f"found {name} = {self.coefficients[name]:g}, expected a number above zero")
        if self.formula.is_6:
            self._check_stiffness()
        elif "IP_NOM" not in self.coefficients:
            for name in (*OF_PRESSURE, "IP"):
                if self.coefficients.get(name):
                    raise ValueError(f"found {name} without IP_NOM, expected the nominal pressure")
            for name in () if self.of_adams else OF_PAC2002:
                if self.coefficients.get(name):
                    raise ValueError(
                        f"found {name} of a tyre of MF-Tyre 5.2, expected one of PAC2002 (is_pac2002: true)"
                    )
        return self

    def _check_stiffness(self) -> None:
        """Refuse a progressive stiffness that the stiffness at the nominal load contradicts (Q_FZ1 of 6.1)."""
        p = self.numbers
        slope = p["VERTICAL_STIFFNESS"] * p["UNLOADED_RADIUS"] / p["FNOMIN"]
        if slope**2 <= 4 * p["Q_FZ2"]:
            raise ValueError(
                f"found Q_FZ2 = {p['Q_FZ2']:g}, expected less than {slope**2 / 4:.4g}, that is "
                "(VERTICAL_STIFFNESS UNLOADED_RADIUS/FNOMIN)^2/4"
            )
        if self.deflection_load is not None:
            raise ValueError(f"found a deflection_load of a tyre of version {self.version}, expected one of 5.2")

    def __hash__(self) -> int:
        return hash(tuple(self.coefficients.items()))

    @property
    def formula(self) -> Version:
        """Version of the Magic Formula, or Fiala's formula."""
        return VERSIONS[self.version]

    @property
    def numbers(self) -> dict[str, float]:
        """All numbers by name, with default values."""
        return {**self.formula.defaults, **self.coefficients}

    def _has(self, names: Iterable[str]) -> bool:
        """Return True if one of some coefficients is given and not zero."""
        return any(self.coefficients.get(name, 0.0) for name in names)

    @property
    def has_stiffness(self) -> bool:
        """True if the tyre has a vertical stiffness, without which forces at given loads are known alone."""
        return "VERTICAL_STIFFNESS" in self.coefficients

    @property
    def is_combined(self) -> bool:
        """True if there are weights of combined slip."""
        return self._has(COMBINED)

    @property
    def has_lengths(self) -> bool:
        """True if there are relaxation lengths, or the stiffnesses of 6.1 that give them."""
        if self.formula.is_6:
            return min(self.coefficients.get(name, 0.0) for name in self.names_of_lengths) > 0
        return self._has(self.names_of_lengths)

    @property
    def names_of_lengths(self) -> tuple[str, str]:
        """Coefficients without which there are no relaxation lengths."""
        if not self.formula.is_magic:
            return "RELAX_LENGTH_X", "RELAX_LENGTH_Y"
        return ("LONGITUDINAL_STIFFNESS", "LATERAL_STIFFNESS") if self.formula.is_6 else ("PTX1", "PTY1")

    @property
    def is_transient(self) -> bool:
        """True for slips with relaxation lengths, by USE_MODE, or by default if there are lengths."""
        return self.has_lengths and (self.use_mode is None or self._lags)

    @property
    def _lags(self) -> bool:
        """True if USE_MODE selects transient slips."""
        return self.use_mode is not None and all(digits(self.use_mode)[1:])

    @property
    def _slips(self) -> int:
        """Last digit of USE_MODE, which selects the forces; combined slip by default."""
        return 4 if self.use_mode is None or not self.formula.is_magic else digits(self.use_mode)[2]

    @property
    def has_turn_slip(self) -> bool:
        """True if there are coefficients of turn slip."""
        return self.formula.is_6 and self._has(TURN_SLIP)

    @property
    def takes_turn_slip(self) -> bool:
        """True if USE_MODE selects turn slip."""
        return self._slips == WITH_TURN_SLIP

    @property
    def is_mirrored(self) -> bool:
        """True if USE_MODE is negative."""
        return self.use_mode is not None and self.use_mode < 0

    @property
    def one_sided(self) -> tuple[str, ...]:
        """Coefficients that are not zero and differ between a left and a right tyre."""
        has = self.coefficients.get
        return tuple(
            name for name, scale in ONE_SIDED.items() if self._slips > 1 and has(name, 0.0) and has(scale, 1.0)
        )

    @property
    def nominal_load(self) -> float:
        """FNOMIN, N, or of a Fiala tyre the load at a usual deflection."""
        return file_fields.nominal_load(self.coefficients)

    @property
    def nominal_pressure(self) -> float | None:
        """Inflation pressure of the file, Pa; None for a tyre that does not depend on it."""
        numbers = self.numbers
        if self.formula.is_6:
            return numbers["INFLPRES"] or numbers["NOMPRES"]
        return numbers.get("IP", numbers["IP_NOM"]) if "IP_NOM" in numbers else None

    @property
    def has_pressure(self) -> bool:
        """True for a tyre that depends on inflation pressure: of 6.1, 6.2, and of PAC2002 with IP_NOM."""
        return self.nominal_pressure is not None

    @property
    def of_adams(self) -> bool:
        """True for PAC2002, as stated or by its nominal pressure."""
        return self.is_pac2002 or "IP_NOM" in self.coefficients

    @property
    def envelope(self) -> Envelope | None:
        """Cams of the enveloping contact by ELLIPS_SHIFT to ELLIPS_NWIDTH, for the contact patch at the nominal load."""
        p = SimpleNamespace(**self.numbers)
        if not self.formula.is_6 or min(p.ELLIPS_SHIFT, p.ELLIPS_LENGTH, p.ELLIPS_HEIGHT, p.Q_RA1) <= 0:
            return None
        from .deflection_6 import contact_patch

        half_length, half_width = map(float, contact_patch(p, p.FNOMIN, 0.0))
        return Envelope(
            shift=p.ELLIPS_SHIFT * 2 * half_length, length=p.ELLIPS_LENGTH * p.UNLOADED_RADIUS,
            height=p.ELLIPS_HEIGHT * p.UNLOADED_RADIUS, order=p.ELLIPS_ORDER or 2.0, width=2 * half_width,
            tracks=min(max(int(p.ELLIPS_NWIDTH), 1), MOST_TRACKS),
        )  # fmt: skip

    def in_equations(self) -> dict[str, object]:
        """Return the options of the equations: combined slip, belt, mode, side, deflection, bottoming and version."""
        own: dict[str, Any] = {
            "ellipse": "" if self.is_combined else "pac2002" if self.of_adams else "limit",
            "belt": self.belt or None, "mode": str(self._slips), "is_mirrored": self.is_mirrored, "side": self.side,
            "deflection_load": self.deflection_load, "bottoming": self.bottoming, "formula": self.version,
        }  # fmt: skip
        numbers = {"NOMPRES": None, **self.numbers, **own}
        if self.has_pressure:
            numbers["INFLPRES"] = self.nominal_pressure
        if "IP_NOM" in numbers:
            numbers["NOMPRES"] = numbers["LIP"] * numbers["IP_NOM"]
        return numbers

    def notes(self) -> Iterator[str]:
        """Yield sentences on settings that the equations do not use, and on loads at which the tyre adds energy."""
        yield from self.remarks
        if self._lags and not self.has_lengths:
            missing = ", ".join(self.names_of_lengths)
            yield f"USE_MODE = {self.use_mode} asks for relaxation lengths, and there are none ({missing}): slips are those of the steady state"
        if self.use_mode is not None:
            yield from file_fields.replaced_digits(self.use_mode, self.is_transient, self.formula)
        if self.belt and not self.has_lengths:
            yield "the gyroscopic couple of the belt (QTZ1) needs relaxation lengths, and there are none: it is left out"
        if self.formula.is_magic and not self.is_combined:
            yield "there are no coefficients of combined slip (RBX1, RCX1, RBY1, RCY1): forces are held on the friction ellipse"
        if not self.has_stiffness:
            yield "there is no VERTICAL_STIFFNESS: deflection and radii are not known, and no scene can use the tyre"
        if self.formula.is_magic:
            yield from active_notes(self)

    def wrench(
        self,
        load: ArrayLike,
        slip: ArrayLike = 0.0,
        slip_angle: ArrayLike = 0.0,
        camber: ArrayLike = 0.0,
        speed: ArrayLike | None = None,
        friction: ArrayLike = 1.0,
        pressure: ArrayLike | None = None,
    ) -> dict[str, np.ndarray]:
        """Return forces and torques of steady slip, rolling forward, in ISO axes at the contact point.

        Parameters
        ----------
        load : array_like
            N, positive; values above FZMAX count as FZMAX.
        slip : array_like
            kappa, positive when driving.
        slip_angle, camber : array_like
            rad; a positive slip angle gives a negative lateral force, with positive camber the top leans to the right.
        speed : array_like, optional
            m/s, for the rolling resistance; LONGVL of the file by default.
        friction : array_like
            Friction factor of the road.
        pressure : array_like, optional
            Inflation pressure, Pa, of 6.1, 6.2 and PAC2002; that of the file by default.

        Returns
        -------
        dict of str to ndarray
            ``longitudinal``, ``lateral`` (N), ``overturning``, ``rolling``, ``aligning`` (N m); arguments broadcast.
        """
        load = np.minimum(load, self.coefficients.get("FZMAX", math.inf))
        found = self.steady_state(load, slip, slip_angle, camber, pressure, speed, friction=friction)
        return {name: found[symbol] for name, symbol in WRENCH.items()}

    def steady_state(
        self,
        Fz: ArrayLike,
        kappa: ArrayLike = 0.0,
        alpha: ArrayLike = 0.0,
        gamma: ArrayLike = 0.0,
        p: ArrayLike | None = None,
        Vx: ArrayLike | None = None,
        phit: ArrayLike | None = None,
        friction: ArrayLike = 1.0,
    ) -> dict[str, np.ndarray]:
        """Return the steady state of the tyre in ISO axes at the contact point, with the symbols of the Magic Formula.

        No valid range is applied, and the low-speed formula of the element is not used.

        Parameters
        ----------
        Fz : array_like
            Load, N, zero or positive.
        kappa : array_like
            Longitudinal slip, positive when driving, -1 for a locked wheel.
        alpha, gamma : array_like
            Slip angle and camber, rad: a positive slip angle gives a negative side force, with positive camber the top
            leans to the right.
        p : array_like, optional
            Inflation pressure, Pa, of 6.1, 6.2 and PAC2002 with IP_NOM; that of the file by default.
        Vx : array_like, optional
            Forward speed of the contact point, m/s, negative in reverse; LONGVL by default.
        phit : array_like, optional
            Turn slip, yaw rate over speed, 1/m, positive in a turn to the left. Without it the equations of turn slip
            are not used.
        friction : array_like
            Friction factor of the road.

        Returns
        -------
        dict of str to ndarray
            Forces ``Fx``, ``Fy`` (N) and torques ``Mx``, ``My``, ``Mz`` (N m); stiffnesses ``Kxk`` (N), ``Kya``,
            ``Kyg0`` (N/rad); peak friction ``mux``, ``muy``; pneumatic trail ``t`` (m) and residual torque ``Mzr`` (N
            m); ``omega`` (rad/s), effective radius ``Re``, deflection ``rho``, loaded radius ``Rl`` (m); relaxation
            lengths ``sigma_x``, ``sigma_y`` (m, 0 without them); half length ``a`` and half width ``b`` of the contact patch (m).
            ``Kyg0``, ``a`` and ``b`` are of 6.1 and 6.2 alone; ``rho`` and ``Rl`` are NaN for a load that no loaded
            radius carries, and with ``Re`` and ``omega`` of a tyre without VERTICAL_STIFFNESS. The arguments broadcast.

        Raises
        ------
        InputError
            For a negative load or friction factor, a slip angle or camber beyond pi/2, a pressure that no tyre has, or a
            pressure or turn slip of a tyre without their coefficients.
        """
        from .steady_state import steady_state

        if p is not None and not self.has_pressure:
            raise InputError(f"found a pressure for a tyre of version {self.version}, expected {PRESSED}")
        if phit is not None and not self.has_turn_slip:
            raise InputError(
                "found turn slip for a tyre without its coefficients, expected one with PHYP1, PDYP1 or so"
            )
        return steady_state(self.in_equations(), (Fz, kappa, alpha, gamma, friction), p, Vx, phit)

    def to_file(self, path: str | Path, units: dict[str, str] | None = None) -> None:
        """Write a property file with the same evaluation; numbers that the equations do not use are left out.

        Parameters
        ----------
        path : str or Path
        units : dict of str to str, optional
            Units of LENGTH, FORCE, ANGLE, MASS and TIME by their names in Adams/Tire; SI units by default.

        Raises
        ------
        InputError
            For an unknown unit.
        OSError
            If the file cannot be written.
        """
        from .written_file import property_text

        Path(path).write_text(property_text(self, units), encoding="utf-8")

    @classmethod
    def from_file(cls, path: str | Path) -> TyreProperties:
        """Read a property file.

        Raises
        ------
        InputError
            If it cannot be read; the message contains the line.
        """
        return _of_file(read_property_file(Path(path)))


PRESSED = "a tyre of 6.1 or 6.2, or of PAC2002 with IP_NOM"
"""Tyres that depend on inflation pressure, in messages."""
WRENCH = {"longitudinal": "Fx", "lateral": "Fy", "overturning": "Mx", "rolling": "My", "aligning": "Mz"}
"""Symbols of forces and torques by the channels of a tyre."""


def _of_file(file: PropertyFile) -> TyreProperties:
    version, remarks = file_fields.version_of(file)
    formula = VERSIONS[version]
    found = {
        name: file.number(name, formula.dimensions.get(name, ""), formula.home(name))
        for name in file_fields.read_names(file, formula)
        if name in formula.required or file.entry(name, formula.home(name))
    }
    read = {
        "coefficients": found, "version": version, "use_mode": file_fields.mode_of(file, formula), "side": file_fields.side_of(file),
        "ranges": dict(file_fields.ranges_of(file, formula)), "bottoming": file_fields.bottoming_of(file, formula),
    }  # fmt: skip
    if not formula.is_6:
        read["deflection_load"] = file_fields.curve_of(file, "DEFLECTION_LOAD_CURVE")
    if version == "5.2":
        read["belt"] = file_fields.belt_of(file)
        read["is_pac2002"] = file_fields.is_pac2002(file)
    if version == "Fiala":
        for name, length, note in file_fields.relaxation_of(file, formula, found, read["use_mode"]):
            found[name] = length
            remarks += [note] if note else []
    if formula.is_6 and "NOMPRES" not in found:
        found["NOMPRES"] = found.get("INFLPRES") or NOMINAL_PRESSURE
        remarks.append(f"there is no NOMPRES: the coefficients are taken to hold at {found['NOMPRES']:g} Pa")
    for name in OF_THE_FILE:
        file.entry(name)
    remarks += file_fields.doubts(file, formula, found)
    remarks += unused_notes([*file.sections.values(), file.tables], REASONS)
    try:
        properties = TyreProperties(**read, remarks=tuple(f"{file.source}: {note}" for note in remarks))
    except InputError as error:
        raise InputError(f"{file.source}: {str(error).removeprefix('TyreProperties: ')}") from None
    file_fields.check_numbers(file, formula, found)
    return properties


def _read(found: object, context: Context) -> TyreProperties:
    if isinstance(found, TyreProperties):
        return found
    if isinstance(found, str | Path):
        with prefixed("", InputError, ValueError):
            return TyreProperties.from_file(file_beside(context or {}, found))
    if isinstance(found, dict):
        return TyreProperties.model_validate(found)
    raise ValueError(f"found {written(found)}, expected the name of a property file, or coefficients by name")


def _schema(_: object) -> JsonSchema:
    name = {
        "type": "string",
        "description": "the name of a property file (.tir), relative to the folder of the file that names it",
    }
    numbers = {"type": "object", "additionalProperties": {"type": "number"}}
    return {"anyOf": [name, {"type": "object", "properties": {"coefficients": numbers}}]}


AnyProperties = Annotated[TyreProperties, ReadBy(_read, _schema)]
