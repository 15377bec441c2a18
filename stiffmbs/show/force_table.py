"""Force table of a summary: the range of each component of the force and torque of every element."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..compile.bodies import PLANE, SPACE
from ..reading.names import owner_of
from ..results.error_bars import ErrorBar
from ..results.solution import Solution, channel_ranges
from .digits import with_bar

if TYPE_CHECKING:
    from rich.table import Table

NOT_UNIQUE = "*"
"""Mark of the range of a reaction without a unique value."""
Cell = Mapping[str, float]


@dataclass(frozen=True)
class Loads:
    """Choice of the loads of a summary.

    Attributes
    ----------
    most : int
        Number of elements that are listed by default, those of the largest loads.
    zero : float
        Part of the largest force below which a force is shown as zero.
    """

    most: int = 10
    zero: float = 1e-11


LOADS = Loads()


def force_table(solution: Solution, most: int | None = None) -> Table:
    """Return a table with a row for each element; in space one for its force, and one for its torque if it has any.

    `most`: number of elements, those of the largest loads in the order of the scene; all by default.
    """
    from rich.table import Table

    ranges = channel_ranges(solution)
    components = reactions_of(solution)
    in_space = components == SPACE.reactions
    every = elements_of(solution)
    loads = {element: tuple(_largest(ranges[f"{element}.{part}"]) for part in components) for element in every}
    noise = LOADS.zero * max((max(load) for load in loads.values()), default=0.0)
    n_forces = 3 if in_space else 2
    by_load = sorted(every, key=lambda element: (max(loads[element][:n_forces]), max(loads[element])), reverse=True)
    shown = set(by_load[:most])
    elements = [element for element in every if element in shown]

    def cells(element: str, components: Sequence[str]) -> list[str]:
        names = [f"{element}.{part}" for part in components]
        marks = [NOT_UNIQUE * (name in solution.not_unique) for name in names]
        return [
            _range(ranges[name], solution.errors.get(name), noise) + mark
            for name, mark in zip(names, marks, strict=True)
        ]

    def acts(element: str, components: Sequence[str]) -> bool:
        names = [f"{element}.{component}" for component in components]
        return any(_largest(ranges[name]) > noise or name in solution.not_unique for name in names)

    table = Table()
    table.add_column("element", no_wrap=True, overflow="fold")
    for head in ("x", "y", "z") if in_space else components:
        table.add_column(head, justify="right", overflow="fold")
    for element in elements:
        if not in_space:
            table.add_row(element, *cells(element, components))
            continue
        table.add_row(element, *cells(element, components[:3]))
        if acts(element, components[3:]):
            table.add_row("  torque", *cells(element, components[3:]))
    return table


def elements_of(solution: Solution) -> list[str]:
    """Return the elements that have a force and torque among the channels, in the order of the scene."""
    own, last = [name for name in solution.channels if name not in solution.requested], reactions_of(solution)[-1]
    return list(dict.fromkeys(owner_of(name) for name in own if name.endswith(f".{last}")))


def reactions_of(solution: Solution) -> tuple[str, ...]:
    """Return the labels of forces and torques in a solution."""
    in_space = any(name.endswith(".tz") for name in solution.channels if name not in solution.requested)
    return (SPACE if in_space else PLANE).reactions


def _largest(cell: Cell) -> float:
    return max(abs(cell["min"]), abs(cell["max"]))


def _range(cell: Cell, bar: ErrorBar | None, noise: float) -> str:
    """Return the least and greatest value; for a verified run, each on a line with its error bar."""
    ends = (cell["min"], cell["max"])
    if bar is None:
        return " .. ".join("0" if abs(end) <= noise else f"{end:.5g}" for end in ends)
    return "\n".join(with_bar(end, half, noise) for end, half in zip(ends, (bar.least, bar.greatest), strict=True))
