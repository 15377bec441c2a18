"""Regular blocks of J: three velocities of a body in all rows of a joint, or diagonally in three of them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from .joint_blocks import Joints

MOST_ROWS = 6
"""Rows of a joint that fit into registers."""
COLUMNS = range(3)
Third = tuple[int, int, int]
"""Joint, body, and the first of three velocities."""


class Sides(NamedTuple):
    """Regular blocks of J, and the positions of their entries among the values.

    Attributes
    ----------
    full : dict
        Start of the three entries of each row, by joint, body and first velocity.
    straight : dict
        First row, and the sources of the entries on a diagonal from there.
    handled : frozenset
        Keys of both.
    """

    full: dict[Third, list[int]]
    straight: dict[Third, tuple[int, list[int]]]
    handled: frozenset[Third]


def sides_of(places: Iterable[tuple[int, int, int, int]], sources: Iterable[int], sizes: list[int]) -> Sides:
    """Return the regular blocks, from joint, body, velocity and row of each entry of J, and its source."""
    found: dict[Third, dict[tuple[int, int], list[int]]] = {}
    for (k, body, velocity, row), source in zip(places, sources, strict=True):
        third = found.setdefault((k, body, velocity - velocity % 3), {})
        third.setdefault((row, velocity % 3), []).append(source)
    full, straight = {}, {}
    for key, own in found.items():
        if any(len(added) > 1 for added in own.values()):
            continue
        at = {place: added[0] for place, added in own.items()}
        begins = [at.get((row, 0), 0) for row in range(sizes[key[0]])]
        first = min(row for row, _ in at)
        if len(begins) <= MOST_ROWS and at == {
            (row, c): begins[row] + c for row in range(len(begins)) for c in COLUMNS
        }:
            full[key] = begins
        elif at.keys() == {(first + c, c) for c in COLUMNS}:
            straight[key] = first, [at[first + c, c] for c in COLUMNS]
    return Sides(full, straight, frozenset([*full, *straight]))


def side_lists(joints: Joints, sides: Sides, begin: Mapping[tuple[int, int], int], width: int) -> dict[str, Any]:
    """Return the rows of ``full`` and ``straight`` (`stiffmbs.solve.native.tables.linear.BLOCK_ELIMINATION`)."""
    full, straight = [], []
    for (k, body, first), sources in sides.full.items():
        at = begin[k, body] + first * joints.widths[k]
        row = len(sources), joints.starts[k], joints.strides[k], joints.places[k], at, width * body + first
        full.append((*row, *sources, *[0] * (MOST_ROWS - len(sources))))
    for (k, body, first), (line, sources) in sides.straight.items():
        at = begin[k, body] + first * joints.widths[k] + line
        place = joints.starts[k] + line * (joints.strides[k] + 1)
        straight.append(
            (
                place,
                joints.strides[k] + 1,
                joints.places[k] + line,
                at,
                joints.widths[k] + 1,
                width * body + first,
                *sources,
            )
        )
    return {"full": full, "straight": straight}
