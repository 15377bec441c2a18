"""Where over a parameter implicit steps become faster than explicit ones, or the other way."""

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
    """Between two values of a parameter the other kind of integrator becomes the faster one.

    Attributes
    ----------
    before, then : str
        The solver that is faster below, and the one that is above.
    at : float
        Where both take the same time.
    between : (float, float)
        The values of the parameter on both sides.
    measured : bool
        Whether both have a time on both sides; else one of them fails there, and `at` is the middle.
    """

    before: str
    then: str
    at: float
    between: tuple[float, float]
    measured: bool

    def as_dict(self) -> dict[str, Any]:
        """An entry of ``crossings`` in ``stiffmbs compare --json``."""
        return {"before": self.before, "then": self.then, "at": self.at, "between": list(self.between)}


def crossings(values: Sequence[float], at: Sequence[AtError | None], entries: Sequence[Entry]) -> Iterator[Crossing]:
    """The crossings of the best implicit and the best explicit integrator.

    Parameters
    ----------
    values : sequence of float
        Of the parameter, in order.
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
        with np.errstate(divide="ignore"):  # infinite where one kind has no time
            lead = [float(np.log(pair[0][1] / pair[1][1])) for pair in (one, other)]  # of explicit steps where positive
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
    """Whether the values are positive and spread over more than a decade."""
    return min(values) > 0 and max(values) >= 10 * min(values)
