"""State of all bodies at one instant of saved results, from which a run can start."""

from __future__ import annotations

import io
import struct
import tokenize
import warnings
import zlib
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any
from zipfile import BadZipFile

import numpy as np

from ..errors import InputError
from ..reading.files.files_read import check_regular, content_of
from ..reading.files.quoted import quoted
from ..reading.joint_name import FREE_COORDINATES
from .scales import ROUNDING

if TYPE_CHECKING:
    from .solution import Solution


RAISED = (
    BadZipFile, zlib.error, struct.error, tokenize.TokenError, ArithmeticError, AssertionError, AttributeError,
    EOFError, LookupError, NotImplementedError, RuntimeError, SyntaxError, TypeError,
)  # fmt: skip
"""Exceptions that readers of archives, arrays, tables and XML raise for damaged content."""


@contextmanager
def readable(path: Path) -> Iterator[None]:
    """Read a regular file with arbitrary content.

    Raises OSError if it is not a regular file, or cannot be read. Raises ValueError if its content cannot be read.
    """
    check_regular(path)
    try:
        yield
    except ValueError:
        raise
    except RAISED as error:
        raise ValueError(f"damaged content ({type(error).__name__})") from error


@contextmanager
def reading(path: Path, source: str, content: str, expected: str) -> Iterator[None]:
    """Raise an InputError on `source` if a file cannot be read, or has another content than expected."""
    try:
        with readable(path):
            yield
    except OSError as error:
        raise InputError(f"{source}: {error.strerror or f'found no {content}'}, expected {expected}") from None
    except ValueError:
        raise InputError(f"{source}: found no {content}, expected {expected}") from None


TURNS = "run/turns/"
"""Prefix of the names of revolution counters in .npz files."""
SET_UP = "set_up"
"""Beginning of the numbers, in such names, of full turns by which elements were reduced when they were set up."""


@dataclass(frozen=True, eq=False)
class SavedState:
    """Poses and velocities of all bodies at one instant.

    Attributes
    ----------
    source : str
        File, or name of a solution, for messages.
    t : float
        Time, s.
    channels : mapping of str to float
        Every channel at that instant.
    turns : mapping of str to float
        Revolution counters of angles in space, rad, by element and number: ``spring/0``. Also the full turns by which
        rotations were reduced in elements that were added during the motion: ``bushing/set_up0``.
    elements : frozenset of str, optional
        Joints and forces of the saved run, if known: the counters of other elements start again.
    exact : ndarray, optional
        Coordinates and velocities of a simulation, which continues from them to the last bit.
    """

    source: str
    t: float
    channels: Mapping[str, float]
    turns: Mapping[str, float] = field(default_factory=dict)
    elements: frozenset[str] | None = None
    exact: np.ndarray | None = field(default=None, compare=False)

    def turn(self, element: str, k: int = 0, measure: str = "") -> float | None:
        """Return the angle at an element's counter of revolutions, or that of a request, rad; None if not known.

        `measure`: angle between markers that it counts, which is that of another element if this one has not counted it.
        """
        if measure:
            others = (name for name in self.turns if name.endswith(f"/{measure}"))
            names = (f"{element}/{measure}", f"{measure}/0", *others)  # its own, that of a request, any
            found = (self.turns[name] for name in names if name in self.turns)
            if (angle := next((angle for angle in found if np.isfinite(angle)), None)) is not None:
                return angle
            if any(name.startswith(f"{element}/") and name.endswith(")") for name in self.turns):
                return None  # its formula had other angles
        is_joint_angle = element.rpartition(".")[2] in FREE_COORDINATES
        known = self.turns.get(f"{element}/{k}", self.channels.get(element) if is_joint_angle else None)
        return None if known is None or np.isnan(known) else known


def read_state(path: str | Path, at: float | None = None) -> SavedState:
    """Read one row of a file that ``stiffmbs run -o`` or ``stiffmbs equilibrium -o`` wrote.

    Parameters
    ----------
    path : str or Path
        Name in .npz, .csv or .nc.
    at : float, optional
        Time of the row, s; the last row by default.

    Raises
    ------
    InputError
        If the file cannot be read, holds no channels over time, or has no row at that time.
    """
    file = Path(path)
    source = quoted(str(file))
    if file.suffix not in READERS:
        raise InputError(f"{source}: found the ending '{file.suffix}', expected one of {', '.join(READERS)}")
    with reading(file, source, "table of channels", "a file that stiffmbs run -o wrote"):
        found = READERS[file.suffix](file)
        if "time" not in found or not found["time"].size:
            raise InputError(f"{source}: found no channels over time, expected a file that stiffmbs run -o wrote")
        return _row(source, found["time"], found, at)


def state_of(solution: Solution, at: float | None) -> SavedState:
    """Return a state; see `Solution.state`."""
    turns = {TURNS + name: values for name, values in solution.turns.items()}
    name = f"the results of '{solution.name}'" if solution.name else "the results"
    return _row(name, solution.time, {**solution.channels, **turns}, at)


def _row(source: str, time: np.ndarray, arrays: Mapping[str, np.ndarray], at: float | None) -> SavedState:
    k = len(time) - 1 if at is None else _number_of_row(source, time, at)
    over_time = {
        name: float(values[k])
        for name, values in arrays.items()
        if ("/" not in name or name.startswith(TURNS)) and values.shape == time.shape and values.dtype.kind == "f"
    }
    turns = {name.removeprefix(TURNS): value for name, value in over_time.items() if name.startswith(TURNS)}
    channels = {name: value for name, value in over_time.items() if not name.startswith(TURNS)}
    return SavedState(source, float(time[k]), channels, turns)


def _number_of_row(source: str, time: np.ndarray, at: float) -> int:
    k = int(np.argmin(np.abs(time - at)))
    apart = np.diff(time)
    if not abs(time[k] - at) <= ROUNDING * max(float(np.max(apart, initial=0.0)), abs(at)):
        near = time[max(0, k - 1) : k + 2]
        raise InputError(
            f"{source}: found no row at t = {at:.9g} s, expected an instant that was saved: there are {len(time)} from "
            f"{time[0]:.9g} to {time[-1]:.9g} s, the nearest {', '.join(f'{t:.9g}' for t in near)}"
        )
    return k


def _npz(path: Path) -> dict[str, object]:
    with np.load(path, allow_pickle=False) as archive:
        return {name: archive[name] for name in archive.files if "/" not in name or name.startswith(TURNS)}


def _csv(path: Path) -> dict[str, object]:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # NumPy warns of a table without rows
        file = io.StringIO(content_of(path).decode())
        heads = [head.partition(" (")[0] for head in file.readline().rstrip("\r\n").split(",")]
        table = np.loadtxt(file, delimiter=",", ndmin=2)
    return dict(zip(heads, table.T, strict=True))


def _netcdf(path: Path) -> dict[str, object]:
    from scipy.io import netcdf_file

    with netcdf_file(path, mmap=False) as file:
        names = (
            getattr(variable, "channel", name.encode()).decode("utf-8") for name, variable in file.variables.items()
        )
        arrays = (np.array(variable[...], dtype=float) for variable in file.variables.values())
        return dict(zip(names, arrays, strict=True))


READERS: dict[str, Callable[[Path], dict[str, Any]]] = {".npz": _npz, ".csv": _csv, ".nc": _netcdf}
