"""Files of curved regular grids (OpenCRG, .crg): a header in text, then heights as text or as binary numbers.

ASAM OpenCRG 1.2, user manual. Blocks of the header begin with ``$NAME`` and end with ``$``; a line ``$$$$`` ends the
header. A record of the data is one cross-section: the channels that ``$KD_DEFINITION`` lists, in their order.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from ...errors import InputError
from ..files.quoted import quoted
from ..files.requested import Fields

WIDTH = 72
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
    """Header of a file.

    Attributes
    ----------
    blocks : Fields of lists of Entry
    numbers : Fields of float
        Numbers of ``$ROAD_CRG`` by name, in capitals.
    layout : str
        Format of the data: LRFI, LDFI, KRBI or KDBI.
    channels : list of Entry
        Channel definitions, ``D:``.
    u : tuple of float
        Start and increment, m.
    line : int
        Last line of the header.
    end : int
        Offset of the data, bytes.
    """

    blocks: Fields[list[Entry]]
    numbers: Fields[float]
    layout: str
    channels: list[Entry]
    u: tuple[float, float]
    line: int
    end: int


def read_header(content: bytes, path: Path) -> CrgHeader:
    """Read the header of a file.

    Raises
    ------
    InputError
        If it is not a valid header; the message contains the line.
    """
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
            yield name.strip().upper(), _number(value, f"{source}, line {entry.line}")


def _u(definition: list[Entry], start: tuple[float, float], source: str) -> tuple[float, float]:
    """Return start and increment of the reference line, from ``U: reference line u,m,0.0,0.01`` if present."""
    for entry in definition:
        parts = [part.strip() for part in entry.text[2:].split(",")]
        if entry.text.startswith("U:") and parts[:2] == ["reference line u", "m"]:
            where, stated = f"{source}, line {entry.line}", (*parts[2:4], "", "")[:2]
            first, step = (_number(part, where) if part else own for part, own in zip(stated, start, strict=True))
            start = first, step
    if not start[1] > 0:
        raise InputError(f"{source}: found an increment of {start[1]:g} m, expected one above zero")
    return start


def _number(text: str, where: str) -> float:
    try:
        value = float(text.replace("D", "E").replace("d", "e"))
    except ValueError:
        raise InputError(f"{where}: found '{quoted(text.strip())}', expected a number") from None
    if not math.isfinite(value):
        raise InputError(f"{where}: found '{quoted(text.strip())}', expected a finite number")
    return value
