"""Columns over time of result files: files of this package, tables as text, and Adams' .res files in XML."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from ...errors import InputError
from ...reading.files.files_read import content_of
from ...reading.files.quoted import quoted
from ..damaged import readable
from ..saved_state import READERS

Columns = dict[str, np.ndarray]
"""Columns by name; time is ``time``."""
TIME = "time"
_SPLIT = re.compile(r"\s*[,;\t]\s*|\s+")
_WORDS = re.compile(r'"[^"]*"|[^\s,;"]+')


def read_columns(path: str | Path) -> Columns:
    """Read the columns of a file over time.

    Parameters
    ----------
    path : str or Path
        Results of this package (.npz, .csv, .nc), a table as text with time in its first column (.tab, .txt, .csv,
        .req, ...), or a .res or .xml file of Adams.  A column of a table has its number as a name, ``1`` for time, and
        its name in the header if that has as many names as columns.  A column of Adams' XML is called
        ``entity.component``.

    Raises
    ------
    InputError
        If the file cannot be read or has no columns of numbers over time.
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
    if file.suffix in (".npz", ".nc"):
        return lambda path: {
            name: np.asarray(values, dtype=float)
            for name, values in READERS[path.suffix](path).items()
            if values.dtype.kind == "f" and values.ndim == 1
        }
    return _table


def _table(path: Path) -> Columns:
    """Return the longest block of lines with equally many numbers, with the names in a line before it."""
    lines = content_of(path).decode(errors="replace").splitlines()
    rows = [_numbers(line) for line in lines]
    first, last = _longest_block([len(row) for row in rows])
    if last - first < 2:
        raise ValueError("no lines of numbers")
    table = np.array(rows[first:last]).T
    found = {str(k): column for k, column in enumerate(table, start=1)}
    for line in lines[first - 1 :: -1] if first else ():
        names = [word.strip('"').partition(" (")[0] for word in _heads(line)]
        if len(names) == len(table):
            found |= {name: column for name, column in zip(names, table, strict=True) if name}
            break
    return found | {TIME: table[0]}


def _heads(line: str) -> list[str]:
    """Return the names of columns, separated by tabs or commas if there are any, else by blanks."""
    for sign in ("\t", ","):
        if sign in line:
            return [part.strip() for part in line.strip("\r\n").split(sign)]
    return _WORDS.findall(line)


def _numbers(line: str) -> list[float]:
    """Return the numbers of a line, or none if it has other content."""
    parts = [part for part in _SPLIT.split(line.strip()) if part]
    try:
        return [float(part.replace("D", "E").replace("d", "e")) for part in parts]
    except ValueError:
        return []


def _longest_block(widths: Sequence[int]) -> tuple[int, int]:
    """Return the bounds of the longest run of lines with the same number of columns, two or more."""
    best, start = (0, 0), 0
    for k in range(1, len(widths) + 1):
        if k == len(widths) or widths[k] != widths[start]:
            if widths[start] > 1 and k - start > best[1] - best[0]:
                best = (start, k)
            start = k
    return best


def _adams_xml(path: Path) -> Columns:
    """Read Adams' .res in XML: a map that names the numbers of a step, and the steps."""
    names: dict[int, str] = {}
    rows: list[list[float]] = []
    for element in _elements(path):
        match element.tag.rpartition("}")[2]:
            case "Entity":
                entity = element.get("name") or ""
                for component in element:
                    names[int(component.get("id") or 0)] = ".".join(filter(None, (entity, component.get("name"))))
            case "Step":
                if element.get("type") != "initialConditions":
                    rows.append([float(text) for text in (element.text or "").split()])
    if not rows:
        raise ValueError("no steps")
    table = np.array(rows).T
    found = {names.get(k, str(k)): column for k, column in enumerate(table, start=1)}
    of_time = next((name for name in found if name.lower() in (TIME, f"{TIME}.{TIME}")), None)
    return found | {TIME: found[of_time] if of_time else table[0]}


def _elements(path: Path) -> Iterator[ElementTree.Element]:
    with path.open("rb") as file:
        for _, element in ElementTree.iterparse(file):
            yield element
