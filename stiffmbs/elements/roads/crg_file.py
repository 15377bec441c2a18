"""Files of curved regular grids (OpenCRG, .crg): a header in text, then heights as text or as binary numbers.

ASAM OpenCRG 1.2, user manual. Blocks of the header begin with ``$NAME`` and end with ``$``; a line ``$$$$`` ends the
header. A record of the data is one cross-section: the channels that ``$KD_DEFINITION`` lists, in their order.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from ...errors import InputError
from ...reading.files.quoted import quoted
from ...reading.files.requested import Fields
from ...reading.files.text_file import finite_number

WIDTH: Final = 72
"""Number of significant characters in a header line."""
REFUSED = {"ROAD_CRG_FILE": "a reference to another file", "ROAD_CRG_MODS": "modifiers"}
"""Unsupported blocks that change the meaning of the file, with descriptions."""
TEXTS = ("CT",)
"""Comment blocks."""
OF_NO_EFFECT = {f"REFERENCE_LINE_OFFSET_{axis}": 0.0 for axis in ("X", "Y", "Z", "PHI")}
"""Unused numbers of ``$ROAD_CRG``, and their values without effect."""


@dataclass(frozen=True)
class Entry:
    """Line of a block, without its comment."""

    line: int
    text: str


@dataclass(frozen=True)
class CrgHeader:
    """Header of a file."""

    blocks: Fields[list[Entry]]
    numbers: Fields[float]  # numbers of ``$ROAD_CRG`` by name, in capitals
    layout: str  # format of the data: LRFI, LDFI, KRBI or KDBI
    channels: list[Entry]  # channel definitions, ``D:``
    u: tuple[float, float]  # start and increment, m
    line: int  # last line of the header
    end: int  # offset of the data, bytes


def read_header(content: bytes, path: Path) -> CrgHeader:
    """Read the header of a file. Raises InputError if it is not a valid header; the message contains the line."""
    source = str(path)
    found, line, end = _blocks(content, source)
    blocks = Fields("block", "", {name: entries for name, entries in found.items() if entries})
    blocks.request(*TEXTS)
    for name, holds in REFUSED.items():
        if blocks.get(name):
            entry = blocks[name][0]
            raise InputError(
                f"{source}, line {entry.line}: found ${name}, {holds}, expected a file with heights as they are"
            )
    numbers = Fields("[ROAD_CRG]", "", dict(_numbers(blocks.get("ROAD_CRG", []), source)), OF_NO_EFFECT)
    definition = blocks.get("KD_DEFINITION", [])
    layouts = [entry for entry in definition if entry.text.startswith("#:")]
    channels = [Entry(entry.line, entry.text[2:].strip()) for entry in definition if entry.text.startswith("D:")]
    if not layouts or not channels:
        raise InputError(f"{source}: found no $KD_DEFINITION with a format (#:) and channels (D:)")
    layout = layouts[-1].text[2:].strip()
    if layout not in ("LRFI", "LDFI", "KRBI", "KDBI"):
        raise InputError(
            f"{source}, line {layouts[-1].line}: found the format '{quoted(layout)}', expected LRFI, LDFI, KRBI or KDBI"
        )
    start = numbers.get("REFERENCE_LINE_START_U", 0.0), numbers.get("REFERENCE_LINE_INCREMENT", 0.01)
    return CrgHeader(blocks, numbers, layout, channels, _u(definition, start, source), line, end)


def _blocks(content: bytes, source: str) -> tuple[dict[str, list[Entry]], int, int]:
    """Return the blocks, the last line of the header, and the offset of the first byte after it."""
    blocks: dict[str, list[Entry]] = {}
    name, at, number = "", 0, 0
    while at < len(content):
        stop = content.find(b"\n", at)
        stop = len(content) if stop < 0 else stop
        number += 1
        text = content[at:stop].decode("latin-1").rstrip("\r")[:WIDTH]
        at = stop + 1
        word = text.partition("!")[0].strip()
        if text.startswith("$$"):
            if name:
                raise InputError(f"{source}, line {number}: found the end of the header inside ${name}, expected '$'")
            return blocks, number, at
        if word == "$":
            if not name:
                raise InputError(f"{source}, line {number}: found the end of a block, expected its beginning")
            name = ""
        elif text.startswith("$"):
            if name:
                raise InputError(f"{source}, line {number}: found {quoted(word)} inside ${name}, expected '$'")
            name = word[1:].split()[0].upper()
            blocks.setdefault(name, [])
        elif name and word and not text.startswith("*"):
            blocks[name].append(Entry(number, word))
    raise InputError(f"{source}: found no line $$$$ that ends the header, expected an OpenCRG file with data")


def _numbers(block: list[Entry], source: str) -> Iterator[tuple[str, float]]:
    for entry in block:
        name, equals, value = entry.text.partition("=")
        if equals:
            yield name.strip().upper(), finite_number(value.strip(), f"{source}, line {entry.line}")


def _u(definition: list[Entry], start: tuple[float, float], source: str) -> tuple[float, float]:
    """Return start and increment of the reference line, from ``U: reference line u,m,0.0,0.01`` if present."""
    for entry in definition:
        parts = [part.strip() for part in entry.text[2:].split(",")]
        if entry.text.startswith("U:") and parts[:2] == ["reference line u", "m"]:
            where, stated = f"{source}, line {entry.line}", (*parts[2:4], "", "")[:2]
            first, step = (finite_number(part, where) if part else own for part, own in zip(stated, start, strict=True))
            start = first, step
    if not start[1] > 0:
        raise InputError(f"{source}: found an increment of {start[1]:g} m, expected one above zero")
    return start


COLUMNS: Final = 80
"""Characters of a line of data, and block size of binary data, bytes."""
CHARACTERS = {"LRFI": 10, "LDFI": 20}
FROM_BEFORE = ("reference line phi", "reference line slope")
"""Channels that apply to the interval before a record, and are undefined in the first record."""
BINARY = {"KRBI": ">f4", "KDBI": ">f8"}


def read_records(content: bytes, header: CrgHeader, path: Path) -> np.ndarray:
    """Read the values of the channels, shape (cross-sections, channels).

    Raises InputError if they contradict the header, or one is not finite; the message contains the line or the
    cross-section.
    """
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
    kind = np.dtype(BINARY[header.layout])
    numbers = np.frombuffer(data, kind, len(data) // kind.itemsize).astype(float)
    count = len(header.channels)
    records = numbers[: len(numbers) // count * count].reshape(-1, count)
    padding = COLUMNS // kind.itemsize
    while len(records) and np.all(np.isnan(records[-1])) and padding >= count:
        records, padding = records[:-1], padding - count
    return records


def _text(data: bytes, header: CrgHeader, source: str) -> np.ndarray:
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
        for column in range(part * in_line, min((part + 1) * in_line, count)):
            at = (column - part * in_line) * width
            text = line[at : at + width]
            try:
                records[row, column] = math.nan if "*" in text else float(text)
            except ValueError:
                raise InputError(
                    f"{source}, line {header.line + 1 + k}: found '{quoted(text)}' for '{_name(header, column)}', expected a number "
                    f"of {width} characters"
                ) from None
    return records
