"""Variations of a study: one value of the scene over a list, or over a range."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..describe.units.quantity import quantity
from ..errors import InputError

MOST_VALUES = 10_000_000


@dataclass(frozen=True)
class Range:
    """Range from which a sample draws values.

    Parameters
    ----------
    low, high : float
        Ends of the range, SI units.
    log : bool
        True if values are spread evenly over the logarithm.

    Raises
    ------
    InputError
        If the ends are not finite numbers in increasing order, or not positive for a logarithm.
    """

    low: float
    high: float
    log: bool = False

    def __post_init__(self) -> None:
        if not (np.isfinite(self.low) and np.isfinite(self.high) and self.low < self.high):
            raise InputError(f"range: found {self.low:g} to {self.high:g}, expected two numbers, the lower one first")
        if self.log and self.low <= 0:
            raise InputError(f"range: found {self.low:g} to {self.high:g}, expected positive ends for a logarithm")

    def at(self, part: np.ndarray) -> np.ndarray:
        """Return the values at parts of the range, 0 at its lower and 1 at its upper end; shape as `part`."""
        if self.log:
            return np.exp(np.log(self.low) + part * (np.log(self.high) - np.log(self.low)))
        return self.low + part * (self.high - self.low)


@dataclass(frozen=True)
class Variation:
    """Value of the scene that varies.

    Attributes
    ----------
    name : str
        A parameter, or a path such as ``forces.bushing.stiffness`` or ``run.rtol``.
    values : tuple
        Values of a grid: numbers, text, or nested lists for vectors and matrices; empty for a range without a count.
    range : Range or None
        Range from which a sample draws; None if it picks one of the values.
    """

    name: str
    values: tuple[Any, ...]
    range: Range | None = None

    def drawn(self, part: np.ndarray) -> tuple[Any, ...]:
        """Return the values of a sample for numbers from 0 to 1, shape (n,)."""
        if self.range is not None:
            return tuple(self.range.at(part).tolist())
        picked = np.minimum((part * len(self.values)).astype(int), len(self.values) - 1)
        return tuple(self.values[k] for k in picked)


def variation(name: str, found: Any) -> Variation:
    """Return the variation that a keyword of `stiffmbs.sweep` describes.

    Parameters
    ----------
    name : str
    found : sequence, ndarray, Range, Variation or str
        Values, each of which may be a vector or a matrix; or text as for `read_variation`.

    Raises
    ------
    InputError
        If it is none of these, or is empty.
    """
    if isinstance(found, Range):
        return Variation(name, (), found)
    if isinstance(found, str):
        return read_variation(f"{name}={found}")
    if not isinstance(found, Iterable):
        raise InputError(f"{name}: found {found!r}, expected a list of values, an array or a range")
    values = tuple(_plain(value) for value in found)
    if not values:
        raise InputError(f"{name}: found no value, expected one or more")
    return Variation(name, values)


def _plain(value: Any) -> Any:
    return value.tolist() if hasattr(value, "tolist") else value


def read_variation(text: str, option: str = "--vary") -> Variation:
    """Read the variation of ``--vary`` or another option: ``k_b=1e5:1e9:200:log``, ``zeta=0.02,0.1``.

    Without the count it is the range of a sample.  Values may have units (``0.1 m:0.5 m:5``).

    Raises
    ------
    InputError
        If the text is invalid.
    """
    name, equals, given = (part.strip() for part in text.partition("="))
    if not (name and equals and given):
        raise InputError(
            f"{option} {text}: found no values, expected NAME=LOW:HIGH:COUNT[:log] or NAME=VALUE,VALUE,..."
        )
    if ":" not in given or given.startswith(("[", "{", '"', "'")):
        return Variation(name, tuple(_listed(f"{option} {text}", given)))
    parts = [part.strip() for part in given.split(":")]
    log = parts[-1] == "log"
    ends = parts[:-1] if log else parts
    if len(ends) not in (2, 3):
        raise InputError(
            f"{option} {text}: found {len(ends)} numbers, expected LOW:HIGH:COUNT or LOW:HIGH, and :log or nothing"
        )
    try:
        chosen = Range(number(ends[0]), number(ends[1]), log)
    except InputError as error:
        raise InputError(f"{option} {text}: {error}") from None
    return Variation(
        name, tuple(chosen.at(_spread(f"{option} {text}", ends[2])).tolist()) if len(ends) == 3 else (), chosen
    )


def _spread(place: str, count: str) -> np.ndarray:
    if not count.isdigit() or not 2 <= int(count) <= MOST_VALUES:
        raise InputError(f"{place}: found the count '{count}', expected a whole number of 2 or more")
    return np.linspace(0.0, 1.0, int(count))


def number(text: str) -> float:
    """Read a number, or a quantity with a unit, in SI units.

    Raises
    ------
    InputError
        If the text is neither.
    """
    try:
        return float(text)
    except ValueError:
        pass
    try:
        return float(quantity(text, {}).value)
    except ValueError as error:
        raise InputError(str(error)) from None


def _listed(place: str, given: str) -> list[Any]:
    """Return the values between commas outside of brackets."""
    from ..describe.files.yaml_text import read_yaml

    found = read_yaml(f"[{given}]", place)
    if not isinstance(found, list) or not found or None in found:
        raise InputError(f"{place}: found no list of values, expected such as zeta=0.02,0.1")
    return [_asnumber(value) for value in found]


def _asnumber(value: Any) -> Any:
    """Convert text such as ``1e5``, which YAML does not read as a number."""
    if isinstance(value, list):
        return [_asnumber(part) for part in value]
    try:
        return float(value) if isinstance(value, str) else value
    except ValueError:
        return value
