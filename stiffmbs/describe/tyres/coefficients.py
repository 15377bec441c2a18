"""The coefficients of a Magic Formula tyre: from a property file, or by name."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Field, GetCoreSchemaHandler, GetJsonSchemaHandler, ValidationInfo, model_validator
from pydantic_core import core_schema

from ...errors import InputError
from ..element import Component
from ..files.other_files import file_beside
from ..files.quoted import quoted, written
from .names import COEFFICIENTS, COMBINED, DIMENSIONS, KNOWN_UNUSED, REQUIRED, SCALES, TEXTS
from .property_file import PropertyFile, read_property_file

if TYPE_CHECKING:
    import numpy as np

NUMBERS = (*COEFFICIENTS, *SCALES, *DIMENSIONS)
UNLIMITED = 1e12
"""N, the largest load where a file has no FZMAX."""
DEFAULTS = {
    **dict.fromkeys(COEFFICIENTS, 0.0), **dict.fromkeys(SCALES, 1.0), "VERTICAL_DAMPING": 0.0, "BREFF": 0.0, "DREFF": 0.0,
    "FREFF": 1 / 3, "LONGVL": 16.7, "FZMAX": UNLIMITED, "PTY2": 1.0,
}  # fmt: skip
"""FREFF: a rolling radius of the unloaded one less a third of the deflection."""
WITH_LENGTHS = 10
"""What USE_MODE is greater by where slips lag by relaxation lengths."""
MODES = frozenset((*range(5), *range(10, 15)))
"""USE_MODE without its sign."""
LATER_FORMULA = 60
"""FITTYP from which on a file is of MF-Tyre 6.0 or later."""
SIDES = ("left", "right", "symmetric")
FORMATS = ("PAC2002", "MF_05", "MF-TYRE", "MF_52", "52", "MF52")


class TyreProperties(Component):
    """Coefficients of the Magic Formula by their names in property files, in SI units.

    Parameters
    ----------
    coefficients : mapping of str to float
        Those that are left out are 0, scale factors 1.
    """

    coefficients: dict[str, float] = Field(description="by name, SI units")
    use_mode: int | None = Field(None, description="USE_MODE of PAC2002; 4, or 14 with relaxation lengths, by default")
    side: Literal["", "left", "right", "symmetric"] = Field("", description="TYRESIDE, that the tyre was measured on")
    remarks: tuple[str, ...] = ()

    @model_validator(mode="after")
    def _complete(self) -> TyreProperties:
        for name in self.coefficients:
            if name not in NUMBERS:
                raise ValueError(
                    f"found the unknown coefficient '{quoted(name)}', expected one such as PCX1, FNOMIN, LMUX"
                )
        for name in REQUIRED:
            if name not in self.coefficients:
                raise ValueError(f"found no {name}, expected one")
            if not self.coefficients[name]:
                raise ValueError(f"found {name} = 0, expected a number other than zero")
        if self.use_mode is not None and abs(self.use_mode) not in MODES:
            raise ValueError(
                f"found USE_MODE = {self.use_mode}, expected 0 to 4 for steady slip, 10 to 14 for slip with relaxation "
                "lengths, or one of these below zero for a mirrored tyre"
            )
        for name in ("FNOMIN", "UNLOADED_RADIUS", "VERTICAL_STIFFNESS"):
            if self.coefficients[name] < 0:
                raise ValueError(f"found {name} = {self.coefficients[name]:g}, expected a number above zero")
        return self

    def __hash__(self) -> int:
        return hash(tuple(self.coefficients.items()))

    @property
    def is_combined(self) -> bool:
        """Whether there are weights of combined slip."""
        return any(self.coefficients.get(name, 0.0) for name in COMBINED)

    @property
    def has_lengths(self) -> bool:
        """Whether there are relaxation lengths."""
        return any(self.coefficients.get(name, 0.0) for name in ("PTX1", "PTY1"))

    @property
    def is_transient(self) -> bool:
        """Whether slips are to lag by relaxation lengths: as USE_MODE says, and without it where there are lengths."""
        return self.has_lengths and (self.use_mode is None or abs(self.use_mode) > WITH_LENGTHS)

    @property
    def is_mirrored(self) -> bool:
        """Whether USE_MODE is below zero."""
        return self.use_mode is not None and self.use_mode < 0

    def in_equations(self) -> dict[str, Any]:
        mode = 4 if self.use_mode is None else abs(self.use_mode) % WITH_LENGTHS
        own = {"is_combined": self.is_combined, "mode": str(mode), "is_mirrored": self.is_mirrored, "side": self.side}
        return {**DEFAULTS, **self.coefficients, **own}

    def notes(self) -> Iterator[str]:
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
        """Forces and torques of steady slip, rolling forward, in ISO axes at the point of contact.

        Parameters
        ----------
        load : array_like
            N, above zero.
        slip : array_like
            kappa, above zero when driving.
        slip_angle, camber : array_like
            rad; a slip angle above zero gives a lateral force below zero, camber above zero leans the top to the right.
        speed : array_like, optional
            m/s, for the rolling resistance; LONGVL of the file by default.
        friction : array_like
            Factor of the road.

        Returns
        -------
        dict of str to ndarray
            ``longitudinal``, ``lateral`` (N), ``overturning``, ``rolling``, ``aligning`` (N m); arguments broadcast.
        """
        from .steady import steady_wrench

        numbers = self.in_equations()
        rolling = numbers["LONGVL"] if speed is None else speed
        return steady_wrench(numbers, load, slip, slip_angle, camber, rolling, friction)

    @classmethod
    def from_file(cls, path: str | Path) -> TyreProperties:
        """Read a property file.

        Raises
        ------
        InputError
            When it cannot be read; names the line.
        """
        return _of_file(read_property_file(Path(path)))


def _of_file(file: PropertyFile) -> TyreProperties:
    form = file.text("PROPERTY_FILE_FORMAT")
    if form and form not in FORMATS:
        line = file.entries["PROPERTY_FILE_FORMAT"].line
        raise InputError(
            f"{file.source}, line {line}: found the format '{quoted(form)}', expected PAC2002 or MF-Tyre 5.2 "
            f"({', '.join(FORMATS)})"
        )
    found = {
        name: file.number(name, DIMENSIONS.get(name, ""))
        for name in NUMBERS
        if name in file.entries or name in REQUIRED
    }
    unknown = [name for name in file.entries if name not in (*NUMBERS, *KNOWN_UNUSED, *TEXTS)]
    remarks = [f"{file.source}: the keys {', '.join(unknown)} are not used"] if unknown else []
    if "FITTYP" in file.entries and file.number("FITTYP") >= LATER_FORMULA:
        line = file.entries["FITTYP"].line
        remarks.append(
            f"{file.source}, line {line}: FITTYP is that of a later Magic Formula, and its forces are those of MF-Tyre 5.2"
        )
    try:
        return TyreProperties(coefficients=found, use_mode=_mode(file), side=_side(file), remarks=tuple(remarks))
    except InputError as error:
        raise InputError(f"{file.source}: {str(error).removeprefix('TyreProperties: ')}") from None


def _mode(file: PropertyFile) -> int | None:
    """USE_MODE, if there is one."""
    if "USE_MODE" not in file.entries:
        return None
    mode, line = file.number("USE_MODE"), file.entries["USE_MODE"].line
    if abs(mode) not in MODES:
        raise InputError(
            f"{file.source}, line {line}: found USE_MODE = {mode:g}, expected 0 to 4 for steady slip, 10 to 14 for slip with "
            "relaxation lengths, or one of these below zero for a mirrored tyre"
        )
    return int(mode)


def _side(file: PropertyFile) -> Any:
    """TYRESIDE, in small letters."""
    side = file.text("TYRESIDE").lower()
    if side and side not in SIDES:
        line = file.entries["TYRESIDE"].line
        raise InputError(
            f"{file.source}, line {line}: found TYRESIDE = '{quoted(side)}', expected one of {', '.join(SIDES)}"
        )
    return side


class _PropertiesField:
    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> Any:
        def read(found: object, info: ValidationInfo) -> TyreProperties:
            return _read(found, info.context or {})

        return core_schema.with_info_plain_validator_function(read)

    def __get_pydantic_json_schema__(self, schema: Any, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        name = {"type": "string", "description": "the name of a property file (.tir), beside the scene"}
        numbers = {"type": "object", "additionalProperties": {"type": "number"}}
        return {"anyOf": [name, {"type": "object", "properties": {"coefficients": numbers}}]}


def _read(found: object, context: Mapping[str, Any]) -> TyreProperties:
    if isinstance(found, TyreProperties):
        return found
    if isinstance(found, str | Path):
        try:
            return TyreProperties.from_file(file_beside(context, found))
        except InputError as error:
            raise ValueError(str(error)) from None
    if isinstance(found, dict):
        return TyreProperties.model_validate(found)
    raise ValueError(f"found {written(found)}, expected the name of a property file, or coefficients by name")


AnyProperties = Annotated[TyreProperties, _PropertiesField()]
