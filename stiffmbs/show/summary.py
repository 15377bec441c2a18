"""A solution in words and tables, for a person and for a program."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from ..results.energy_balance_notes import balance_words
from ..results.error_bars import UNKNOWN
from ..results.solution import Solution, channel_ranges
from ..solve.trajectory import Outcome
from .counters import solver_words
from .escaped import console as escaping_console
from .force_table import NOT_UNIQUE, force_table

if TYPE_CHECKING:
    from rich.console import Console

    from ..adams.listing import ListedStatement
    from ..analyses.check import Report

UNBROKEN = 10_000
"""Characters of a line in files, pipes and texts."""
STATUS = {Outcome.DONE: "done", Outcome.INTERRUPTED: "interrupted", Outcome.STOPPED: "stopped"}


@np.errstate(all="ignore")  # of a diverged run sums overflow
def as_json(scene: str, solution: Solution) -> str:
    """The one-line JSON object of ``stiffmbs run --json``."""
    return json_line(
        {
            "scene": scene,
            "status": STATUS[solution.outcome],
            "message": solution.message,
            "notes": list(solution.notes),
            "presolve": list(solution.presolve),
            "time": {"start": float(solution.time[0]), "end": float(solution.time[-1])},
            "solver": solution.solver,
            "balance": solution.balance.as_dict(),
            "not_unique": list(solution.not_unique),
            **({"verification": list(solution.verification)} if solution.verification else {}),
            "channels": _with_errors(solution),
        }
    )


def _with_errors(solution: Solution) -> dict[str, dict[str, float]]:
    """The ranges of all channels, of a verified run with their errors; null where nothing is known."""
    ranges = channel_ranges(solution)
    if solution.verification:
        for name, cell in ranges.items():
            bar = solution.errors.get(name, UNKNOWN)
            cell |= {"error": bar.over_time, "min_error": bar.least, "max_error": bar.greatest}
    return ranges


def check_as_json(scene: str, report: Report, listed: Sequence[ListedStatement] = ()) -> str:
    """The one-line JSON object of ``stiffmbs check --json``, of a dataset with its statements."""
    statements = {"statements": [statement.as_dict() for statement in listed]} if listed else {}
    return json_line(report.as_dict(scene) | statements)


def error_as_json(scene: str, message: str, status: str = "error") -> str:
    """The one-line JSON object for a scene that could not be run, or that has no result."""
    return json_line({"scene": scene, "status": status, "message": message})


def json_line(content: Any) -> str:
    """Anything as one line of JSON; NaN and infinity become null."""
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


def summary(solution: Solution) -> str:
    """See `Solution.summary`."""
    from io import StringIO

    text = StringIO()
    _print(solution.name or "model", solution, escaping_console(file=text, width=UNBROKEN))
    return text.getvalue().rstrip()


def print_summary(scene: str, solution: Solution, results: str, console: Console) -> None:
    """What was solved, the range of every joint force, energy drift, solver statistics, where the results lie."""
    _print(scene, solution, console)
    console.print(f"results: {results}", highlight=False, markup=False, emoji=False, soft_wrap=True)


@np.errstate(all="ignore")  # of a diverged run sums overflow
def _print(scene: str, solution: Solution, console: Console) -> None:
    say = partial(console.print, highlight=False, markup=False, emoji=False)  # names may hold anything
    start, end = solution.time[0], solution.time[-1]
    say(f"{solution.name or scene}: {start:g} s to {end:g} s, {solution.message}")
    for note in solution.notes:
        say(f"note: {note}")
    for sentence in solution.presolve:
        say(f"presolve: {sentence}")
    for sentence in solution.verification:
        say(f"verified: {sentence}")
    table = force_table(solution)
    if table.row_count:
        say("force and torque on the first body, min .. max (N, N m):")
        console.print(table)
    if solution.not_unique:
        say(f"{NOT_UNIQUE} not determined by rigid bodies: one of many possible values")
    total = solution.channels["energy.total"]
    say(
        f"energy: {total[0]:.9g} J at the start, {balance_words(solution.balance)}; "
        f"constraints hold to {np.nanmax(solution.channels['constraint.position']):.2g} in position, "
        f"{np.nanmax(solution.channels['constraint.velocity']):.2g} in velocity",
    )
    say(f"solver: {solver_words(solution.solver)}")
