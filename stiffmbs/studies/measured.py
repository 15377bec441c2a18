"""Measured channels over time: from files, tables and solutions."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import InputError
from ..reading.files.quoted import quoted
from ..results.saved_state import READERS
from ..results.solution import Solution


@dataclass(frozen=True)
class Measured:
    """Measured channels over time.

    Attributes
    ----------
    time : ndarray, shape (n,)
        Increasing times, s.
    channels : dict of str to ndarray
        Values, shapes (n,); nan where a channel has no value.
    """

    time: np.ndarray
    channels: dict[str, np.ndarray]


def measured(data: Any) -> Measured:
    """Return the data of a fit.

    `data`: channels by name with ``time``; a frame whose index is the time; or a file .csv, .npz or .nc of these.
    Raises InputError if times do not increase, or a channel has another length or no values.
    """
    time, channels = _read(data)
    time = np.asarray(time, dtype=float)
    if time.ndim != 1 or len(time) < 2 or not np.all(np.diff(time) > 0):
        raise InputError("data: found times that do not increase, expected two or more that do")
    if not channels:
        raise InputError("data: found no channel except the time, expected one or more")
    arrays = {}
    for name, values in channels.items():
        array = np.asarray(values, dtype=float)
        if array.shape != time.shape or not np.isfinite(array).any():
            raise InputError(
                f"data: found {array.shape} values of '{name}', expected one for each of {len(time)} times"
            )
        arrays[str(name)] = array
    return Measured(time, arrays)


def _read(data: Any) -> tuple[Any, dict[str, Any]]:
    if isinstance(data, str | Path):
        data = _from_file(Path(data))
    if isinstance(data, Solution):
        return data.time, dict(data.channels)
    if hasattr(data, "index") and hasattr(data, "columns"):
        columns = {str(name): data[name].to_numpy() for name in data.columns}
        return columns.pop("time", data.index.to_numpy()), columns
    if isinstance(data, Mapping) and "time" in data:
        return data["time"], {str(name): values for name, values in data.items() if name != "time"}
    raise InputError("data: found no times, expected channels over 'time'")


def _from_file(path: Path) -> dict[str, Any]:
    source = quoted(str(path))
    if path.suffix not in READERS:
        raise InputError(f"{source}: found the ending '{path.suffix}', expected one of {', '.join(READERS)}")
    try:
        return READERS[path.suffix](path)
    except OSError as error:
        raise InputError(f"{source}: {error.strerror or error}, expected a file of measured channels") from None
    except ValueError:
        raise InputError(f"{source}: found no table of numbers, expected a column for each channel, and time") from None
