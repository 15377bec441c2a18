"""Results of a comparison of solvers over a parameter, with the values at which implicit and explicit steps cross."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .at_error import AtError, Row
from .plan import Entry

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Sheet


Best = tuple[str, float]


@dataclass(frozen=True)
class Crossing:
    """Change of the faster kind of integrator between two values of a parameter."""

    # before, then: faster solver below, and above
    before: str
    then: str
    at: float  # value at which both take the same time
    between: tuple[float, float]  # values of the parameter on both sides
    measured: bool  # True if both have a time on both sides; otherwise one of them fails there, and `at` is the middle

    def as_dict(self) -> dict[str, object]:
        """Return an entry of ``crossings`` in ``stiffmbs compare --json``."""
        return {"before": self.before, "then": self.then, "at": self.at, "between": list(self.between)}


@dataclass(frozen=True)
class AtValue:
    """Measurements at one value of the parameter.

    `at`: times at the error. `message`: reason why there are none, or the solvers that have none, with reasons; empty
    if all have one.
    """

    value: float
    rows: tuple[Row, ...]
    at: AtError | None
    message: str


@dataclass(frozen=True, repr=False)
class ComparisonOver:
    """Comparison of solvers over a parameter.

    Attributes
    ----------
    measure : str
        Measure of errors: ``positions`` (m, rad), ``velocities`` or ``forces``.
    error : float
        Error at which times are compared.
    entries : tuple of Entry
        Compared solvers, with schemes and formulations.
    interrupted : bool
        True if the user ended it early.
    """

    name: str
    parameter: str
    measure: str
    error: float
    values: tuple[AtValue, ...]
    entries: tuple[Entry, ...]
    interrupted: bool

    @property
    def at(self) -> tuple[AtError | None, ...]:
        """Return the times at the error, by value."""
        return tuple(one.at for one in self.values)

    @property
    def crossings(self) -> tuple[Crossing, ...]:
        """Return the values at which implicit steps become faster than explicit ones, or the reverse."""
        return tuple(crossings([one.value for one in self.values], self.at, self.entries)) if self.values else ()

    @property
    def conclusion(self) -> str:
        """Return a sentence on the ranges in which each kind of integrator is faster."""
        from .words import conclusion_over

        return conclusion_over(self)

    def as_dict(self, scene: str) -> dict[str, object]:
        """Return the content of ``stiffmbs compare --over ... --json``, with a row for each value and solver."""
        return {
            "scene": scene, "measure": self.measure, "rows": [row for one in self.values for row in self._rows(one)],
            "over": {"parameter": self.parameter, "values": [one.value for one in self.values], "error": self.error},
            "crossings": [crossing.as_dict() for crossing in self.crossings],
            "measured": [
                {self.parameter: one.value, **row.as_dict(self.measure)} for one in self.values for row in one.rows
            ],
            "conclusion": self.conclusion, "interrupted": self.interrupted,
        }  # fmt: skip

    def _rows(self, one: AtValue) -> list[dict[str, object]]:
        setting, found = f"{self.parameter}={one.value:.4g}", []
        for entry in self.entries:
            row: dict[str, object] = {
                "solver": entry.name,
                "setting": setting,
                "error": None,
                "seconds": None,
                "steps": 0,
            }
            if one.at and entry.name in one.at.seconds:
                seconds, steps = one.at.seconds[entry.name], round(one.at.steps[entry.name])
                row |= {"error": self.error, "seconds": seconds, "steps": steps}
            else:
                row["message"] = one.message or "the error was not reached"
            found.append(row)
        return found

    def plot(self) -> Sheet:
        """Plot time against the parameter as a figure of matplotlib."""
        from .figure import over_parameter

        return over_parameter(self)

    def __repr__(self) -> str:
        from .table import text

        return text(self)


def crossings(values: Sequence[float], at: Sequence[AtError | None], entries: Sequence[Entry]) -> Iterator[Crossing]:
    """Yield the crossings of the best implicit and the best explicit integrator.

    `values`: values of the parameter, in order. `at`: times at the error, by value.
    """
    kinds = [[entry.name for entry in entries if entry.implicit], [entry.name for entry in entries if entry.explicit]]
    if not all(kinds):
        return
    best = [[_best(found.seconds if found else {}, names) for names in kinds] for found in at]
    known = [(value, pair) for value, pair in zip(values, best, strict=True) if any(np.isfinite(b[1]) for b in pair)]
    spread = logarithmic(values)
    for (a, one), (b, other) in itertools.pairwise(known):
        with np.errstate(divide="ignore"):  # infinite if one kind has no time
            lead = [float(np.log(pair[0][1] / pair[1][1])) for pair in (one, other)]  # positive: explicit is faster
        if lead[0] * lead[1] >= 0:
            continue
        measured = bool(np.all(np.isfinite(lead)))
        part = lead[0] / (lead[0] - lead[1]) if measured else 0.5
        place = a ** (1 - part) * b**part if spread else (1 - part) * a + part * b
        faster = [pair[1][0] if first > 0 else pair[0][0] for pair, first in zip((one, other), lead, strict=True)]
        yield Crossing(faster[0], faster[1], place, (a, b), measured)


def _best(seconds: Mapping[str, float], names: Sequence[str]) -> Best:
    return min(((name, seconds.get(name, np.inf)) for name in names), key=lambda pair: pair[1])


def logarithmic(values: Sequence[float]) -> bool:
    """Return True if the values are positive and spread over a decade or more."""
    return min(values) > 0 and max(values) >= 10 * min(values)
