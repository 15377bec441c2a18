"""The result of a run: channels over time by name, statistics, and what there is to say about it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np

from ..describe.figure import Figure
from ..errors import InputError
from ..solve.storage import release
from ..solve.trajectory import History, Outcome
from .channels import named
from .energy_balance import Balance
from .error_bars import ErrorBar
from .scales import UNITS, kind_of

if TYPE_CHECKING:
    import pandas
    import xarray
    from matplotlib.figure import Figure as Sheet

    from .saved_state import SavedState


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
    requested : mapping of str to str
        Channels that are requests, not of bodies or elements, with their SI units; empty for plain numbers, and where nothing
        tells the unit.
    presolve : tuple of str
        What was left out of the solution because it follows from the rest, a sentence each.
    errors : mapping of str to ErrorBar
        How far channels may lie from the truth, where the run was verified.
    verification : tuple of str
        What the run was compared with, a sentence each.
    balance : Balance
        Of energy and work.
    figure : Figure, optional
        The plot that shows what the scene is about, where it has one.
    turns : mapping of str to ndarray
        What is counted of angles over whole turns in space, rad, by element and number: ``spring/0``.
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
    requested: Mapping[str, str] = field(default_factory=dict)
    presolve: tuple[str, ...] = ()
    errors: Mapping[str, ErrorBar] = field(default_factory=dict)
    verification: tuple[str, ...] = ()
    figure: Figure | None = None
    turns: Mapping[str, np.ndarray] = field(default_factory=dict)

    @property
    def success(self) -> bool:
        """Whether the whole time was solved."""
        return self.outcome is Outcome.DONE

    @property
    def units(self) -> dict[str, str]:
        """The SI unit of each channel; empty for plain numbers, and where nothing tells it."""
        return {channel: self.unit(channel) for channel in self.channels}

    def unit(self, channel: str) -> str:
        """The unit of one channel, or of ``"time"``; see `units`."""
        if channel == "time":
            return "s"
        return self.requested[channel] if channel in self.requested else UNITS.get(kind_of(channel), "")

    @property
    def step_times(self) -> np.ndarray:
        """Ends of the solver's own steps, s, where it tells them."""
        return self.history.t

    @property
    def t(self) -> np.ndarray:
        """The same as `time`."""
        return self.time

    def __getitem__(self, channel: str) -> np.ndarray:
        return named(self.channels, channel)

    def __iter__(self) -> Iterator[str]:
        return iter(self.channels)

    def __len__(self) -> int:
        return len(self.channels)

    def __contains__(self, channel: object) -> bool:
        return channel in self.channels

    def __repr__(self) -> str:
        return f"<Solution '{self.name}': {len(self.channels)} channels at {len(self.time)} instants, {self.message}>"

    def _repr_html_(self) -> str:
        """What a notebook shows."""
        from ..show.html import solution_html

        return solution_html(self)

    def __array__(self, *_: Any, **__: Any) -> NoReturn:
        raise InputError(
            "found a whole solution in place of an array, expected one channel, solution['energy.total'], or solution.to_pandas()"
        )

    def to_pandas(self) -> pandas.DataFrame:
        """A table with a column for each channel, over time, s; its ``attrs`` hold the units (needs pandas).

        Raises
        ------
        InputError
            When pandas is not installed.
        """
        from .frames import data_frame

        return data_frame(self)

    def to_xarray(self) -> xarray.Dataset:
        """A variable for each channel, over time, s, with its unit (needs xarray, the extra ``netcdf``).

        Raises
        ------
        InputError
            When xarray is not installed.
        """
        from .frames import data_set

        return data_set(self)

    def save(self, path: str | Path) -> None:
        """Write every channel to a file, as ``stiffmbs run -o`` does; it appears whole or not at all.

        Parameters
        ----------
        path : str or Path
            Ends in .npz (which `load` reads), .csv, .nc or .tab.

        Raises
        ------
        InputError
            For another ending, a missing folder, or a missing package.
        """
        from .files import check_output, write

        check_output(Path(path), "save")
        write(Path(path), self)

    def state(self, at: float | None = None) -> SavedState:
        """The state of all bodies at one instant, for ``stiffmbs.run(model, start_from=...)``.

        Parameters
        ----------
        at : float, optional
            One of the output instants, s; the last by default.

        Raises
        ------
        InputError
            When there is no such instant.
        """
        from .saved_state import state_of

        return state_of(self, at)

    @classmethod
    def load(cls, path: str | Path) -> Solution:
        """What `save` or ``stiffmbs run -o`` wrote to an .npz file.

        Raises
        ------
        InputError
            When the file cannot be read, or is none of these.
        """
        from .saved import loaded

        return loaded(Path(path))

    def summary(self, all: bool = False) -> str:
        """Return what ``stiffmbs run`` prints: loads of elements, energy balance, statistics of the solver, notes.

        Parameters
        ----------
        all : bool
            Whether to list the loads of all elements; by default the ten largest are listed.
        """
        from ..show.summary import summary

        return summary(self, all)

    def plot(self, *channels: str, x: str = "time", z: str = "", title: str = "", equal: bool = False) -> Sheet:
        """Draw channels over time, or over another channel (needs matplotlib, the extra ``plot``).

        Parameters
        ----------
        *channels : str
            What to draw; without any the scene's own figure, or the total energy.
        x : str
            A channel, or ``"time"``.
        z : str
            A channel: the figure is then a path in space, of one channel over `x`.
        title : str
            Of the figure; the scene's name by default.
        equal : bool
            Whether all axes have one scale, as for paths.

        Returns
        -------
        matplotlib.figure.Figure
            One of pyplot's, so that ``pyplot.show()`` shows it.

        Raises
        ------
        InputError
            When there is no such channel, or no matplotlib.
        """
        from ..show.figure import plotted

        return plotted(self, Figure(y=channels, x=x, z=z, title=title, equal=equal) if channels else self.figure)

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
