"""Times over decades of error, as a table for people."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from .benchmark import Row
from .decades import SET_UP, TARGETS, races
from .sweep import at_target_rows

COLUMN = 9


def table(problem: str, rows: Sequence[Row]) -> Iterator[str]:
    """Time of each contestant at each error, the set-up apart, and what the best peer takes longer than this package."""
    at = {(row.solver, row.error): row.seconds for row in at_target_rows(rows)}
    set_up = {row.solver: row.seconds for row in rows if row.setting == SET_UP}
    yield f"{problem}: ms at an error of (set-up, ms, apart)"
    yield _line("", [*(f"{target:.0e}" for target in TARGETS), "set-up"])
    for solver in dict.fromkeys(row.solver for row in rows):
        times = [at.get((solver, target)) for target in TARGETS]
        yield _line(solver, [*map(_milliseconds, times), _milliseconds(set_up.get(solver))])
    found = {race.error: race for race in races(rows)}
    if found:
        ratios = [f"{found[target].ratio:.2f}" if target in found else "-" for target in TARGETS]
        yield _line("best peer / best own", [*ratios, ""])
        for race in found.values():
            yield f"  {race.error:.0e}: {race.best_own} beside {race.best_peer}"


def _line(name: str, cells: Sequence[str]) -> str:
    return f"  {name:27}" + "".join(cell.rjust(COLUMN) for cell in cells)


def _milliseconds(seconds: float | None) -> str:
    return "-" if seconds is None else f"{seconds * 1e3:.3g}"
