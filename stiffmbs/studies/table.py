"""Results of a study as text and as JSON."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import xarray

STATUS, MESSAGE = "status", "message"
MOST_TOLD = 5
"""Number of failed cases whose messages are listed."""


def numbers(data: xarray.Dataset) -> list[str]:
    """Return the variables that are one number for each case."""
    return [
        str(name) for name in data.data_vars if name not in (STATUS, MESSAGE) and data[name].dims == data[STATUS].dims
    ]


def varied(data: xarray.Dataset) -> list[str]:
    """Return the coordinates that vary over the cases."""
    return [str(name) for name in data.coords if set(data[name].dims) & set(data[STATUS].dims) and name != "case"]


def text(data: xarray.Dataset) -> str:
    """Return the ranges of all outputs with the cases of their extremes, and the failed cases."""
    done = int((data[STATUS] == "done").sum())
    lines = [f"{data.attrs.get('title', '')}: {done} of {data[STATUS].size} cases done"]
    for name in numbers(data):
        if np.isfinite(data[name].values).any():
            low, high = (_at(data, name, extreme) for extreme in (np.nanargmin, np.nanargmax))
            lines.append(f"  {name}: {low} to {high}")
    failed = np.flatnonzero(data[STATUS].values.ravel() != "done")
    for k in failed[:MOST_TOLD]:
        where = ", ".join(f"{name} = {value}" for name, value in _case(data, int(k)).items())
        lines.append(f"  not solved: {where}: {data[MESSAGE].values.ravel()[k]}")
    if len(failed) > MOST_TOLD:
        lines.append(f"  not solved: {len(failed) - MOST_TOLD} more")
    return "\n".join(lines)


def _at(data: xarray.Dataset, name: str, extreme: Any) -> str:
    k = int(extreme(data[name].values))
    where = ", ".join(f"{key} = {_short(value)}" for key, value in _case(data, k).items())
    return f"{data[name].values.ravel()[k]:.6g} ({where})"


def _short(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _case(data: xarray.Dataset, number: int) -> dict[str, Any]:
    """Return the varied values of a case."""
    dims = data[STATUS].dims
    index = dict(zip(dims, np.unravel_index(number, data[STATUS].shape), strict=True))
    places = {name: {d: k for d, k in index.items() if d in data[name].dims} for name in varied(data)}
    return {name: data[name].isel(place).values.tolist() for name, place in places.items()}


def as_dict(scene: str, data: xarray.Dataset) -> dict[str, Any]:
    """Return the content of ``--json``: every case with its varied values, numeric outputs, status and message."""
    rows = []
    outputs = {name: data[name].values.ravel() for name in numbers(data)}
    status, message = (data[name].values.ravel() for name in (STATUS, MESSAGE))
    for k in range(data[STATUS].size):
        values = {name: _json_number(float(array[k])) for name, array in outputs.items()}
        rows.append({"case": k, **_case(data, k), **values, STATUS: str(status[k]), MESSAGE: str(message[k])})
    return {"scene": scene, "status": "done" if (status == "done").all() else "incomplete", "cases": rows}


def _json_number(value: float) -> float | None:
    return value if math.isfinite(value) else None
