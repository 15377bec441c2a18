"""Curved regular grids: reference line in the plane, and heights relative to it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ...errors import InputError
from ...reading.files.requested import Fields, unused_notes
from ...reading.files.text_file import file_content
from .crg_file import CrgHeader, Entry, read_header, read_records

UNITS = {"phi": "rad", "slope": "m/m", "banking": "m/m"}
"""Units of the channels of the reference line."""
FROM_THE_DATA = (
    "REFERENCE_LINE_END_U", "REFERENCE_LINE_END_X", "REFERENCE_LINE_END_Y", "REFERENCE_LINE_END_Z", "REFERENCE_LINE_END_PHI",
    "REFERENCE_LINE_END_S", "REFERENCE_LINE_END_B", "LONG_SECTION_V_LEFT",
)  # fmt: skip
"""Numbers of ``$ROAD_CRG`` that are redundant with the data."""
SAME_HEADING = 1e-3
"""Tolerance of a given heading compared with the direction from start to end, rad."""
SAME_AT_END = {"S": 1e-3, "B": 1e-3, "Z": 1e-2}
"""Tolerances of slope, banking, and level (m) at the end, between the header and the data."""


@dataclass(frozen=True, eq=False)
class CrgGrid:
    """Curved regular grid."""

    path: str
    u: np.ndarray  # shape (n,): coordinates along the reference line, m
    v: np.ndarray  # shape (k,): coordinates to the left of it, m; increasing
    heights: np.ndarray  # shape (n, k): heights with slope and banking, m
    # x, y: shape (n,): coordinates of the reference line, m
    x: np.ndarray
    y: np.ndarray
    heading: float  # heading at the start, rad
    level: float  # height of the reference line at its start, m
    remarks: tuple[str, ...] = ()  # notes on unused parts of the file


def read_crg(path: Path) -> CrgGrid:
    """Read an OpenCRG file.

    A record's heading and slope apply to the interval before it, as in OpenCRG's library; its banking applies at the
    record. Raises InputError if it cannot be read; the message contains the line.
    """
    content = file_content(path, "an OpenCRG file")
    header = read_header(content, path)
    line, sections = _sorted_channels(header, path)
    v = _positions(header, sections, path)
    records = read_records(content, header, path)
    order = np.argsort(v, kind="stable")
    v = v[order]
    if not np.all(np.diff(v) > 0):
        raise InputError(f"{path}: found two long sections at one v, expected different positions")
    columns = np.array([column for column, _ in sections])[order]
    u = header.u[0] + header.u[1] * np.arange(len(records))
    get = header.numbers.get
    heading = 0.0 if "phi" in line else _heading(header.numbers, path)
    straight = {
        "phi": heading,
        "slope": get("REFERENCE_LINE_START_S", 0.0),
        "banking": get("REFERENCE_LINE_START_B", 0.0),
    }
    phi, slope, banking = (
        records[:, line[name]] if name in line else np.full(len(u), number) for name, number in straight.items()
    )
    level = get("REFERENCE_LINE_START_Z", 0.0) + _summed(slope * header.u[1])
    _check_end(
        header.numbers, {"S": slope[-1], "B": banking[-1], **({} if "slope" in line else {"Z": level[-1]})}, path
    )
    return CrgGrid(
        str(path), u, v, records[:, columns] + level[:, None] + banking[:, None] * v,
        get("REFERENCE_LINE_START_X", 0.0) + _summed(np.cos(phi) * header.u[1]),
        get("REFERENCE_LINE_START_Y", 0.0) + _summed(np.sin(phi) * header.u[1]),
        float(phi[1]), float(level[0]), tuple(_remarks(header, path)),
    )  # fmt: skip


def _remarks(header: CrgHeader, path: Path) -> Iterator[str]:
    """Yield one sentence for each field of a file that is not used."""
    if header.blocks.get("ROAD_CRG_OPTS"):
        yield f"the options of {path} are not used: the height is constant beyond the road"
    header.numbers.request(*FROM_THE_DATA)
    names = (entry.text.partition(",")[0].strip() for entry in header.channels)
    others = [x for x in names if not x.startswith("long section ") and x.removeprefix("reference line ") not in UNITS]
    channels = Fields("channel", "", dict.fromkeys(others, 0))
    yield from (f"{path}: {note}" for note in unused_notes([header.blocks, header.numbers, channels]))


def _heading(numbers: Mapping[str, float], path: Path) -> float:
    """Return the heading of a straight reference line, rad: the given one, or the direction from start to end."""
    start, end = ([numbers.get(f"REFERENCE_LINE_{which}_{axis}") for axis in "XY"] for which in ("START", "END"))
    given = numbers.get("REFERENCE_LINE_START_PHI")
    if None in end:
        return given or 0.0
    dx, dy = (float(last or 0.0) - float(first or 0.0) for first, last in zip(start, end, strict=True))
    found = math.atan2(dy, dx)
    if given is not None and abs(math.remainder(given - found, math.tau)) > SAME_HEADING:
        raise InputError(
            f"{path}: found REFERENCE_LINE_START_PHI = {given:g}, but the reference line leads from its start to its end at {found:.3g} rad"
        )
    return found if given is None else given


def _check_end(numbers: Mapping[str, float], found: dict[str, float], path: Path) -> None:
    """Refuse a header whose end contradicts slope and banking; all heights would be wrong."""
    for letter, value in found.items():
        stated = numbers.get(f"REFERENCE_LINE_END_{letter}")
        if stated is not None and not abs(stated - value) <= SAME_AT_END[letter]:
            name = {"S": "slope", "B": "banking", "Z": "level"}[letter]
            raise InputError(
                f"{path}: found REFERENCE_LINE_END_{letter} = {stated:g}, expected {value:.4g}, the {name} at the end of the reference line"
            )


def _summed(steps: np.ndarray) -> np.ndarray:
    """Return the cumulative sums of all steps except the first, which precedes the first record."""
    return np.concatenate([[0.0], np.cumsum(steps[1:])])


def _sorted_channels(header: CrgHeader, path: Path) -> tuple[dict[str, int], list[tuple[int, Entry]]]:
    """Return the columns of the reference line's channels by name, and those of the long sections."""
    line: dict[str, int] = {}
    sections: list[tuple[int, Entry]] = []
    for column, entry in enumerate(header.channels):
        name, _, unit = (part.strip() for part in entry.text.partition(","))
        kind = name.removeprefix("reference line ")
        expected = "m" if name.startswith("long section ") else UNITS.get(kind, unit)
        if unit != expected:
            raise InputError(f"{path}, line {entry.line}: found '{name}' in '{unit}', expected {expected}")
        if name.startswith("long section "):
            sections.append((column, Entry(entry.line, name.removeprefix("long section "))))
        elif name.startswith("reference line ") and kind in UNITS:
            line[kind] = column
    if len(sections) < 2:
        raise InputError(f"{path}: found {len(sections)} long sections, expected two or more")
    return line, sections


def _positions(header: CrgHeader, sections: list[tuple[int, Entry]], path: Path) -> np.ndarray:
    """Return v of the long sections, which are given individually, or equally spaced."""
    placed = [entry.text.startswith("at v =") for _, entry in sections]
    if any(placed) != all(placed):
        entry = sections[placed.index(not placed[0])][1]
        raise InputError(
            f"{path}, line {entry.line}: found 'long section {entry.text}', expected positions for all or none"
        )
    found = []
    for k, (_, entry) in enumerate(sections):
        text = entry.text.removeprefix("at v =").strip()
        try:
            found.append(float(text))
        except ValueError:
            raise InputError(
                f"{path}, line {entry.line}: found the long section '{entry.text}', expected a number"
            ) from None
        if not placed[0] and found[-1] != k + 1:
            raise InputError(f"{path}, line {entry.line}: found the long section {text}, expected {k + 1}")
    if placed[0]:
        return np.array(found)
    step = header.numbers.get("LONG_SECTION_V_INCREMENT", 0.01)
    right = header.numbers.get("LONG_SECTION_V_RIGHT", -step * (len(found) - 1) / 2)
    return right + step * np.arange(len(found))
