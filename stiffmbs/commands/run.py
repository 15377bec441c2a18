"""The command ``stiffmbs run``."""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ..analyses.load_scene import load_scene
from ..results.verification_words import INTERRUPTED
from .process import Status
from .scene import (
    changes_of,
    file_beside,
    is_written,
    option,
    output_option,
    refuse_file,
    refusing,
    solve_scene,
    solving_options,
    start_of,
    state_options,
)

if TYPE_CHECKING:
    from rich.console import Console

    from ..results.solution import Solution
    from ..show.plain import PlainConsole

READ_BY_RICH = "COLUMNS", "FORCE_COLOR", "TTY_COMPATIBLE", "TTY_INTERACTIVE", "JUPYTER_COLUMNS"
"""Environment variables that change what rich writes to files and pipes."""


@click.command(short_help="Solve a scene.")
@click.argument("scene")
@output_option(
    "Write every channel: .csv, .npz, .nc, .mat, .xlsx, .parquet, .tab or .res; by default SCENE.results.npz, or no file with --json."
)
@option("--figure PATH", "Draw the scene's figure: .png, .svg or .pdf.")
@option("--json", "Print one JSON object on one line instead of the summary.", "as_json")
@option("--all", "List the loads of all elements, not only the ten largest.", "all_loads")
@state_options
@solving_options
@option("--errors", "Estimate the errors of all channels, for runs of any length.")
@option("--accuracy TEXT", "Accuracy to reach, by the choice of rtol: forces=1%,positions=0.1mm.")
@option("--verify", "Rerun at a smaller tolerance and with another integrator: error bars, and warnings.")
def run(
    scene: str, output: Path | None, figure: Path | None, as_json: bool, all_loads: bool, errors: bool, accuracy: str | None,
    verify: bool, state: str | None, at: float | None, **options: object,
) -> None:  # fmt: skip
    """Solve SCENE and show the range of every joint force.

    Exit status: 0 done, 1 stopped early (results up to there are kept) or a requested file could not be written, 2 the
    input is wrong.
    """
    from .progress import ProgressBar

    with refusing(scene, as_json):
        refuse_file("-o", output, scene, "results")
        refuse_file("--figure", figure, scene, "figure")
        changes = [*changes_of(options), *_about_errors(errors, accuracy)]
        with ProgressBar(0.0, 0.0):
            loaded = load_scene(scene, changes)
        solution = solve_scene(scene, loaded, verify, **start_of(loaded, state, at, changes))
    results, written = _write(scene, output, as_json, solution)
    if figure is not None:
        from ..show.figure import drawn
        from ..show.style import write_sheet

        with refusing(scene, as_json):
            sheet = drawn(solution, loaded.figure)
            written = is_written(figure, lambda path: write_sheet(path, sheet, origin=solution.provenance)) and written
    from ..show import summary

    if as_json:
        click.echo(summary.as_json(scene, solution))
    else:
        summary.print_summary(scene, solution, results, _console_for(solution), all_loads)
    unverified = INTERRUPTED in solution.verification
    sys.exit(0 if solution.outcome.name == "DONE" and written and not unverified else Status.FAILED)


def _about_errors(errors: bool, accuracy: str | None) -> list[tuple[str, str]]:
    """Return the changes of a scene for the options on errors."""
    found = [("run.errors", "true")] if errors else []
    if accuracy is not None:
        from ..model.accuracy import from_option

        found += [("run.accuracy", json.dumps(from_option(accuracy)))]
    return found


def _write(scene: str, output: Path | None, as_json: bool, solution: Solution) -> tuple[str, bool]:
    """Write the results to the requested or default file; return where, and False if a requested file is missing."""
    from ..results.files import write

    path = output or file_beside(scene, ".results.npz")
    if output is None and as_json:
        return "not written", True
    try:
        write(path, solution)
    except OSError as error:
        reason = f"not written: {path}: {error.strerror}"
        if output is not None:
            click.echo(f"stiffmbs: {reason}", err=True)
        return reason, output is None
    return str(path), True


def _console_for(solution: Solution) -> Console | PlainConsole:
    """Return a console without rich for files and pipes in Unicode, if rich would neither colour nor measure characters."""
    from ..show.plain import PlainConsole
    from ..show.summary import UNBROKEN

    encoding = str(getattr(sys.stdout, "encoding", "")).lower()
    of_rich = sys.stdout.isatty() or not encoding.startswith("utf") or not os.environ.keys().isdisjoint(READ_BY_RICH)
    return console() if of_rich or not "".join(solution.channels).isascii() else PlainConsole(sys.stdout, UNBROKEN)


def console() -> Console:
    """Return a console for standard output; lines are broken only at the width of a terminal or of COLUMNS."""
    from ..show.escaped import console as escaping_console
    from ..show.summary import UNBROKEN

    to_a_width = sys.stdout.isatty() or "COLUMNS" in os.environ
    return escaping_console(width=None if to_a_width else UNBROKEN)
