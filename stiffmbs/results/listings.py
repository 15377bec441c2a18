"""Comparison with columns over time of files: of this package, tables as text, Adams' .res and FreeCAD's .asmt files."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from itertools import groupby
from pathlib import Path
from typing import TypeAlias
from xml.etree import ElementTree

import numpy as np

from ..errors import InputError
from ..reading.did_you_mean import did_you_mean
from ..reading.files.files_read import content_of
from ..reading.files.quoted import quoted
from ..reading.files.xml_nodes import FileFault
from ..reading.names import owner_of
from .saved_state import READERS, readable
from .scales import ROUNDING
from .solution import Solution

Columns = dict[str, np.ndarray]
"""Columns by name; time is ``time``."""
TIME = "time"
_SPLIT = re.compile(r"\s*[,;\t]\s*|\s+")
_WORDS = re.compile(r'"[^"]*"|[^\s,;"]+')


def read_columns(path: str | Path) -> Columns:
    """Read the columns of a file over time; raise an InputError if it has none.

    The file holds results of this package (.npz, .csv, .nc), of Adams (.res, .xml) or of FreeCAD's solver (.asmt), or a
    table as text: .tab, .txt, .csv, .req and others, with time in its first column.  A column of a table has its number as a name, ``1`` for time, and
    its name in the header if that has as many names as columns.  A column of Adams' XML is called ``entity.component``.
    """
    file = Path(path)
    reader = _reader(file)
    try:
        with readable(file):
            found = reader(file)
    except OSError as error:
        raise InputError(f"{quoted(str(path))}: {error.strerror or 'found no file'}") from None
    except ValueError as error:
        raise InputError(f"{quoted(str(path))}: found no table of numbers over time ({error})") from None
    time = found.get(TIME)
    if time is None or len(time) < 2 or np.any(np.diff(time) < 0):
        raise InputError(f"{quoted(str(path))}: found no times that increase, expected two rows or more over time")
    return {name: values for name, values in found.items() if values.shape == time.shape}


def _reader(file: Path) -> Callable[[Path], Columns]:
    if file.suffix in (".res", ".xml"):
        return _adams_xml
    if file.suffix == ".asmt":
        return _asmt
    if file.suffix in (".npz", ".nc"):
        return lambda path: {
            name: np.asarray(values, dtype=float)
            for name, values in READERS[path.suffix](path).items()
            if values.dtype.kind == "f" and values.ndim == 1
        }
    return _table


def _table(path: Path) -> Columns:
    """Return the longest block of lines with equally many numbers, two or more, with the names in a line before it."""
    lines = content_of(path).decode(errors="replace").splitlines()
    rows = [_numbers(line) for line in lines]
    blocks = [[*block] for width, block in groupby(range(len(rows)), lambda k: len(rows[k])) if width > 1]
    longest = max(blocks, key=len, default=[])
    if len(longest) < 2:
        raise ValueError("no lines of numbers")
    table = np.array([rows[k] for k in longest]).T
    found = {str(k): column for k, column in enumerate(table, start=1)}
    for line in reversed(lines[: longest[0]]):
        names = [word.strip('"').partition(" (")[0] for word in _heads(line)]
        if len(names) == len(table):
            found |= {name: column for name, column in zip(names, table, strict=True) if name}
            break
    return found | {TIME: table[0]}


def _heads(line: str) -> list[str]:
    """Return the names of columns, separated by tabs or commas if there are any, else by blanks."""
    sign = next((sign for sign in "\t," if sign in line), "")
    return [part.strip() for part in line.strip("\r\n").split(sign)] if sign else _WORDS.findall(line)


def _numbers(line: str) -> list[float]:
    """Return the numbers of a line, or none if it has other content."""
    try:
        return [float(part.replace("D", "E").replace("d", "e")) for part in _SPLIT.split(line.strip()) if part]
    except ValueError:
        return []


def _adams_xml(path: Path) -> Columns:
    """Read Adams' .res in XML: a map that names the numbers of a step, and the steps."""
    names: dict[int, str] = {}
    rows: list[list[float]] = []
    with path.open("rb") as file:
        for _, element in ElementTree.iterparse(file):
            match element.tag.rpartition("}")[2]:
                case "Entity":
                    entity = element.get("name") or ""
                    for component in element:
                        names[int(component.get("id") or 0)] = ".".join(filter(None, (entity, component.get("name"))))
                case "Step" if element.get("type") != "initialConditions":
                    rows.append([float(text) for text in (element.text or "").split()])
    if not rows:
        raise ValueError("no steps")
    table = np.array(rows).T
    found = {names.get(k, str(k)): column for k, column in enumerate(table, start=1)}
    of_time = next((name for name in found if name.lower() in (TIME, f"{TIME}.{TIME}")), None)
    return found | {TIME: found[of_time] if of_time else table[0]}


def _asmt(path: Path) -> Columns:
    from ..cad.ondsel.series import stored_results

    try:
        return stored_results(content_of(path).decode(errors="replace"))
    except FileFault as fault:
        raise ValueError(str(fault)) from None


Listed: TypeAlias = Solution | str | Path | Mapping[str, np.ndarray]
NOT_COMPARED = (TIME, "constraint.")
"""Prefixes of channels that are equal in all runs, or noise."""


@dataclass(frozen=True)
class Difference:
    """Difference between one channel and one column.

    Attributes
    ----------
    largest : float
        Largest magnitude of the difference, in the column's units.
    t : float
        Time of the largest difference, s.
    relative : float
        Largest difference over the largest magnitude of the column, or of the channel if the column is zero.  The
        divisor is at least a billionth of the other compared components of the same element.
    """

    channel: str
    column: str
    largest: float
    t: float
    relative: float

    def as_dict(self) -> dict[str, str | float]:
        """Return an entry of ``differences`` of ``stiffmbs diff --json``."""
        return asdict(self)


def differences(found: Listed, other: Listed, columns: Mapping[str, str] | None = None) -> tuple[Difference, ...]:
    """Compare channels with columns of a listing, at its times.

    Parameters
    ----------
    found, other : Solution, str, Path or mapping
        A run or its file, and the listing; see `read_columns`.  Between its own
        instants a run is interpolated by cubic splines.
    columns : mapping of str to str, optional
        Column for each channel, with a factor for other units: ``{"PART_2.x": "5*0.001"}``.  By default channels are
        compared with the columns of the same names.

    Returns
    -------
    tuple of Difference

    Raises
    ------
    InputError
        If a channel or column is missing, or the two have no times in common.
    """
    own, listed = _columns(found), _columns(other)
    pairs = columns or {
        name: name for name in own if name in listed and not name.startswith(NOT_COMPARED) and not name.isdecimal()
    }
    if not pairs:
        raise InputError(
            f"found no channel that is called like a column, expected --map CHANNEL=COLUMN; the columns are {_some(listed)}"
        )
    t, begin, end = listed[TIME], own[TIME][0], own[TIME][-1]
    slack = ROUNDING * max(abs(begin), abs(end), end - begin)
    common = (t >= begin - slack) & (t <= end + slack)
    if not common.any():
        raise InputError(
            f"found times from {t[0]:g} to {t[-1]:g} s next to {begin:g} to {end:g} s, expected some in common"
        )
    values = {
        channel: (_at(own, channel, t[common]), _column(listed, column)[common]) for channel, column in pairs.items()
    }
    sizes: dict[str, float] = {}
    for channel, both in values.items():
        sizes[owner_of(channel)] = max(sizes.get(owner_of(channel), 0.0), *(_size(one) for one in both))
    return tuple(
        _difference(channel, column, *values[channel], t[common], ROUNDING * sizes[owner_of(channel)])
        for channel, column in pairs.items()
    )


def _columns(found: Listed) -> Columns:
    match found:
        case Solution():
            return {**found.channels, TIME: found.time}
        case str() | Path():
            return read_columns(found)
    return {name: np.asarray(values, dtype=float) for name, values in found.items()}


def _at(own: Columns, channel: str, t: np.ndarray) -> np.ndarray:
    """Return a channel at other instants; of two values at one instant, the later one."""
    if channel not in own:
        raise InputError(f"found no channel '{channel}'{did_you_mean(channel, own)}, expected one such as {_some(own)}")
    later = np.append(np.diff(own[TIME]) > 0, True)
    times, values = own[TIME][later], own[channel][later]
    nearest = np.clip(np.searchsorted(times, t), 1, max(len(times) - 1, 1))
    nearest = np.where(np.abs(times[nearest - 1] - t) <= np.abs(times[nearest % len(times)] - t), nearest - 1, nearest)
    if np.allclose(times[nearest], t, rtol=0, atol=ROUNDING * max(abs(times[-1]), times[-1] - times[0])):
        return np.asarray(values[nearest])
    from scipy.interpolate import CubicSpline

    return np.asarray(CubicSpline(times, values)(t))


def _column(listed: Columns, text: str) -> np.ndarray:
    """Return a column, times a factor if one is given."""
    name, _, factor = text.rpartition("*") if text not in listed else (text, "", "")
    name, factor = (name, factor) if name else (text, "")
    if name not in listed:
        raise InputError(f"found no column '{name}'{did_you_mean(name, listed)}, expected one of {_some(listed)}")
    try:
        return listed[name] * (float(factor) if factor else 1.0)
    except ValueError:
        raise InputError(f"found '{text}', expected COLUMN or COLUMN*FACTOR") from None


def _size(values: np.ndarray) -> float:
    return float(np.nanmax(np.abs(values), initial=0.0))


def _difference(
    channel: str, column: str, own: np.ndarray, listed: np.ndarray, t: np.ndarray, least: float
) -> Difference:
    apart = np.abs(own - listed)
    if not np.isfinite(apart).any():
        return Difference(channel, column, float("nan"), float(t[0]), float("nan"))
    k, size = int(np.nanargmax(apart)), max(_size(listed) or _size(own), least)
    return Difference(channel, column, float(apart[k]), float(t[k]), float(apart[k]) / size if size else 0.0)


def _some(columns: Columns) -> str:
    names = [name for name in columns if name != TIME]
    return ", ".join(names[:12]) + (f" and {len(names) - 12} more" if len(names) > 12 else "")
