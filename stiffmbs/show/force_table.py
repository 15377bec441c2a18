"""Force table of a summary: the range of each component of the force and torque of every element."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from ..compile.bodies import PLANE, SPACE
from ..describe.parts.names import owner_of
from ..results.error_bars import ErrorBar
from ..results.solution import Solution, channel_ranges
from .digits import with_bar

if TYPE_CHECKING:
    from rich.table import Table

SHOWN_AS_ZERO = 1e-11
"""Part of the largest force below which a force is shown as zero."""
NOT_UNIQUE = "*"
"""Mark of the range of a reaction without a unique value."""
Cell = Mapping[str, float]


def force_table(solution: Solution, most: int | None = None) -> Table:
    """Return a table with a row for each element; in space one for its force, and one for its torque if it has any.

    Parameters
    ----------
    solution : Solution
    most : int, optional
        Number of elements, those of the largest loads in the order of the scene; all by default.
    """
    from rich.table import Table

    ranges = channel_ranges(solution)
    own = [name for name in ranges if name not in solution.requested]
    in_space = any(name.endswith(".tz") for name in own)
    components = SPACE.reactions if in_space else PLANE.reactions
    every = elements_of(solution)
    loads = {element: tuple(_largest(ranges[f"{element}.{part}"]) for part in components) for element in every}
    noise = SHOWN_AS_ZERO * max((max(load) for load in loads.values()), default=0.0)
    n_forces = 3 if in_space else 2
    by_load = sorted(every, key=lambda element: (max(loads[element][:n_forces]), max(loads[element])), reverse=True)
    shown = set(by_load[:most])
    elements = [element for element in every if element in shown]

    def cells(element: str, components: Sequence[str]) -> list[str]:
        return [_shown(solution, f"{element}.{part}", ranges[f"{element}.{part}"], noise) for part in components]

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
    own = [name for name in solution.channels if name not in solution.requested]
    last = (SPACE if any(name.endswith(".tz") for name in own) else PLANE).reactions[-1]
    return list(dict.fromkeys(owner_of(name) for name in own if name.endswith(f".{last}")))


def _largest(cell: Cell) -> float:
    return max(abs(cell["min"]), abs(cell["max"]))


def _shown(solution: Solution, name: str, cell: Cell, noise: float) -> str:
    return _range(cell, solution.errors.get(name), noise) + NOT_UNIQUE * (name in solution.not_unique)


def _range(cell: Cell, bar: ErrorBar | None, noise: float) -> str:
    """Return the least and greatest value; for a verified run, each on a line with its error bar."""
    ends = (cell["min"], cell["max"])
    if bar is None:
        return " .. ".join(_digits(end, noise) for end in ends)
    return "\n".join(with_bar(end, half, noise) for end, half in zip(ends, (bar.least, bar.greatest), strict=True))


def _digits(value: float, noise: float) -> str:
    return "0" if abs(value) <= noise else f"{value:.5g}"
