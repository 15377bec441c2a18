"""The result of a run: channels over time by name, statistics, and what there is to say about it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..describe.names import owner_of
from ..errors import InputError
from ..solve.storage import release
from ..solve.trajectory import History, Outcome
from .energy_balance import Balance
from .error_bars import ErrorBar


@dataclass(frozen=True, repr=False)
class Solution(Mapping[str, np.ndarray]):
    """Channels over time: ``solution["rail.fy"]``, and ``solution.time`` (or ``solution.t``).

    Attributes
    ----------
    name : str
        Of the scene.
    time : ndarray, shape (n,)
        Output instants, s.
    channels : dict of str to ndarray
        Every channel over time, SI units, radians.
    outcome : Outcome
    message : str
        One sentence on how the run ended.
    notes : tuple of str
        What the user should know besides: moves at the assembly, warnings.
    solver : dict
        Name, steps, residuals, jacobians, seconds.
    history : History
        The solver's own steps and their orders, where it tells them.
    not_unique : tuple of str
        Channels of reactions that rigid bodies do not determine; what they hold is one of many possible values.
    requested : frozenset of str
        Channels that are requests, not of bodies or elements.
    presolve : tuple of str
        What was left out of the solution because it follows from the rest, a sentence each.
    errors : mapping of str to ErrorBar
        How far channels may lie from the truth, where the run was verified.
    verification : tuple of str
        What the run was compared with, a sentence each.
    balance : Balance
        Of energy and work.
    """

    name: str
    time: np.ndarray
    channels: dict[str, np.ndarray]
    outcome: Outcome
    message: str
    notes: tuple[str, ...]
    solver: dict[str, Any]
    history: History
    balance: Balance
    not_unique: tuple[str, ...] = ()
    requested: frozenset[str] = frozenset()
    presolve: tuple[str, ...] = ()
    errors: Mapping[str, ErrorBar] = field(default_factory=dict)
    verification: tuple[str, ...] = ()

    @property
    def step_times(self) -> np.ndarray:
        """Ends of the solver's own steps, s, where it tells them."""
        return self.history.t

    @property
    def t(self) -> np.ndarray:
        """The same as `time`."""
        return self.time

    def __getitem__(self, channel: str) -> np.ndarray:
        try:
            return self.channels[channel]
        except KeyError:
            owner = owner_of(channel)
            near = [name for name in self.channels if owner_of(name) == owner] or list(self.channels)[:12]
            raise InputError(f"found no channel '{channel}', expected one such as {', '.join(near)}") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self.channels)

    def __len__(self) -> int:
        return len(self.channels)

    def __contains__(self, channel: object) -> bool:
        return channel in self.channels

    def __repr__(self) -> str:
        return f"<Solution '{self.name}': {len(self.channels)} channels at {len(self.time)} instants, {self.message}>"

    def energy_drift(self) -> float:
        """Largest change of the total energy since the start, J."""
        total = self.channels["energy.total"]
        return float(np.nanmax(np.abs(total - total[0])))


def channel_ranges(solution: Solution) -> dict[str, dict[str, float]]:
    """First, last, least and largest value of every channel, and when the latter two occur; nan where it has no value."""
    ranges = {}
    for name, values in solution.channels.items():
        low, high = (0, 0) if np.isnan(values).all() else (int(np.nanargmin(values)), int(np.nanargmax(values)))
        ranges[name] = {
            "first": float(values[0]), "last": float(values[-1]),
            "min": float(values[low]), "max": float(values[high]),
            "t_min": float(solution.time[low]), "t_max": float(solution.time[high]),
        }  # fmt: skip
        release(values)
    return ranges
