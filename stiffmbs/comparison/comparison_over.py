"""What solvers compared over a parameter have taken."""

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
    """What was measured at one value of the parameter.

    Attributes
    ----------
    value : float
    rows : tuple of Row
    at : AtError or None
        Times at the error.
    message : str
        Why there are none, or the solvers that have none, with reasons; empty where all do.
    """

    value: float
    rows: tuple[Row, ...]
    at: AtError | None
    message: str


@dataclass(frozen=True)
class ComparisonOver:
    """Solvers compared over a parameter.

    Attributes
    ----------
    name : str
        Of the model.
    parameter : str
    measure : str
        What errors are measured in: ``positions`` (m, rad), ``velocities`` or ``forces``.
    error : float
        At which times are compared.
    values : tuple of AtValue
    entries : tuple of Entry
        The ways to solve.
    interrupted : bool
        Whether the user ended it early.
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
        """Times at the error, by value."""
        return tuple(one.at for one in self.values)

    @property
    def crossings(self) -> tuple[Crossing, ...]:
        """Where implicit steps become faster than explicit ones, or the other way."""
        return tuple(crossings([one.value for one in self.values], self.at, self.entries)) if self.values else ()

    @property
    def conclusion(self) -> str:
        """Where which kind of integrator is faster, in a sentence."""
        from .words import conclusion_over

        return conclusion_over(self)

    def as_dict(self, scene: str) -> dict[str, Any]:
        """The content of ``stiffmbs compare --over ... --json``: a row for each value and solver, at the equal error.

        Parameters
        ----------
        scene : str
            The file, or what else the scene is called.
        """
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
        """Time against the parameter as a figure of matplotlib's."""
        from .figure import over_parameter

        return over_parameter(self)

    def __str__(self) -> str:
        from .table import text_over

        return text_over(self)
