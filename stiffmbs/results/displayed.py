"""Channels of a run in the units in which they are shown."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import astuple, dataclass, field

from .error_bars import ErrorBar
from .solution import Solution


@dataclass(frozen=True, repr=False)
class Displayed(Solution):
    """Solution whose channels and error bars are in its display units.

    Its other numbers, such as energies of the balance, are in SI units.
    """

    shown: Mapping[str, str] = field(default_factory=dict)  # units of channels that are not in SI units

    def unit(self, channel: str) -> str:
        """Return the unit of one channel, or of ``"time"``."""
        return self.shown.get(channel) or super().unit(channel)


def displayed(solution: Solution, other: Solution | None = None) -> Solution:
    """Return a solution in its display units, or in those of another one; itself if it has none."""
    display = (other or solution).display
    if isinstance(solution, Displayed) or not display.chosen:
        return solution
    found = {name: display.of(unit) for name, unit in solution.units.items() if unit}
    factors = {name: factor for name, (_, factor) in found.items() if factor != 1.0}
    channels = {
        name: values * factors[name] if name in factors else values for name, values in solution.channels.items()
    }
    errors = {
        name: ErrorBar(*(part * factors[name] for part in astuple(bar))) if name in factors else bar
        for name, bar in solution.errors.items()
    }
    shown = {name: unit for name, (unit, _) in found.items()}
    return Displayed(**{**vars(solution), "channels": channels, "errors": errors}, shown=shown)
