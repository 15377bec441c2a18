"""Results of a comparison of solvers over a parameter."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from .at_error import AtError
from .crossing import Crossing, crossings
from .entries import Entry
from .row import Row

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Sheet


@dataclass(frozen=True)
class AtValue:
    """Measurements at one value of the parameter.

    Attributes
    ----------
    value : float
    rows : tuple of Row
    at : AtError or None
        Times at the error.
    message : str
        Reason why there are none, or the solvers that have none, with reasons; empty if all have one.
    """

    value: float
    rows: tuple[Row, ...]
    at: AtError | None
    message: str


@dataclass(frozen=True)
class ComparisonOver:
    """Comparison of solvers over a parameter.

    Attributes
    ----------
    name : str
    parameter : str
    measure : str
        Measure of errors: ``positions`` (m, rad), ``velocities`` or ``forces``.
    error : float
        Error at which times are compared.
    values : tuple of AtValue
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

    def as_dict(self, scene: str) -> dict[str, Any]:
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

    def _rows(self, one: AtValue) -> list[dict[str, Any]]:
        setting = f"{self.parameter}={one.value:.4g}"
        found = []
        for entry in self.entries:
            row: dict[str, Any] = {"solver": entry.name, "setting": setting}
            if one.at and entry.name in one.at.seconds:
                row |= {
                    "error": self.error,
                    "seconds": one.at.seconds[entry.name],
                    "steps": round(one.at.steps[entry.name]),
                }
            else:
                row |= {
                    "error": None,
                    "seconds": None,
                    "steps": 0,
                    "message": one.message or "the error was not reached",
                }
            found.append(row)
        return found

    def plot(self) -> Sheet:
        """Plot time against the parameter as a figure of matplotlib."""
        from .figure import over_parameter

        return over_parameter(self)

    def __str__(self) -> str:
        from .table import text_over

        return text_over(self)
