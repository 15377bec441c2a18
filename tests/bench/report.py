"""Measured rows as JSON, and as a table for people."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from typing import Any

from stiffmbs.comparison.machine import machine

from .benchmark import Row
from .decades import SET_UP, TARGETS, Race, races
from .sweep import at_target_rows

REFERENCE, OWN, AUTO = "yardstick", ("bdf", "dop853"), "auto"
COLUMN = 9


def as_json(problem: str, rows: Sequence[Row]) -> dict[str, Any]:
    """The object of ``python -m tests.bench --json`` for one problem."""
    return {"problem": problem, "machine": machine(), "rows": [asdict(row) for row in rows]}


def read_json(text: str) -> dict[str, list[Row]]:
    """The rows of each problem in what ``python -m tests.bench --json`` printed."""
    objects = (json.loads(line) for line in text.splitlines())
    return {found["problem"]: [Row(**row) for row in found["rows"]] for found in objects}


def table(problem: str, rows: Sequence[Row]) -> Iterator[str]:
    """Times at the target error with their ratios to the yardstick, or where there are none the rows as measured."""
    targets = at_target_rows(rows)
    if len({row.error for row in targets}) > 1:
        yield from _decades_table(problem, rows)
        return
    at_target = {row.solver: row.seconds for row in targets}
    if not at_target:
        yield problem
        for row in rows:
            yield f"  {row.solver:22} {row.setting:54} error {row.error:8.1e}  {row.seconds * 1e3:10.3f} ms"
        return
    ratios = ", and its ratio to the yardstick" if REFERENCE in at_target else ""
    yield f"{problem}: time at an error of {targets[0].error:g}{ratios}"
    for solver, seconds in at_target.items():
        ratio = f"{seconds / at_target[REFERENCE]:8.2f}" if REFERENCE in at_target else ""
        yield f"  {solver:22} {seconds * 1e3:10.3f} ms {ratio}"
    best = min((at_target[solver] for solver in OWN if solver in at_target), default=None)
    if best and AUTO in at_target:
        yield f"  auto takes {at_target[AUTO] / best:.2f} times as long as the better of bdf and dop853"


def _decades_table(problem: str, rows: Sequence[Row]) -> Iterator[str]:
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
        if any(AUTO in race.seconds for race in found.values()):
            yield _line("best peer / auto", [*(_of_auto(found.get(target)) for target in TARGETS), ""])
        for race in found.values():
            yield f"  {race.error:.0e}: {race.best_own} beside {race.best_peer}"


def _of_auto(race: Race | None) -> str:
    """Return the time of the best peer over that of the package's own choice."""
    if race is None or AUTO not in race.seconds:
        return "-"
    return f"{race.seconds[race.best_peer] / race.seconds[AUTO]:.2f}"


def _line(name: str, cells: Sequence[str]) -> str:
    return f"  {name:27}" + "".join(cell.rjust(COLUMN) for cell in cells)


def _milliseconds(seconds: float | None) -> str:
    return "-" if seconds is None else f"{seconds * 1e3:.3g}"
