"""Messages on reactions without a unique value."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from ..directions import Direction
from ..overconstraint import listed
from ..uniqueness import Indeterminate


def channel_words(parts: Sequence[Indeterminate]) -> str:
    """List the components, with elements that have the same ones together: ``fz and tx of lower and upper``."""
    alike: dict[tuple[str, ...], list[str]] = {}
    for part in parts:
        components = tuple(name.rpartition(".")[2] for name in part.channels)
        alike.setdefault(components, []).append(part.element)
    return "; ".join(f"{listed(components)} of {listed(elements)}" for components, elements in alike.items())


def directed_words(parts: Sequence[Indeterminate]) -> Iterator[str]:
    """Yield the constant directions of indeterminate forces and torques."""
    in_plane = [
        f"of {part.element} at {_degrees(direction.vector):.4g} deg of {direction.axes}"
        for part in parts
        for direction in part.directions if len(direction.vector) == 2
    ]  # fmt: skip
    if in_plane:
        yield f"forces only in the directions {listed(in_plane)}, across them they are unique"
    alike: dict[Direction, list[str]] = {}
    for part in parts:
        for direction in part.directions:
            if len(direction.vector) == 3 and not _told_by_channels(part, direction):
                alike.setdefault(direction, []).append(part.element)
    for direction, elements in alike.items():
        where = f"{'across' if direction.across else 'along'} {_axis(direction.vector)} of {direction.axes}"
        other = "along it" if direction.across else "across it"
        yield f"{direction.quantity}s of {listed(elements)} only {where}, {other} they are unique"


def _degrees(vector: Sequence[float]) -> float:
    """Return the angle of a direction in the plane, in [0, 180) deg."""
    angle = round(math.degrees(math.atan2(vector[1], vector[0])), 4)
    return angle % 180


def _axis(vector: Sequence[float]) -> str:
    if max(abs(part) for part in vector) == 1.0:
        return "xyz"[[abs(part) for part in vector].index(1.0)]
    return f"({', '.join(f'{part:.4g}' for part in vector)})"


def _told_by_channels(part: Indeterminate, direction: Direction) -> bool:
    """Return True if the components without a unique value are as few as the directions."""
    components = [name for name in part.channels if name.rpartition(".")[2].startswith(direction.quantity[0])]
    return len(components) <= (2 if direction.across else 1)
