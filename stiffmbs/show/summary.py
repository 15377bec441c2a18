"""A solution in words and tables, for a person and for a program."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Any

from ..analyse.reactions import COMPONENTS
from ..solve.trajectory import Outcome
from .solution import Solution, channel_ranges

if TYPE_CHECKING:
    from rich.console import Console

    from .check import Report

ROUNDING = 1e-12
"""Part of the largest force below which a force is shown as zero."""
NOT_UNIQUE = "*"
"""Stands behind the range of a reaction that has no unique value."""
STATUS = {Outcome.DONE: "done", Outcome.INTERRUPTED: "interrupted", Outcome.STOPPED: "stopped"}


def as_json(scene: str, solution: Solution) -> str:
    """The one-line JSON object of ``stiffmbs run --json``."""
    return _line(
        {
            "scene": scene,
            "status": STATUS[solution.outcome],
            "message": solution.message,
            "notes": list(solution.notes),
            "time": {"start": float(solution.time[0]), "end": float(solution.time[-1])},
            "solver": solution.solver,
            "not_unique": list(solution.not_unique),
            "channels": channel_ranges(solution),
        }
    )


def check_as_json(scene: str, report: Report) -> str:
    """The one-line JSON object of ``stiffmbs check --json``."""
    return _line(report.as_dict(scene))


def error_as_json(scene: str, message: str) -> str:
    """The one-line JSON object for a scene that could not be run."""
    return _line({"scene": scene, "status": "error", "message": message})


def _line(content: Any) -> str:
    return json.dumps(_finite(content), allow_nan=False)


def _finite(content: Any) -> Any:
    """JSON knows no NaN and no infinity: they become null."""
    match content:
        case dict():
            return {key: _finite(value) for key, value in content.items()}
        case list():
            return [_finite(value) for value in content]
        case float():
            return content if math.isfinite(content) else None
        case _:
            return content


def print_summary(scene: str, solution: Solution, results: str, console: Console) -> None:
    """What was solved, the range of every joint force, energy drift, solver statistics, where the results lie."""
    start, end = solution.time[0], solution.time[-1]
    console.print(f"{solution.name or scene}: {start:g} s to {end:g} s, {solution.message}", highlight=False)
    for note in solution.notes:
        console.print(f"note: {note}", highlight=False)
    table = _force_table(solution)
    if table.row_count:
        console.print("force and torque on the first body, least .. greatest (N, N m):", highlight=False)
        console.print(table)
    if solution.not_unique:
        console.print(f"{NOT_UNIQUE} not determined by rigid bodies: one of many possible values", highlight=False)
    total = solution.channels["energy.total"]
    console.print(
        f"energy: {total[0]:.9g} J at the start, changes by at most {solution.energy_drift():.3g} J; "
        f"constraints hold to {solution.channels['constraint.position'].max():.2g} in position, "
        f"{solution.channels['constraint.velocity'].max():.2g} in velocity",
        highlight=False,
    )
    console.print(_solver_line(solution.solver), highlight=False)
    console.print(f"results: {results}", highlight=False, soft_wrap=True)


def _force_table(solution: Solution) -> Any:
    from rich.table import Table

    table = Table()
    table.add_column("element")
    for component in COMPONENTS:
        table.add_column(component, justify="right", no_wrap=True)
    ranges = channel_ranges(solution)
    elements = dict.fromkeys(name.partition(".")[0] for name in ranges if name.endswith(".torque"))
    rows = {element: [ranges[f"{element}.{component}"] for component in COMPONENTS] for element in elements}
    noise = ROUNDING * max(
        (abs(cell[end]) for cells in rows.values() for cell in cells for end in ("min", "max")), default=0
    )
    for element, cells in rows.items():
        names = [f"{element}.{component}" for component in COMPONENTS]
        shown = [" .. ".join(_shown(cell[end], noise) for end in ("min", "max")) for cell in cells]
        marks = [NOT_UNIQUE * (name in solution.not_unique) for name in names]
        table.add_row(element, *(text + mark for text, mark in zip(shown, marks, strict=True)))
    return table


def _shown(value: float, noise: float) -> str:
    return "0" if abs(value) <= noise else f"{value:.5g}"


def _solver_line(solver: dict[str, Any]) -> str:
    counts = ", ".join(f"{value} {name}" for name, value in solver.items() if isinstance(value, int))
    return f"solver: {solver['name']}, {counts}, {solver['seconds'] * 1e3:.1f} ms"
