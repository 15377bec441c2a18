"""Measured channels over time: from files, tables and solutions; uncertainty of parameters fitted to them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import InputError
from ..reading.files.quoted import quoted
from ..results.saved_state import READERS, reading
from ..results.solution import Solution


@dataclass(frozen=True)
class Measured:
    """Measured channels over time."""

    time: np.ndarray  # shape (n,): increasing times, s
    channels: dict[str, np.ndarray]  # values, shapes (n,); nan where a channel has no value


def measured(data: object) -> Measured:
    """Return the data of a fit.

    `data`: channels by name with ``time``; a frame whose index is the time; or a file .csv, .npz or .nc of these.
    Raises InputError if times do not increase, or a channel has another length or no values.
    """
    source = quoted(str(data)) if isinstance(data, str | Path) else "data"
    time, channels = _read(data, source)
    time = np.asarray(time, dtype=float)
    if time.ndim != 1 or len(time) < 2 or not np.all(np.diff(time) > 0):
        raise InputError(f"{source}: found times that do not increase, expected two or more that do")
    if not channels:
        raise InputError(f"{source}: found no channel except the time, expected one or more")
    arrays = {}
    for name, values in channels.items():
        array = np.asarray(values, dtype=float)
        if array.shape != time.shape:
            raise InputError(
                f"{source}: found {array.shape} values of '{name}', expected one for each of {len(time)} times"
            )
        if np.isinf(array).any():
            raise InputError(f"{source}: found an infinite value of '{name}', expected finite ones, or nan for a gap")
        if np.isnan(array).all():
            raise InputError(f"{source}: found no value of '{name}' that is a number, expected one or more")
        arrays[str(name)] = array
    return Measured(time, arrays)


def _read(data: Any, source: str) -> tuple[Any, dict[str, object]]:
    if isinstance(data, str | Path):
        data = _from_file(Path(data), source)
    if isinstance(data, Solution):
        return data.time, dict(data.channels)
    if hasattr(data, "index") and hasattr(data, "columns"):
        columns = {str(name): data[name].to_numpy() for name in data.columns}
        return columns.pop("time", data.index.to_numpy()), columns
    if isinstance(data, Mapping) and "time" in data:
        return data["time"], {str(name): values for name, values in data.items() if name != "time"}
    raise InputError(f"{source}: found no times, expected channels over 'time'")


def _from_file(path: Path, source: str) -> dict[str, object]:
    if path.suffix not in READERS:
        raise InputError(f"{source}: found the ending '{path.suffix}', expected one of {', '.join(READERS)}")
    with reading(path, source, "table of numbers", "a column for each channel, and time"):
        return READERS[path.suffix](path)


ROUNDS = 4
"""Number of estimates of the channels' noise, each with the leverages of the previous one."""


@dataclass(frozen=True)
class Uncertainty:
    """Uncertainty of p parameters.

    `covariance` of shape (p, p). `freedom` of shape (p,): degrees of freedom of each parameter's variance, for
    Student's distribution.
    """

    covariance: np.ndarray
    freedom: np.ndarray


def of_common_noise(J: np.ndarray, r: np.ndarray) -> Uncertainty:
    """Return the uncertainty for residuals r with derivatives J and noise that is known up to a common factor.

    Seber and Wild, Nonlinear Regression (1989), sec. 5.1.
    """
    count, p = J.shape
    return Uncertainty(np.linalg.inv(J.T @ J) * float(r @ r) / (count - p), np.full(p, float(count - p)))


def of_separate_noise(J: Sequence[np.ndarray], r: Sequence[np.ndarray]) -> Uncertainty:
    """Return the uncertainty for channels with separate noise, estimated from their residuals.

    A channel loses as many degrees of freedom to the parameters as the sum of its leverages.  The variance of a
    parameter is a sum over channels, whose degrees of freedom are those of Satterthwaite, Biometrics Bulletin 2 (1946)
    110-114.  If a channel has none left, common noise is assumed. `J`: derivatives of each channel's residuals,
    weighted so that all have about the same noise.
    """
    information = np.array([part.T @ part for part in J])
    squares, counts = np.array([part @ part for part in r]), np.array([float(len(part)) for part in r])
    variance = np.full(len(r), squares.sum() / counts.sum())
    for _ in range(ROUNDS):
        parts = information / variance[:, None, None]
        covariance = np.linalg.inv(parts.sum(axis=0))
        freedom = counts - np.einsum("ij,kji->k", covariance, parts)
        if np.any(freedom < 1) or not np.all(squares > 0):
            return of_common_noise(np.concatenate(J), np.concatenate(r))
        variance = squares / freedom
    parts = information / variance[:, None, None]
    covariance = np.linalg.inv(parts.sum(axis=0))
    shares = np.einsum("ij,kjl,li->ki", covariance, parts, covariance) / np.diag(covariance)
    return Uncertainty(covariance, 1.0 / (shares**2 / freedom[:, None]).sum(axis=0))
