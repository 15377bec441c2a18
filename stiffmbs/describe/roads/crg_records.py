"""Records of an OpenCRG file: text of fixed width, or big-endian binary numbers."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from ...errors import InputError
from ..files.quoted import quoted
from .crg_file import CrgHeader

if TYPE_CHECKING:
    import numpy as np

COLUMNS = 80
"""Characters of a line of data, and block size of binary data, bytes."""
CHARACTERS = {"LRFI": 10, "LDFI": 20}
FROM_BEFORE = ("reference line phi", "reference line slope")
"""Channels that apply to the interval before a record, and are undefined in the first record."""
BINARY = {"KRBI": ">f4", "KDBI": ">f8"}


def read_records(content: bytes, header: CrgHeader, path: Path) -> np.ndarray:
    """Read the values of the channels, shape (cross-sections, channels).

    Raises
    ------
    InputError
        If they contradict the header, or one is not finite; the message contains the line or the cross-section.
    """
    import numpy as np

    data = content[header.end :]
    records = _binary(data, header) if header.layout in BINARY else _text(data, header, str(path))
    if len(records) < 2:
        raise InputError(f"{path}: found {len(records)} cross-sections, expected two or more")
    missing = ~np.isfinite(records)
    missing[0] &= [_name(header, column) not in FROM_BEFORE for column in range(len(header.channels))]
    if np.any(missing):
        row, column = np.argwhere(missing)[0]
        u = header.u[0] + row * header.u[1]
        raise InputError(
            f"{_place(path, header, int(row), int(column))}: found no number for '{_name(header, int(column))}' at u = {u:g} m, "
            "expected a height everywhere: cut the road, or fill its gaps"
        )
    return records


def _place(path: Path, header: CrgHeader, row: int, column: int) -> str:
    if header.layout in BINARY:
        return f"{path}, cross-section {row + 1}"
    in_line = COLUMNS // CHARACTERS[header.layout]
    lines = -(-len(header.channels) // in_line)
    return f"{path}, line {header.line + 1 + row * lines + column // in_line}"


def _name(header: CrgHeader, column: int) -> str:
    return header.channels[column].text.partition(",")[0].strip()


def _binary(data: bytes, header: CrgHeader) -> np.ndarray:
    """Return binary records; NaN fill the last 80 bytes."""
    import numpy as np

    kind = np.dtype(BINARY[header.layout])
    numbers = np.frombuffer(data[: len(data) // kind.itemsize * kind.itemsize], kind).astype(float)
    count = len(header.channels)
    records = numbers[: len(numbers) // count * count].reshape(-1, count)
    padding = COLUMNS // kind.itemsize
    while len(records) and np.all(np.isnan(records[-1])) and padding >= count:
        records, padding = records[:-1], padding - count
    return records


def _text(data: bytes, header: CrgHeader, source: str) -> np.ndarray:
    import numpy as np

    width, count = CHARACTERS[header.layout], len(header.channels)
    in_line = COLUMNS // width
    in_record = -(-count // in_line)
    lines = data.decode("latin-1").splitlines()
    while lines and not lines[-1].strip():
        lines.pop()
    if len(lines) % in_record:
        raise InputError(
            f"{source}, line {header.line + len(lines)}: found the end of the file within a cross-section, expected {count} "
            f"numbers in {in_record} lines"
        )
    records = np.empty((len(lines) // in_record, count))
    for k, line in enumerate(lines):
        row, part = divmod(k, in_record)
        first = part * in_line
        for column in range(first, min(first + in_line, count)):
            text = line[(column - first) * width : (column - first + 1) * width]
            records[row, column] = _value(text, f"{source}, line {header.line + 1 + k}", header, column)
    return records


def _value(text: str, where: str, header: CrgHeader, column: int) -> float:
    """Return a number; NaN for one that is marked as missing."""
    if set(text) & set("*") or text.strip().lower() == "nan":
        return float("nan")
    try:
        return float(text)
    except ValueError:
        raise InputError(
            f"{where}: found '{quoted(text)}' for '{_name(header, column)}', expected a number in so many characters"
        ) from None
