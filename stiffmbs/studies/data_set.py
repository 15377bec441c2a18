"""Results of a study as a data set of xarray, as text and as JSON."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import InputError, needs
from ..reading.ascii import in_ascii
from ..reading.files.quoted import MOST_LISTED
from .case_solver import Row
from .cases import Cases
from .outputs import Output

if TYPE_CHECKING:
    import xarray

CASE, TIME = "case", "time"
STATUS, MESSAGE = "status", "message"


def data_set(
    cases: Cases, outputs: Sequence[Output], rows: Iterable[Row], time: np.ndarray, title: str
) -> xarray.Dataset:
    """Return a data set of all rows, with the varied values as coordinates.

    A grid has one dimension for each varied value; for vectors and matrices it is a number, with the values as a
    coordinate. A sample has the dimension ``case``.
    """
    with needs("xarray", "netcdf"):
        import xarray
    dimensions, coordinates = _coordinates(cases)
    count, shape = len(cases), cases.shape
    arrays = [np.full((count, len(time)) if one.is_series else count, np.nan) for one in outputs]
    status, message = (np.full(count, "", dtype=object) for _ in range(2))
    for row in rows:
        status[row.case], message[row.case] = row.status, row.message
        for array, value in zip(arrays, row.values, strict=True):
            if isinstance(value, np.ndarray):
                array[row.case, : len(value)] = value
            else:
                array[row.case] = value
    variables: dict[str, object] = {}
    for one, array in zip(outputs, arrays, strict=True):
        over_time = (TIME,) if one.is_series else ()
        variables[one.name] = (
            (*dimensions, *over_time),
            array.reshape(*shape, *array.shape[1:]),
            {"formula": one.text},
        )
    for name, words in ((STATUS, status), (MESSAGE, message)):
        variables[name] = (dimensions, words.astype(str).reshape(shape))
    if any(one.is_series for one in outputs):
        coordinates[TIME] = (TIME, time, {"units": "s"})
    return xarray.Dataset(variables, coords=coordinates, attrs={"title": title})


def _coordinates(cases: Cases) -> tuple[tuple[str, ...], dict[str, Any]]:
    """Return the names of the dimensions, and the varied values along them."""
    if cases.drawn:
        coordinates = {CASE: np.arange(len(cases))}
        for name, values in zip(cases.names, cases.drawn, strict=True):
            coordinates |= _along(name, CASE, values)
        return (CASE,), coordinates
    dimensions: list[str] = []
    found: dict[str, object] = {}
    for one in cases.variations:
        array = _array(one.name, one.values)
        dimension = one.name if array.ndim == 1 else f"{one.name}.number"
        dimensions.append(dimension)
        found |= _along(one.name, dimension, one.values)
    return tuple(dimensions), found


def _along(name: str, dimension: str, values: Sequence[object]) -> dict[str, Any]:
    array = _array(name, values)
    return {name: ((dimension, *(f"{name}.{k}" for k in range(array.ndim - 1))), array)}


def _array(name: str, values: Sequence[object]) -> np.ndarray:
    """Return values of one shape as an array, of numbers if all are numbers."""
    try:
        array = np.array(values)
    except ValueError:
        raise InputError(
            f"{name}: found values of different lengths, expected vectors or matrices of one shape"
        ) from None
    return array if array.dtype.kind in "if" else array.astype(str)


def write(path: Path, data: xarray.Dataset) -> None:
    """Write a data set to a file, completely or not at all.

    `path`: name in .nc, with names in ASCII and ``_per_`` for ``/`` (the attribute `long_name` has other letters), or in .csv, with a line for each case without series.
    """
    from ..results.files import metadata_file, write_text, written_whole

    written_whole(path, lambda part: WRITERS[path.suffix](part, data))
    if path.suffix != ".nc" and path.is_file():
        write_text(metadata_file(path), json.dumps(data.attrs, ensure_ascii=False) + "\n")


def _write_netcdf(path: Path, data: xarray.Dataset) -> None:
    names: dict[str, str] = {}
    for name in map(str, {**data.variables, **data.sizes}):
        plain = in_ascii(name).replace("/", "_per_")
        while plain in names.values():
            plain += "_"
        names[name] = plain
    renamed = data.rename({name: plain for name, plain in names.items() if plain != name})
    for name, plain in names.items():
        if not name.isascii() and plain in renamed.variables:
            renamed[plain].attrs["long_name"] = name
    renamed.to_netcdf(path, engine="scipy")


def _write_csv(path: Path, data: xarray.Dataset) -> None:
    import csv

    rows = as_dict("", data)["cases"]
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)


WRITERS: dict[str, Callable[[Path, Any], None]] = {".nc": _write_netcdf, ".csv": _write_csv}


def numbers(data: xarray.Dataset) -> list[str]:
    """Return the variables that are one number for each case."""
    return [
        str(name) for name in data.data_vars if name not in (STATUS, MESSAGE) and data[name].dims == data[STATUS].dims
    ]


def varied(data: xarray.Dataset) -> list[str]:
    """Return the coordinates that vary over the cases."""
    return [str(name) for name in data.coords if set(data[name].dims) & set(data[STATUS].dims) and name != CASE]


def text(data: xarray.Dataset) -> str:
    """Return the ranges of all outputs with the cases of their extremes, and the failed cases."""
    done = int((data[STATUS] == "done").sum())
    lines = [f"{data.attrs.get('title', '')}: {done} of {data[STATUS].size} cases done"]
    for name in numbers(data):
        if np.isfinite(data[name].values).any():
            low, high = (_at(data, name, extreme) for extreme in (np.nanargmin, np.nanargmax))
            lines.append(f"  {name}: {low} to {high}")
    failed = np.flatnonzero(data[STATUS].values.ravel() != "done")
    for k in failed[:MOST_LISTED]:
        where = ", ".join(f"{name} = {value}" for name, value in _case(data, int(k)).items())
        lines.append(f"  not solved: {where}: {data[MESSAGE].values.ravel()[k]}")
    if len(failed) > MOST_LISTED:
        lines.append(f"  not solved: {len(failed) - MOST_LISTED} more")
    return "\n".join(lines)


def _at(data: xarray.Dataset, name: str, extreme: Any) -> str:
    k = int(extreme(data[name].values))
    values = {key: f"{value:.6g}" if isinstance(value, float) else value for key, value in _case(data, k).items()}
    where = ", ".join(f"{key} = {value}" for key, value in values.items())
    return f"{data[name].values.ravel()[k]:.6g} ({where})"


def _case(data: xarray.Dataset, number: int) -> dict[str, object]:
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
        values = {name: float(array[k]) if math.isfinite(array[k]) else None for name, array in outputs.items()}
        rows.append({"case": k, **_case(data, k), **values, STATUS: str(status[k]), MESSAGE: str(message[k])})
    return {"scene": scene, "status": "done" if (status == "done").all() else "incomplete", "cases": rows}
