"""Coefficients of a Magic Formula tyre, from a property file or by name."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Field, model_validator

from ...errors import InputError
from ...reading.did_you_mean import did_you_mean
from ...reading.files.files_read import file_beside
from ...reading.files.quoted import quoted, written
from ...reading.files.requested import unused_notes
from ...reading.table import Table
from ..element import Component
from ..read_by import Context, JsonSchema, ReadBy
from .names import (
    AS_BEFORE,
    COEFFICIENTS,
    COMBINED,
    DIMENSIONS,
    LATER,
    OF_THE_FILE,
    RANGES,
    REASONS,
    REQUIRED,
    SCALES,
    home,
)
from .property_file import PropertyFile, read_property_file

if TYPE_CHECKING:
    import numpy as np

NUMBERS = (*COEFFICIENTS, *SCALES, *DIMENSIONS)
UNLIMITED = 1e12
"""Largest load of a file without FZMAX, N."""
DEFAULTS = {
    **dict.fromkeys(COEFFICIENTS, 0.0), **dict.fromkeys(SCALES, 1.0), "VERTICAL_DAMPING": 0.0, "BREFF": 0.0, "DREFF": 0.0,
    "FREFF": 1 / 3, "LONGVL": 16.7, "FZMAX": UNLIMITED, "PTY2": 1.0,
}  # fmt: skip
"""Default values; FREFF gives the unloaded radius less a third of the deflection as rolling radius."""
WITH_LENGTHS = 10
"""Increment of USE_MODE for transient slips by relaxation lengths."""
MODES = frozenset((*range(5), *range(10, 15)))
"""Values of USE_MODE without sign."""
FITTYPES = (5, 6, 50, 52)
"""FITTYP of MF-Tyre 5.x."""
SIDES = ("left", "right", "symmetric")
FORMATS = ("PAC2002", "MF_05", "MF-TYRE", "MF_52", "52", "MF52")


class Bottoming(Component):
    """Contact of the rim with the road: [BOTTOMING_CURVE] of PAC2002."""

    radius: float = Field(gt=0, description="BOTTOMING_RADIUS, m")
    width: float = Field(0.0, ge=0, description="WIDTH of the tyre, m; without it camber has no effect")
    load: Table = Field(description="force (N) over penetration (m)")


class TyreProperties(Component):
    """Coefficients of the Magic Formula by their names in property files, in SI units.

    Parameters
    ----------
    coefficients : mapping of str to float
        Omitted coefficients are 0, omitted scale factors 1.
    """

    coefficients: dict[str, float] = Field(description="by name, SI units")
    use_mode: int | None = Field(None, description="USE_MODE of PAC2002; 4, or 14 with relaxation lengths, by default")
    side: Literal["", "left", "right", "symmetric"] = Field("", description="TYRESIDE, that the tyre was measured on")
    ranges: dict[str, tuple[float, float]] = Field(
        {},
        description="valid ranges of slip, slip_angle (rad), camber (rad) and load (N)",
    )
    deflection_load: Table | None = Field(
        None, description="load (N) over deflection (m), in place of VERTICAL_STIFFNESS"
    )
    bottoming: Bottoming | None = Field(None, description="contact of the rim with the road")
    remarks: tuple[str, ...] = ()

    @model_validator(mode="after")
    def _complete(self) -> TyreProperties:
        for name in self.coefficients:
            if name not in NUMBERS:
                raise ValueError(
                    f"found the unknown coefficient '{quoted(name)}'{did_you_mean(name, NUMBERS)}, expected one such as PCX1, FNOMIN, LMUX"
                )
        for name in REQUIRED:
            if name not in self.coefficients:
                raise ValueError(f"found no {name}, expected one")
            if not self.coefficients[name]:
                raise ValueError(f"found {name} = 0, expected a number other than zero")
        if self.use_mode is not None and abs(self.use_mode) not in MODES:
            raise ValueError(_wrong_mode(self.use_mode))
        for name in ("FNOMIN", "UNLOADED_RADIUS", "VERTICAL_STIFFNESS"):
            if self.coefficients[name] < 0:
                raise ValueError(f"found {name} = {self.coefficients[name]:g}, expected a number above zero")
        return self

    def __hash__(self) -> int:
        return hash(tuple(self.coefficients.items()))

    @property
    def is_combined(self) -> bool:
        """True if there are weights of combined slip."""
        return any(self.coefficients.get(name, 0.0) for name in COMBINED)

    @property
    def has_lengths(self) -> bool:
        """True if there are relaxation lengths."""
        return any(self.coefficients.get(name, 0.0) for name in ("PTX1", "PTY1"))

    @property
    def is_transient(self) -> bool:
        """True for slips with relaxation lengths, by USE_MODE, or by default if there are lengths."""
        return self.has_lengths and (self.use_mode is None or abs(self.use_mode) > WITH_LENGTHS)

    @property
    def is_mirrored(self) -> bool:
        """True if USE_MODE is negative."""
        return self.use_mode is not None and self.use_mode < 0

    def in_equations(self) -> dict[str, Any]:
        """Return the names and values that the equations use."""
        mode = 4 if self.use_mode is None else abs(self.use_mode) % WITH_LENGTHS
        own = {
            "is_combined": self.is_combined, "mode": str(mode), "is_mirrored": self.is_mirrored, "side": self.side,
            "deflection_load": self.deflection_load, "bottoming": self.bottoming,
        }  # fmt: skip
        return {**DEFAULTS, **self.coefficients, **own}

    def notes(self) -> Iterator[str]:
        """Yield sentences on settings that the equations do not use."""
        yield from self.remarks
        if self.use_mode is not None and abs(self.use_mode) > WITH_LENGTHS and not self.has_lengths:
            yield f"USE_MODE = {self.use_mode} asks for relaxation lengths, and there are none (PTX1, PTY1): slips are those of the steady state"
        if not self.is_combined:
            yield "there are no coefficients of combined slip (RBX1, RCX1, RBY1, RCY1): forces are held on the friction ellipse"

    def wrench(
        self,
        load: Any,
        slip: Any = 0.0,
        slip_angle: Any = 0.0,
        camber: Any = 0.0,
        speed: Any = None,
        friction: Any = 1.0,
    ) -> dict[str, np.ndarray]:
        """Return forces and torques of steady slip, rolling forward, in ISO axes at the contact point.

        Parameters
        ----------
        load : array_like
            N, positive.
        slip : array_like
            kappa, positive when driving.
        slip_angle, camber : array_like
            rad; a positive slip angle gives a negative lateral force, with positive camber the top leans to the right.
        speed : array_like, optional
            m/s, for the rolling resistance; LONGVL of the file by default.
        friction : array_like
            Friction factor of the road.

        Returns
        -------
        dict of str to ndarray
            ``longitudinal``, ``lateral`` (N), ``overturning``, ``rolling``, ``aligning`` (N m); arguments broadcast.
        """
        from .magic_formula import steady_wrench

        numbers = self.in_equations()
        rolling = numbers["LONGVL"] if speed is None else speed
        return steady_wrench(numbers, load, slip, slip_angle, camber, rolling, friction)

    @classmethod
    def from_file(cls, path: str | Path) -> TyreProperties:
        """Read a property file.

        Raises
        ------
        InputError
            If it cannot be read; the message contains the line.
        """
        return _of_file(read_property_file(Path(path)))


def _of_file(file: PropertyFile) -> TyreProperties:
    _check_formula(file)
    found = {
        name: file.number(name, DIMENSIONS.get(name, ""), home(name))
        for name in NUMBERS
        if name in REQUIRED or file.entry(name, home(name))
    }
    read = {
        "coefficients": found, "use_mode": _mode(file), "side": _side(file), "ranges": dict(_ranges(file)),
        "deflection_load": _curve(file, "DEFLECTION_LOAD_CURVE"), "bottoming": _bottoming(file),
    }  # fmt: skip
    for name in OF_THE_FILE:
        file.entry(name)
    remarks = unused_notes([*file.sections.values(), file.tables], REASONS)
    try:
        return TyreProperties(**read, remarks=tuple(f"{file.source}: {note}" for note in remarks))
    except InputError as error:
        raise InputError(f"{file.source}: {str(error).removeprefix('TyreProperties: ')}") from None


def _check_formula(file: PropertyFile) -> None:
    """Refuse files of other formulas, by format, FITTYP, or coefficients that MF-Tyre 5.2 does not have."""
    form = file.text("PROPERTY_FILE_FORMAT")
    if form and form not in FORMATS:
        raise InputError(
            f"{_where(file, 'PROPERTY_FILE_FORMAT')}: found the format '{quoted(form)}', expected PAC2002 or MF-Tyre 5.2 "
            f"({', '.join(FORMATS)})"
        )
    if file.entry("FITTYP", "MODEL"):
        kind = file.number("FITTYP", home="MODEL")
        if kind not in FITTYPES:
            raise InputError(
                f"{_where(file, 'FITTYP')}: found FITTYP = {kind:g}, expected that of MF-Tyre 5.2, one of "
                f"{', '.join(map(str, FITTYPES))}: Magic Formula 6.0 and later are not supported"
            )
        return
    for name in LATER:
        if file.entry(name, home(name)) and file.number(name, home=home(name)) != AS_BEFORE[name]:
            raise InputError(
                f"{_where(file, name)}: found {name} without FITTYP, a coefficient of Magic Formula 6.0 or later, which "
                f"is not supported; expected a file of MF-Tyre 5.2, or FITTYP = {FITTYPES[0]} where {name} has no effect"
            )


def _where(file: PropertyFile, name: str) -> str:
    entry = file.entry(name, home(name))
    return f"{file.source}, line {entry.line}" if entry else file.source


def _ranges(file: PropertyFile) -> Iterator[tuple[str, tuple[float, float]]]:
    """Yield the valid ranges of the file by channel; a missing limit is infinite."""
    for channel, (least, most, dimension) in RANGES.items():
        ends = [file.number(name, dimension) if file.entry(name) else None for name in (least, most)]
        if ends != [None, None]:
            low, high = (-math.inf if ends[0] is None else ends[0]), (math.inf if ends[1] is None else ends[1])
            yield channel, (low, high)


def _curve(file: PropertyFile, section: str) -> Table | None:
    """Return a curve of load (N) over deflection (m)."""
    rows = file.tables.get(f"[{section}]")
    if rows is None:
        return None
    where = f"{file.source}, line {rows.line}: [{section}]"
    if any(len(row) != 2 for row in rows.numbers):
        raise InputError(f"{where}: found a row without exactly two numbers, expected a deflection and a load")
    length, force = file.factor("length"), file.factor("force")
    try:
        return Table(table=tuple((length * deflection, force * load) for deflection, load in rows.numbers))
    except InputError as error:
        raise InputError(f"{where}: {error}") from None


def _bottoming(file: PropertyFile) -> Bottoming | None:
    """Return the contact of the rim, or None if the file has no curve or no radius."""
    if not file.entry("BOTTOMING_RADIUS", "DIMENSION"):
        return None
    load = _curve(file, "BOTTOMING_CURVE")
    if load is None:
        return None
    width = file.number("WIDTH", "length", "DIMENSION") if file.entry("WIDTH", "DIMENSION") else 0.0
    return Bottoming(radius=file.number("BOTTOMING_RADIUS", "length", "DIMENSION"), width=width, load=load)


def _mode(file: PropertyFile) -> int | None:
    if not file.entry("USE_MODE", "MODEL"):
        return None
    mode = file.number("USE_MODE", home="MODEL")
    if abs(mode) not in MODES:
        raise InputError(f"{_where(file, 'USE_MODE')}: {_wrong_mode(mode)}")
    return int(mode)


def _wrong_mode(mode: float) -> str:
    return (
        f"found USE_MODE = {mode:g}, expected 0 to 4 for steady slip, 10 to 14 for slip with relaxation lengths, or the negative "
        "of one of these for a mirrored tyre"
    )


def _side(file: PropertyFile) -> Any:
    side = file.text("TYRESIDE").lower()
    if side and side not in SIDES:
        raise InputError(
            f"{_where(file, 'TYRESIDE')}: found TYRESIDE = '{quoted(side)}', expected one of {', '.join(SIDES)}"
        )
    return side


def _read(found: object, context: Context) -> TyreProperties:
    if isinstance(found, TyreProperties):
        return found
    if isinstance(found, str | Path):
        try:
            return TyreProperties.from_file(file_beside(context or {}, found))
        except InputError as error:
            raise ValueError(str(error)) from None
    if isinstance(found, dict):
        return TyreProperties.model_validate(found)
    raise ValueError(f"found {written(found)}, expected the name of a property file, or coefficients by name")


def _schema(_: object) -> JsonSchema:
    name = {"type": "string", "description": "the name of a property file (.tir), beside the scene"}
    numbers = {"type": "object", "additionalProperties": {"type": "number"}}
    return {"anyOf": [name, {"type": "object", "properties": {"coefficients": numbers}}]}


AnyProperties = Annotated[TyreProperties, ReadBy(_read, _schema)]
