"""Crossings over a parameter: values at which implicit steps become faster than explicit ones, or the reverse."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .at_error import AtError
from .entries import Entry

Best = tuple[str, float]


@dataclass(frozen=True)
class Crossing:
    """Change of the faster kind of integrator between two values of a parameter.

    Attributes
    ----------
    before, then : str
        Faster solver below, and above.
    at : float
        Value at which both take the same time.
    between : (float, float)
        Values of the parameter on both sides.
    measured : bool
        True if both have a time on both sides; otherwise one of them fails there, and `at` is the middle.
    """

    before: str
    then: str
    at: float
    between: tuple[float, float]
    measured: bool

    def as_dict(self) -> dict[str, Any]:
        """Return an entry of ``crossings`` in ``stiffmbs compare --json``."""
        return {"before": self.before, "then": self.then, "at": self.at, "between": list(self.between)}


def crossings(values: Sequence[float], at: Sequence[AtError | None], entries: Sequence[Entry]) -> Iterator[Crossing]:
    """Yield the crossings of the best implicit and the best explicit integrator.

    Parameters
    ----------
    values : sequence of float
        Values of the parameter, in order.
    at : sequence of AtError or None
        Times at the error, by value.
    entries : sequence of Entry
    """
    kinds = [[entry.name for entry in entries if entry.implicit], [entry.name for entry in entries if entry.explicit]]
    if not all(kinds):
        return
    best = [[_best(found.seconds if found else {}, names) for names in kinds] for found in at]
    known = [(value, pair) for value, pair in zip(values, best, strict=True) if any(np.isfinite(b[1]) for b in pair)]
    logarithmic = _logarithmic(values)
    for (a, one), (b, other) in itertools.pairwise(known):
        with np.errstate(divide="ignore"):  # infinite if one kind has no time
            lead = [float(np.log(pair[0][1] / pair[1][1])) for pair in (one, other)]  # positive: explicit is faster
        if lead[0] * lead[1] >= 0:
            continue
        measured = bool(np.all(np.isfinite(lead)))
        part = lead[0] / (lead[0] - lead[1]) if measured else 0.5
        place = a ** (1 - part) * b**part if logarithmic else (1 - part) * a + part * b
        faster = [pair[1][0] if first > 0 else pair[0][0] for pair, first in zip((one, other), lead, strict=True)]
        yield Crossing(faster[0], faster[1], place, (a, b), measured)


def _best(seconds: Mapping[str, float], names: Sequence[str]) -> Best:
    return min(((name, seconds.get(name, np.inf)) for name in names), key=lambda pair: pair[1])


def _logarithmic(values: Sequence[float]) -> bool:
    """Return True if the values are positive and spread over a decade or more."""
    return min(values) > 0 and max(values) >= 10 * min(values)
