"""Ranges of numbers on the command line: ``1e-3..1e-8``, ``1e5:1e9:9``, ``1,2,5``."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..errors import InputError

if TYPE_CHECKING:
    from ..describe.units.units import Dimension, Quantity

NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
RANGE = re.compile(rf"\s*({NUMBER})\s*(?:\.\.|:)\s*({NUMBER})\s*(?::\s*(\d+)\s*)?")
WITH_UNIT = re.compile(rf"\s*({NUMBER})\s*([^\W\d_][\w /*^()-]*)?")
DECADE = 10.0
LINEAR = 5
"""Default number of points of a range of less than a decade."""
EXPECTED = "expected a range such as 1e5..1e9, with a number of points 1e5..1e9:9, or numbers 1,2,5"


def numbers_in(option: str, text: str, per_decade: int = 1) -> tuple[float, ...]:
    """Return the numbers of a range or a list: logarithmically spaced over a decade or more, else linearly.

    Parameters
    ----------
    option : str
        Option for messages.
    text : str
    per_decade : int
        Default number of points per decade.

    Raises
    ------
    InputError
    """
    import numpy as np

    found = RANGE.fullmatch(text.replace("...", ".. ."))
    if found is None:
        return _listed(option, text)
    first, last = float(found[1]), float(found[2])
    count = int(found[3]) if found[3] else 0
    if first == last or (found[3] and count < 2):
        raise InputError(f"{option}: found '{text}', expected two different ends, and 2 points or more")
    least, most = sorted((first, last))
    if least > 0 and most >= DECADE * least:
        count = count or round(per_decade * np.log10(most / least)) + 1
        spaced = 10.0 ** np.linspace(np.log10(first), np.log10(last), max(count, 2))
    else:
        spaced = np.linspace(first, last, count or LINEAR)
    return (first, *(float(f"{value:.6g}") for value in spaced[1:-1]), last)


def _listed(option: str, text: str) -> tuple[float, ...]:
    parts = [part.strip() for part in text.split(",")]
    if not all(re.fullmatch(NUMBER, part) for part in parts):
        raise InputError(f"{option}: found '{text}', {EXPECTED}")
    return tuple(float(part) for part in parts)


@dataclass(frozen=True)
class Values:
    """Parameter and its values, SI units, with their dimension if units are given."""

    parameter: str
    numbers: tuple[float, ...]
    dimension: Dimension | None = None


def values_in(option: str, text: str) -> Values:
    """Read a parameter and its values: ``k_b=1e5..1e9``, ``k_b=100..1e6 N/mm:9``.

    A number without a unit has that of the last one.

    Raises
    ------
    InputError
    """
    name, equals, rest = text.partition("=")
    if not equals or not name.strip():
        raise InputError(f"{option}: found '{text}', expected PARAMETER=RANGE such as k_b=1e5..1e9")
    *parts, last = re.split(r"(\.\.|:|,)", rest)
    amounts = [WITH_UNIT.fullmatch(part) for part in (*parts[::2], last)]
    written = [found[2] for found in amounts if found and found[2]]
    if not written:
        return Values(name.strip(), numbers_in(option, rest))
    count = f":{amounts[2][1]}" if len(amounts) == 3 and amounts[2] and "," not in parts else ""
    found = [_in_si(option, each, written[-1], text) for each in (amounts[:2] if count else amounts)]
    if len({quantity.dimension for quantity in found}) > 1:
        raise InputError(f"{option}: found '{text}', expected units of one dimension")
    between = "," if "," in parts or not parts else ".."
    numbers = numbers_in(option, between.join(repr(quantity.value) for quantity in found) + count)
    return Values(name.strip(), numbers, found[0].dimension)


def _in_si(option: str, found: re.Match[str] | None, unit: str, text: str) -> Quantity:
    """Return a number with its unit, or with that of the last number."""
    from ..describe.formula.text import FormulaError
    from ..describe.units.quantity import quantity

    if not found:
        raise InputError(f"{option}: found '{text}', {EXPECTED}")
    try:
        return quantity(f"{found[1]} {found[2] or unit}")
    except FormulaError as error:
        raise InputError(f"{option}: {error}") from None
