"""Summaries of a solution: text with tables, and JSON."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict
from functools import partial
from textwrap import wrap
from typing import TYPE_CHECKING, Any

import numpy as np

from ..evaluation.loads import elements_of
from ..results.digits import KnownErrors
from ..results.displayed import displayed
from ..results.energy_balance_notes import balance_words
from ..results.error_bars import UNKNOWN
from ..results.solution import Solution, channel_ranges
from ..solve.trajectory import Outcome
from .escaped import console as escaping_console
from .force_table import LOADS, NOT_UNIQUE, force_rows, request_lines, rich_table
from .plain import PlainConsole, boxed

if TYPE_CHECKING:
    from rich.console import Console

    from ..adams.listing import ListedStatement
    from ..analyses.check import Report

WORK = {
    "residuals": "residuals", "newton_iterations": "Newton iterations", "jacobians": "Jacobians",
    "factorizations": "factorizations", "accelerations": "accelerations", "moves": "moves",
}  # fmt: skip
"""Counters of work, in the order of a summary."""
AS_MANY_AS = {"newton_iterations": "residuals", "factorizations": "jacobians"}
"""Counters that are shown only where they differ from others."""
REPEATED = {"error_test_failures": "error test failures", "convergence_failures": "convergence failures"}
"""Reasons for which steps were repeated."""
RESTARTS = {"breakpoints": ("input breakpoint", "input breakpoints"), "events": ("event", "events")}
"""Instants at which the solver restarts: one, and several."""


def solver_lines(solver: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Yield label and text of each line on the solver of a run: its name, its steps, and their cost.

    `solver`: the statistics of a `Solution`.
    """
    chosen = {"scheme": "scheme", "linear_solver": "linear solver"}
    yield (
        "solver",
        ", ".join([solver["name"], *(f"{word} {solver[key]}" for key, word in chosen.items() if key in solver)]),
    )
    if "steps" in solver:
        yield "steps", ", ".join(_steps(solver))
    restarts = [
        f"{solver[counter]} {words[solver[counter] > 1]}" for counter, words in RESTARTS.items() if solver.get(counter)
    ]
    if restarts:
        yield "restarts", f"at {' and '.join(restarts)}"
    seconds = [f"{solver['seconds'] * 1e3:.1f} ms"] if "seconds" in solver else []
    yield "cost", ", ".join([*_work(solver), *seconds])


def _steps(solver: Mapping[str, object]) -> Iterator[str]:
    repeated = [f"{solver[counter]} {why}" for counter, why in REPEATED.items() if solver.get(counter)]
    if solver.get("rejected") and not repeated:
        repeated = [f"{solver['rejected']} rejected"]
    yield str(solver["steps"]) + (f" ({', '.join(repeated)})" if repeated else "")
    if "order" in solver:
        yield f"order {solver['order']} at the end"


def _work(solver: Mapping[str, object]) -> Iterator[str]:
    for counter, word in WORK.items():
        if counter in solver and solver[counter] != solver.get(AS_MANY_AS.get(counter, "")):
            yield f"{solver[counter]} {word}{_slow_convergence(solver) if counter == 'jacobians' else ''}"


def _slow_convergence(solver: Mapping[str, Any]) -> str:
    """Return how many Jacobians were computed because Newton's iteration converged too slowly with an older one.

    IDA counts them as failures of the iteration, and once more where a new matrix did not help, so that the step did not
    converge.
    """
    slow = solver.get("newton_failures", 0) - solver.get("convergence_failures", 0)
    return f" ({slow} after slow Newton convergence)" if slow > 0 else ""


UNBROKEN = 10_000
"""Line width of files, pipes and texts, characters."""
INDENT = len("constraints  ")
"""Width of the longest label of a line, and of the blanks after it."""
STATUS = {Outcome.DONE: "done", Outcome.INTERRUPTED: "interrupted", Outcome.STOPPED: "stopped"}


@np.errstate(all="ignore")  # sums of a diverged run overflow
def as_json(scene: str, solution: Solution) -> str:
    """Return the one-line JSON object of ``stiffmbs run --json``."""
    return json_line(
        {
            "scene": scene,
            "status": STATUS[solution.outcome],
            "message": solution.message,
            "ended": solution.ended.as_dict(),
            "notes": list(solution.notes),
            "note_details": [note.as_dict() for note in solution.notes],
            "presolve": list(solution.presolve),
            "time": {"start": float(solution.time[0]), "end": float(solution.time[-1])},
            "solver": solution.solver,
            "balance": solution.balance.as_dict(),
            "not_unique": list(solution.not_unique),
            **({"verification": list(solution.verification)} if solution.verification else {}),
            **({"errors": _estimated(solution)} if solution.estimate else {}),
            "channels": _with_errors(solution),
        }
    )


def _estimated(solution: Solution) -> dict[str, object]:
    """Return the outcome of the estimate of the errors, and the largest estimated error of each channel over time."""
    assert solution.estimate is not None
    return asdict(solution.estimate) | {"channels": {name: bar.over_time for name, bar in solution.errors.items()}}


def _with_errors(solution: Solution) -> dict[str, dict[str, float]]:
    """Return the ranges of all channels, with errors for a verified run; nan if unknown."""
    ranges = channel_ranges(solution)
    if solution.verification:
        for name, cell in ranges.items():
            bar = solution.errors.get(name, UNKNOWN)
            cell |= {"error": bar.over_time, "min_error": bar.least, "max_error": bar.greatest}
            if name in solution.discretisation:
                cell["discretisation"] = solution.discretisation[name]
    return ranges


def check_as_json(scene: str, report: Report, listed: Sequence[ListedStatement] = ()) -> str:
    """Return the one-line JSON object of ``stiffmbs check --json``; for a dataset, with its statements."""
    statements = {"statements": [statement.as_dict() for statement in listed]} if listed else {}
    return json_line(report.as_dict(scene) | statements)


def json_line(content: object) -> str:
    """Return one line of JSON; NaN and infinity become null."""
    return json.dumps(_finite(content), allow_nan=False)


def _finite(content: object) -> object:
    """Replace NaN and infinity, which JSON does not have, by None."""
    match content:
        case dict():
            return {key: _finite(value) for key, value in content.items()}
        case list():
            return [_finite(value) for value in content]
        case float():
            return content if math.isfinite(content) else None
        case _:
            return content


def summary(solution: Solution, all: bool = False) -> str:
    """Return what ``stiffmbs run`` prints: loads of elements, energy balance, statistics of the solver, notes.

    Parameters
    ----------
    solution : Solution
    all : bool
        Whether to list the loads of all elements; by default the ten largest are listed.
    """
    from io import StringIO

    text = StringIO()
    _print(solution.name or "model", solution, escaping_console(file=text, width=UNBROKEN), all)
    return text.getvalue().rstrip()


def print_summary(
    scene: str, solution: Solution, results: str, console: Console | PlainConsole, all: bool = False
) -> None:
    """Print loads, energy balance, solver statistics, notes, and the file of the results."""
    line = _print(scene, solution, console, all)
    line("results", results)


@np.errstate(all="ignore")  # sums of a diverged run overflow
def _print(scene: str, solution: Solution, console: Console | PlainConsole, all: bool) -> Callable[[str, str], None]:
    """Print the summary; return the function that prints a further line of it."""
    say = partial(console.print, highlight=False, markup=False, emoji=False)  # names may contain markup

    def line(label: str, text: str) -> None:
        wrapped = wrap(text, max(console.width - INDENT, INDENT), break_on_hyphens=False, replace_whitespace=False)
        first, *others = wrapped if len(text) > console.width - INDENT else [text]
        say(label.ljust(INDENT) + "\n".join([first, *(" " * INDENT + other for other in others)]), soft_wrap=True)

    say(f"{solution.name or scene}: {solution.time[0]:g} s to {solution.time[-1]:g} s, {solution.message}")
    _print_loads(solution, console, say, all)
    for number, text in enumerate(request_lines(displayed(solution), None if all else LOADS.most)):
        line("" if number else "requests", text)
    energy, constraints = solution.channels["energy.total"], ("constraint.position", "constraint.velocity")
    line("energy", balance_words(solution.balance, float(energy[0])))
    position, velocity = (np.nanmax(solution.channels[name]) for name in constraints)
    line("constraints", f"position {position:.2g} m, velocity {velocity:.2g} m/s")
    for label, text in solver_lines(solution.solver):
        line(label, text)
    if errors := _errors(solution):
        line("errors", errors)
    for label, sentences in (("presolve", solution.presolve), ("verified", solution.verification)):
        for sentence in sentences:
            line(label, sentence)
    for number, note in enumerate(solution.notes, 1):
        line("notes" if number == 1 else "", f"{number}. {note}")
    return line


def _errors(solution: Solution) -> str:
    """Return the errors in words: those that were estimated, or for a verified run those of its bars; empty without any."""
    if solution.estimate:
        return solution.estimate.sentence
    return KnownErrors(solution).estimate().sentence if solution.verification and solution.errors else ""


def _print_loads(solution: Solution, console: Console | PlainConsole, say: Callable[[str], None], all: bool) -> None:
    n_elements = len(elements_of(solution))
    most = None if all or n_elements <= LOADS.most + 1 else LOADS.most
    heads, *rows = force_rows(displayed(solution), most)
    if rows:
        largest = "" if most is None else f"the {most} largest of {n_elements} (--all shows all), "
        say(
            f"force and torque on the first body, {largest}min .. max ({', '.join(solution.display.of(unit)[0] for unit in ('N', 'N m'))}):"
        )
        if isinstance(console, PlainConsole):
            console.print(boxed([heads, *rows]))
        else:
            console.print(rich_table(heads, *rows))
    if solution.not_unique:
        say(f"{NOT_UNIQUE} not determined by rigid bodies: one possible solution")
