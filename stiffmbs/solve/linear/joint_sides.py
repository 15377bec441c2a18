"""Parts of J whose entries stand so that they need no list of their own: three velocities of a body in all rows of a joint, or one in each of three."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from .joint_blocks import Joints

MOST_ROWS = 6
"""Of a joint whose rows are gathered in registers."""
COLUMNS = range(3)
Third = tuple[int, int, int]
"""A joint, a body, and the first of three of its velocities."""


class Sides(NamedTuple):
    """Which parts of J are of the kind, and where their entries stand among the values.

    Attributes
    ----------
    full : dict
        Where the three entries of each row begin, by the joint, the body and the first velocity.
    straight : dict
        The first row, and the sources of the entries on a diagonal from there.
    handled : frozenset
        The keys of both.
    """

    full: dict[Third, list[int]]
    straight: dict[Third, tuple[int, list[int]]]
    handled: frozenset[Third]


def sides_of(places: Iterable[tuple[int, int, int, int]], sources: Iterable[int], sizes: list[int]) -> Sides:
    """From the joint, body, velocity and row of each entry of J, and its place among the values."""
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
    """The rows of ``full`` and ``straight`` (`stiffmbs.solve.native.tables.linear.BLOCK_ELIMINATION`)."""
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
