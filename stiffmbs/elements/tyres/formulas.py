"""Versions of the Magic Formula: how property files name them, and their numbers with default values."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from .names import AS_BEFORE, COEFFICIENTS, COEFFICIENTS_6, DIMENSIONS, DIMENSIONS_6, SCALES, SCALES_6

UNLIMITED = 1e12
"""Largest load of a file without FZMAX, N."""
NOMINAL_PRESSURE = 2e5
"""Nominal pressure of a file without NOMPRES, Pa."""


@dataclass(frozen=True)
class Version:
    """Version of the Magic Formula.

    Attributes
    ----------
    name : str
    dimensions : mapping of str to str
        Numbers that are neither coefficients nor scale factors, with their dimensions.
    defaults : mapping of str to float
        Default values; numbers without one are required.
    modes : frozenset of int
        Values of USE_MODE without sign.
    """

    name: str
    dimensions: Mapping[str, str]
    defaults: Mapping[str, float]
    modes: frozenset[int]

    @property
    def numbers(self) -> tuple[str, ...]:
        """Names of all numbers."""
        return tuple(dict.fromkeys((*self.defaults, *self.dimensions)))

    @property
    def has_pressure(self) -> bool:
        """True for 6.1 and 6.2, whose tyres depend on inflation pressure."""
        return "NOMPRES" in self.dimensions


_OF_5 = {
    **dict.fromkeys(COEFFICIENTS, 0.0), **dict.fromkeys(SCALES, 1.0), "VERTICAL_DAMPING": 0.0, "BREFF": 0.0, "DREFF": 0.0,
    "FREFF": 1 / 3, "LONGVL": 16.7, "FZMAX": UNLIMITED, "PTY2": 1.0,
}  # fmt: skip
"""Default values; FREFF gives the unloaded radius less a third of the deflection as rolling radius."""
_OF_6 = {
    **dict.fromkeys((*COEFFICIENTS_6, *DIMENSIONS_6), 0.0), **dict.fromkeys(SCALES_6, 1.0), "LMUV": 0.0, "FREFF": 1 / 3,
    "LONGVL": 16.7, "FZMAX": UNLIMITED, "INFLPRES": 0.0, "NOMPRES": NOMINAL_PRESSURE, "Q_RE0": 1.0,
    "PKY4": AS_BEFORE["PKY4"], "QSY7": AS_BEFORE["QSY7"], "PHYP1": 1.0, "QDRP1": 1.0,
}  # fmt: skip
"""Default values; those of omitted coefficients of 6.1 have the effect of MF-Tyre 5.2, INFLPRES = 0 means NOMPRES."""
_STEADY = (*range(5), *range(10, 15))
VERSIONS = {
    version.name: version
    for version in (
        Version("5.2", DIMENSIONS, _OF_5, frozenset(_STEADY)),
        Version("6.1", DIMENSIONS_6, _OF_6, frozenset((*_STEADY, *range(20, 26), 5, 15))),
        Version("6.2", DIMENSIONS_6, _OF_6, frozenset((*_STEADY, *range(20, 26), 5, 15))),
    )
}
OF_FITTYP = {
    **dict.fromkeys(("5", "6", "50", "51", "52", "MF52", "PAC2002"), "5.2"),
    **dict.fromkeys(("60", "61", "MF61"), "6.1"), **dict.fromkeys(("62", "MF62"), "6.2"),
}  # fmt: skip
"""Version by FITTYP; version 6.1 includes files of 6.0."""
OF_FORMAT = {
    **dict.fromkeys(("PAC2002", "MF05", "MFTYRE", "MF52", "52"), "5.2"),
    **dict.fromkeys(("MF61", "61"), "6.1"), **dict.fromkeys(("MF62", "62"), "6.2"), "USER": "",
}  # fmt: skip
"""Version by PROPERTY_FILE_FORMAT; empty if FITTYP states it."""


def plain(word: Any) -> str:
    """Return a name of a version without punctuation, such as MF52 for 'MF_5.2'."""
    return "".join(letter for letter in str(word).upper() if letter.isalnum())
