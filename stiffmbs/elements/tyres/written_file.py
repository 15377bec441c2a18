"""Writing of tyre properties as a property file (.tir)."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

from ...errors import InputError
from ...reading.did_you_mean import instead_of
from ...reading.files.quoted import quoted
from .names import RANGES
from .property_file import UNITS, composed_of

if TYPE_CHECKING:
    from .coefficients import TyreProperties

SI_UNITS = {"LENGTH": "meter", "FORCE": "newton", "ANGLE": "radian", "MASS": "kg", "TIME": "second"}
"""Units of a file by default."""
FITTYPS = {"5.2": 6, "6.1": 61, "6.2": 62}
OF_RANGES = {
    "slip": "LONG_SLIP_RANGE", "slip_angle": "SLIP_ANGLE_RANGE", "camber": "INCLINATION_ANGLE_RANGE",
    "load": "VERTICAL_FORCE_RANGE", "pressure": "INFLATION_PRESSURE_RANGE",
}  # fmt: skip
"""Sections of the valid ranges, by channel."""


def property_text(properties: TyreProperties, units: Mapping[str, str] | None = None) -> str:
    """Return a property file that gives the same evaluation.

    `units`: units of LENGTH, FORCE, ANGLE, MASS and TIME by their names in Adams/Tire; SI units by default. Raises
    InputError for an unknown dimension or unit.
    """
    named = SI_UNITS | _checked(units or {})
    sections: dict[str, list[str]] = {"UNITS": [_line(kind, f"'{unit}'") for kind, unit in named.items()]}
    for section, key, value, dimension in _entries(properties):
        shown = f"'{value}'" if isinstance(value, str) else repr(value / _factor(dimension, named))
        sections.setdefault(section, []).append(_line(key, shown))
    lines = ["[MDI_HEADER]", _line("FILE_TYPE", "'tir'"), _line("FILE_VERSION", "3.0"), _line("FILE_FORMAT", "'ASCII'")]
    for section, entries in sections.items():
        lines += [f"[{section}]", *entries]
    return "\n".join([*lines, *_curves(properties, named)]) + "\n"


def _checked(units: Mapping[str, str]) -> dict[str, str]:
    for kind, unit in units.items():
        if kind not in UNITS:
            raise InputError(f"found the dimension '{quoted(kind)}'{instead_of(kind, UNITS)}")
        if unit.lower() not in UNITS[kind]:
            raise InputError(f"{kind}: found the unit '{quoted(unit)}', expected one of {', '.join(UNITS[kind])}")
    return dict(units)


def _factor(dimension: str, units: Mapping[str, str]) -> float:
    product, divisor = ([UNITS[kind][units[kind].lower()] for kind in kinds] for kinds in composed_of(dimension, units))
    return math.prod(product) / math.prod(divisor)


def _line(key: str, value: str) -> str:
    return f"{key:24} = {value}"


def _entries(p: TyreProperties) -> Iterator[tuple[str, str, str | float, str]]:
    """Yield section, key, value in SI units, and dimension."""
    if not p.formula.is_6:
        form = "FIALA" if not p.formula.is_magic else "PAC2002" if p.of_adams else "MF_05"
        yield "MODEL", "PROPERTY_FILE_FORMAT", form, ""
    if p.formula.is_magic:
        yield "MODEL", "FITTYP", FITTYPS[p.version], ""
    if p.use_mode is not None:
        yield "MODEL", "USE_MODE", p.use_mode, ""
    if p.side:
        yield "MODEL", "TYRESIDE", p.side.upper(), ""
    for name, value in p.coefficients.items():
        yield p.formula.home(name), name, value, p.formula.dimensions.get(name, "")
    for channel, ends in p.ranges.items():
        *names, dimension = RANGES[channel]
        for name, value in zip(names, ends, strict=True):
            if math.isfinite(value) and name not in p.coefficients:
                yield OF_RANGES[channel], name, value, dimension
    if p.belt:
        yield from (("ALIGNING_COEFFICIENTS", "QTZ1", 1.0, ""), ("ALIGNING_COEFFICIENTS", "MBELT", p.belt, "mass"))
    yield from _rim(p)


def _rim(p: TyreProperties) -> Iterator[tuple[str, str, float, str]]:
    rim = p.bottoming
    if rim is None:
        return
    if not p.formula.is_6:
        yield "DIMENSION", "BOTTOMING_RADIUS", rim.radius, "length"
        if rim.width and "WIDTH" not in p.coefficients:
            yield "DIMENSION", "WIDTH", rim.width, "length"
        return
    (x0, f0), (x1, f1) = rim.load.table[0], rim.load.table[-1]
    yield "DIMENSION", "RIM_RADIUS", rim.radius, "length"
    yield "VERTICAL", "BOTTOM_STIFF", (f1 - f0) / (x1 - x0), "stiffness"


def _curves(p: TyreProperties, units: Mapping[str, str]) -> Iterator[str]:
    """Yield the lines of [DEFLECTION_LOAD_CURVE] and [BOTTOMING_CURVE]."""
    bottoming = p.bottoming.load if p.bottoming is not None and not p.formula.is_6 else None
    for section, curve in (("DEFLECTION_LOAD_CURVE", p.deflection_load), ("BOTTOMING_CURVE", bottoming)):
        if curve is not None:
            length, force = _factor("length", units), _factor("force", units)
            yield from (f"[{section}]", "{pen fz}", *(f"{x / length!r} {f / force!r}" for x, f in curve.table))
