"""Values of a parameter: a list, or a range with equal steps or equal ratios.

This is the syntax of ``stiffmbs study --vary``, ``compare --over``, ``--rtol`` and ``--step``, ``fit --parameter`` and
``optimise --parameter``, and of the Python functions of the same names.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import InputError, prefixed
from .files.yaml_text import read_yaml
from .formula.text import FormulaError
from .units.quantity import quantity
from .units.units import Dimension, Quantity

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

MOST_VALUES = 10_000_000
EVENLY = 5
"""Default number of values of a range with equal steps."""
FORMS = "FROM:TO:COUNT, FROM:TO:COUNT:log or VALUE,VALUE,..."
NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
WITH_UNIT = re.compile(rf"({NUMBER})\s*([^\W\d_][\w /*^()-]*)?")
DOTS = re.compile(rf"({WITH_UNIT.pattern})\.\.(?=\s*[-+.\d])")


@dataclass(frozen=True)
class Range:
    """Range of values.

    Parameters
    ----------
    low, high : float
        Ends of the range, SI units.
    log : bool
        True if values are spread evenly over the logarithm.
    count : int, optional
        Number of values of a grid, ends included.

    Raises
    ------
    InputError
        If the ends are not finite numbers in increasing order, or not positive for a logarithm, or the count is not a
        whole number of 2 or more.
    """

    low: float
    high: float
    log: bool = False
    count: int | None = None

    def __post_init__(self) -> None:
        if not (np.isfinite(self.low) and np.isfinite(self.high) and self.low < self.high):
            raise InputError(f"range: found {self.low:g} to {self.high:g}, expected two numbers, the lower one first")
        if self.log and self.low <= 0:
            raise InputError(f"range: found {self.low:g} to {self.high:g}, expected positive ends for a logarithm")
        if self.count is not None and not 2 <= self.count <= MOST_VALUES:
            raise InputError(f"range: found the count {self.count}, expected a whole number from 2 to {MOST_VALUES}")

    def at(self, part: np.ndarray) -> np.ndarray:
        """Return the values at parts of the range, 0 at its lower and 1 at its upper end; shape as `part`."""
        if self.log:
            return np.exp(np.log(self.low) + part * (np.log(self.high) - np.log(self.low)))
        return self.low + part * (self.high - self.low)

    def spread(self, count: int) -> tuple[float, ...]:
        """Return a number of values from the lower to the upper end, at equal steps or ratios."""
        return tuple((np.geomspace if self.log else np.linspace)(self.low, self.high, count).tolist())


@dataclass(frozen=True)
class Variation:
    """Varied value of a scene."""

    name: str  # a parameter, or a path such as ``forces.bushing.stiffness`` or ``run.rtol``
    # values of a grid: numbers, text, or nested lists for vectors and matrices; empty for a range without a count
    values: tuple[Any, ...]
    range: Range | None = None  # range from which a sample draws; None if it picks one of the values
    dimension: Dimension | None = None  # dimension of the values if they are written with units

    def drawn(self, part: np.ndarray) -> tuple[Any, ...]:
        """Return the values of a sample for numbers from 0 to 1, shape (n,)."""
        if self.range is not None:
            return tuple(self.range.at(part).tolist())
        picked = np.minimum((part * len(self.values)).astype(int), len(self.values) - 1)
        return tuple(self.values[k] for k in picked)


def variation(name: str, found: str | Range | Variation | Sequence[object] | ArrayLike) -> Variation:
    """Return the variation of a parameter; text is read as by `read_variation`, without the name.

    Each value may be a vector or a matrix. Raise an InputError for anything else, or for no values.
    """
    match found:
        case Variation():
            return found
        case Range():
            return Variation(name, found.spread(found.count) if found.count else (), found)
        case str():
            return _read(f"{name}={found}", name, found.strip())
    if not isinstance(found, Iterable):
        raise InputError(f"{name}: found {found!r}, expected a list of values, an array or a range")
    values = tuple(_plain(value) for value in found)
    if not values:
        raise InputError(f"{name}: found no value, expected one or more")
    return Variation(name, values)


def numbers_of(found: Variation, per_decade: int, evenly: int = EVENLY) -> tuple[float, ...]:
    """Return the values of a variation in increasing order.

    `per_decade`: number of values per decade of a range with equal ratios that has no count. `evenly`: number of values of
    one with equal steps. Raises InputError if a value is not a number.
    """
    if found.range is not None and not found.values:
        low, high = found.range.low, found.range.high
        return found.range.spread(max(round(per_decade * np.log10(high / low)), 1) + 1 if found.range.log else evenly)
    try:
        return tuple(sorted(map(float, found.values)))
    except (TypeError, ValueError):
        raise InputError(f"{found.name}: found {list(found.values)}, expected numbers as {FORMS}") from None


def _plain(value: object) -> Any:
    return value.tolist() if hasattr(value, "tolist") else value


def read_variation(text: str, option: str) -> Variation:
    """Read the variation of an option: ``k_b=1e5:1e9:200:log``, ``L=0.1:0.5 m:5``, ``zeta=0.02,0.1``.

    The ends of a range may come in either order; a range may have no count.  A number without a unit has the unit of
    the last number.  Two dots, as in ``1e5..1e9:9``, are the older form of the first colon; such a range has equal
    ratios if it spans a decade or more.  Raise an InputError if the text is invalid.
    """
    name, equals, given = (part.strip() for part in text.partition("="))
    if not (name and equals and given):
        raise InputError(f"{option} {text}: found no values, expected NAME={FORMS}")
    return _read(f"{option} {text}", name, given)


def _read(place: str, name: str, given: str) -> Variation:
    colons = DOTS.sub(r"\1:", given, count=1)
    if ":" not in colons or given.startswith(("[", "{", '"', "'")):
        return _listed(place, name, given)
    *ends, last = (part.strip() for part in colons.split(":"))
    log = last == "log"
    ends = ends if log else [*ends, last]
    if len(ends) not in (2, 3):
        raise InputError(f"{place}: found {len(ends)} numbers, expected {FORMS}")
    with prefixed(f"{place}: ", (FormulaError, InputError)):
        found = _quantities(ends[:2])
        low, high = sorted(one.value for one in found)
        log = log or (colons != given and 0 < 10 * low <= high)
        chosen = Range(low, high, log, _count(ends[2]) if len(ends) == 3 else None)
    return Variation(name, variation(name, chosen).values, chosen, found[-1].dimension)


def _count(text: str) -> int:
    if not text.isdigit():
        raise InputError(f"found the count '{text}', expected a whole number of 2 or more")
    return int(text)


def _quantities(texts: Sequence[str]) -> list[Quantity]:
    """Return quantities in SI units and of one dimension; a number without a unit has that of the last number."""
    units = [found[2] for found in map(WITH_UNIT.fullmatch, texts) if found and found[2]]
    found = [quantity(f"{text} {units[-1]}" if units and re.fullmatch(NUMBER, text) else text) for text in texts]
    if len({one.dimension for one in found}) > 1:
        raise InputError("found values of different dimensions, expected units of one dimension")
    return found


def number(text: str) -> float:
    """Read a number, or a quantity with a unit, in SI units; raise an InputError if the text is neither."""
    with prefixed("", FormulaError):
        return quantity(text).value


def _listed(place: str, name: str, given: str) -> Variation:
    """Return the values between commas outside of brackets; numbers with units in SI units."""
    found = read_yaml(f"[{given}]", place)
    if not isinstance(found, list) or not found or None in found:
        raise InputError(f"{place}: found no list of values, expected such as zeta=0.02,0.1")
    texts = [str(value) for value in found]
    if any(isinstance(value, str) for value in found) and all(map(WITH_UNIT.fullmatch, texts)):
        try:
            numbers = _quantities(texts)
            return Variation(name, tuple(one.value for one in numbers), None, numbers[-1].dimension)
        except InputError as error:
            raise InputError(f"{place}: {error}") from None
        except FormulaError:  # text that begins with a digit
            pass
    return Variation(name, tuple(_asnumber(value) for value in found))


def _asnumber(value: object) -> object:
    """Convert text such as ``1e5``, which YAML does not read as a number."""
    if isinstance(value, list):
        return [_asnumber(part) for part in value]
    try:
        return float(value) if isinstance(value, str) else value
    except ValueError:
        return value
