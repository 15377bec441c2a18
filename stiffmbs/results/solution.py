"""Result of a run: channels over time by name, statistics, and notes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np

from ..dynamics.storage import release
from ..errors import InputError, refuse_missing
from ..methods import SolutionMethods
from ..model.scene import Figure
from ..notes import Note
from ..reading.units.display import SI_UNITS, DisplayUnits
from ..solve.trajectory import History, Outcome
from .channels import named
from .energy_balance import Balance
from .error_bars import ErrorBar, ErrorEstimate
from .scales import UNITS, kind_of

if TYPE_CHECKING:
    import pandas
    import xarray

    from .provenance import Provenance
    from .saved_state import SavedState


@dataclass(frozen=True, repr=False)
class Solution(SolutionMethods, Mapping[str, np.ndarray]):
    """Channels over time: ``solution["rail.fy"]``, and ``solution.time`` (or ``solution.t``).

    Attributes
    ----------
    name : str
    time : ndarray, shape (n,)
        Output instants, s.
    channels : dict of str to ndarray
        Every channel over time, SI units, radians.
    outcome : Outcome
    message : str
        Sentence on the end of the run; `ended` has its reason.
    notes : tuple of Note
        Sentences on the model, the run and the results: strings that have a kind, an element, a remedy and a severity.
    solver : dict
        Name, steps, residuals, jacobians, seconds.
    history : History
        The solver's own steps and their orders, if available.
    not_unique : tuple of str
        Reaction channels that rigid bodies do not determine; their values are one of many possible solutions.
    requested : mapping of str to str
        Channels that are requests, with their SI units; empty for plain numbers and unknown units.
    presolve : tuple of str
        Sentences on the parts that presolve removed from the solution.
    errors : mapping of str to ErrorBar
        Error bars of channels, if its errors were estimated or the run was verified.
    estimate : ErrorEstimate, optional
        Outcome of the estimate of the errors, if there was one.
    verification : tuple of str
        Sentences on the runs used for verification.
    discretisation : mapping of str to float
        Estimated errors of channels by the elements of beams, if the run was verified.
    balance : Balance
        Balance of energy and work.
    figure : Figure, optional
        Main plot of the scene, if it has one.
    display : DisplayUnits
        Units in which summaries, plots and pages show the channels; the channels themselves are in SI units.
    turns : mapping of str to ndarray
        Revolution counters of angles in space, rad, by element and number: ``spring/0``.
    provenance : Provenance, optional
        Scene that was solved, changes, command line, version and date; None for files of earlier versions.
    """

    name: str
    time: np.ndarray
    channels: dict[str, np.ndarray]
    outcome: Outcome
    message: str
    notes: tuple[Note, ...]
    solver: dict[str, Any]
    history: History
    balance: Balance
    not_unique: tuple[str, ...] = ()
    requested: Mapping[str, str] = field(default_factory=dict)
    presolve: tuple[str, ...] = ()
    errors: Mapping[str, ErrorBar] = field(default_factory=dict)
    estimate: ErrorEstimate | None = None
    verification: tuple[str, ...] = ()
    discretisation: Mapping[str, float] = field(default_factory=dict)
    figure: Figure | None = None
    display: DisplayUnits = SI_UNITS
    turns: Mapping[str, np.ndarray] = field(default_factory=dict)
    provenance: Provenance | None = None

    @property
    def success(self) -> bool:
        """Return True if the whole time was solved."""
        return self.outcome is Outcome.DONE

    @property
    def ended(self) -> Note:
        """Return the message as a note: of a run that ended early, its kind is the reason, and its remedy what to do."""
        return Note.of(self.message)

    @property
    def units(self) -> dict[str, str]:
        """Return the SI unit of each channel; empty for plain numbers and unknown units."""
        return {channel: self.unit(channel) for channel in self.channels}

    def unit(self, channel: str) -> str:
        """Return the unit of one channel, or of ``"time"``; see `units`."""
        if channel == "time":
            return "s"
        return self.requested[channel] if channel in self.requested else UNITS.get(kind_of(channel), "")

    @property
    def step_times(self) -> np.ndarray:
        """Return the ends of the solver's own steps, s, if available."""
        return self.history.t

    @property
    def t(self) -> np.ndarray:
        """Return `time`."""
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
        return f"<Solution '{self.name}': {len(self.channels)} channels at {len(self.time)} times, {self.message}>"

    def __array__(self, *_: object, **__: object) -> NoReturn:
        raise InputError(
            "found a solution instead of an array, expected one channel, solution['energy.total'], or solution.to_pandas()"
        )

    def to_pandas(self) -> pandas.DataFrame:
        """Return a table with a column for each channel, over time, s; its ``attrs`` hold the units (needs pandas).

        Raises
        ------
        InputError
            If pandas is not installed.
        """
        refuse_missing("pandas", "pandas")
        import pandas

        frame = pandas.DataFrame(self.channels, index=pandas.Index(self.time, name="time"))
        frame.attrs = {"name": self.name, "units": {"time": "s", **self.units}}
        return frame

    def to_xarray(self) -> xarray.Dataset:
        """Return a data set of all channels over time, s, with their units (needs xarray, the extra ``netcdf``).

        Raises
        ------
        InputError
            If xarray is not installed.
        """
        refuse_missing("xarray", "'stiffmbs[netcdf]'")
        import xarray

        from .other_programs import about

        variables = {}
        for name, values in self.channels.items():
            unit = self.unit(name)
            known = {"channel": name, "unique": int(name not in self.not_unique), **({"units": unit} if unit else {})}
            variables[name] = ("time", values, known)
        time = xarray.Variable("time", self.time, {"units": "s"})
        return xarray.Dataset(variables, coords={"time": time}, attrs=about(self))

    def save(self, path: str | Path) -> None:
        """Write every channel to a file, completely or not at all, as ``stiffmbs run -o`` does.

        Parameters
        ----------
        path : str or Path
            Name in .npz (which `load` reads), .csv, .nc, .mat, .xlsx, .parquet, .tab or .res.

        Raises
        ------
        InputError
            If the suffix is unknown, or the folder or a package is missing.
        """
        from .files import refuse_path, write

        refuse_path("save", Path(path), "results")
        write(Path(path), self)

    def state(self, at: float | None = None) -> SavedState:
        """Return the state of all bodies at one instant, for ``stiffmbs.run(model, start_from=...)``.

        Parameters
        ----------
        at : float, optional
            One of the output instants, s; the last by default.

        Raises
        ------
        InputError
            If there is no such instant.
        """
        from .saved_state import state_of

        return state_of(self, at)

    @classmethod
    def load(cls, path: str | Path) -> Solution:
        """Read an .npz file that `save` or ``stiffmbs run -o`` wrote.

        Raises
        ------
        InputError
            If the file cannot be read, or is not of this kind.
        """
        from .saved import loaded

        return loaded(Path(path))

    def energy_drift(self) -> float:
        """Return the largest change of the total energy since the start, J."""
        total = self.channels["energy.total"]
        return float(np.nanmax(np.abs(total - total[0])))


def channel_ranges(solution: Solution) -> dict[str, dict[str, float]]:
    """Return the first, last, least and greatest value of every channel, with times of the extremes; else nan."""
    ranges = {}
    for name, values in solution.channels.items():
        low, high = int(values.argmin()), int(values.argmax())
        if np.isnan(values[low]):  # argmin finds the first NaN
            low, high = (0, 0) if np.isnan(values).all() else (int(np.nanargmin(values)), int(np.nanargmax(values)))
        ranges[name] = {
            "first": float(values[0]), "last": float(values[-1]),
            "min": float(values[low]), "max": float(values[high]),
            "t_min": float(solution.time[low]), "t_max": float(solution.time[high]),
        }  # fmt: skip
        release(values)
    return ranges
