"""Accuracy asked of the results of a run: ``accuracy: {forces: 1 %, positions: 0.1 mm}``."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from ..reading.did_you_mean import instead_of
from ..reading.files.quoted import quoted, written
from ..reading.units.quantity import in_si

UNITS = {"positions": "length", "velocities": "velocity", "forces": "force"}
"""Groups of channels, and the dimension of an absolute accuracy."""


class Wanted(NamedTuple):
    """Largest error of a group of channels: relative to the largest value of each body or element, or in SI units."""

    group: str
    error: float
    relative: bool
    text: str


def wanted(found: object) -> tuple[Wanted, ...]:
    """Return the accuracy that a mapping asks for; raise a ValueError for unknown groups and other values."""
    if not isinstance(found, Mapping):
        raise ValueError(f"found {written(found)}, expected a mapping such as {{forces: 1 %, positions: 0.1 mm}}")
    return tuple(_wanted(group, value) for group, value in found.items())


def _wanted(group: object, value: object) -> Wanted:
    if group not in UNITS:
        raise ValueError(f"found '{quoted(group)}'{instead_of(group, UNITS)}")
    text = str(value).strip()
    relative = text.endswith("%")
    number = in_si(text[:-1].strip() if relative else value, "number" if relative else UNITS[str(group)])
    if number <= 0.0:
        raise ValueError(f"{group}: found {written(value)}, expected an error greater than zero")
    return Wanted(str(group), number / 100.0 if relative else number, relative, text)


def from_option(text: str) -> dict[str, str]:
    """Return the mapping of an option ``forces=1%,positions=0.1mm``."""
    pairs = (part.partition("=") for part in text.split(","))
    return {name.strip(): value.strip() for name, _, value in pairs}
