"""The command ``stiffmbs report``."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import click

from ..describe.files.text_file import STANDARD_INPUT, file_text
from ..errors import StiffmbsError
from ..jobs.load_scene import load_scene
from .scene import (  # fmt: skip
    STOPPED_EARLY,
    changes_of,
    file_beside,
    refuse,
    refuse_own_input,
    solve_scene,
    solving_options,
)


@click.command(short_help="One page on a scene and its run.")
@click.argument("scene")
@click.option("-o", "--output", type=click.Path(path_type=Path), help="Where to write the page: .html.")
@click.option("--verify/--no-verify", default=True, show_default=True, help="Whether peaks get error bars.")
@solving_options
def report(scene: str, output: Path | None, verify: bool, **options: Any) -> None:
    """Check and solve SCENE and write one page on it: findings, settings, peaks with error bars, figures, the solver's steps.

    Exit status: 0 done, 1 stopped early (the page is written all the same), 2 the input is wrong.
    """
    from ..show.report import check_report, write_report

    path = output or file_beside(scene, ".report.html")
    try:
        check_report(path)
        refuse_own_input("-o", scene, path)
        loaded = load_scene(scene, changes_of(options))
        solution = solve_scene(scene, loaded, verify)
        write_report(path, loaded, solution, "" if scene == STANDARD_INPUT else file_text(scene))
    except StiffmbsError as error:
        refuse(scene, error)
    except OSError as error:
        click.echo(f"stiffmbs: not written: {path}: {error.strerror}", err=True)
        sys.exit(STOPPED_EARLY)
    for note in solution.notes:
        click.echo(f"note: {note}")
    click.echo(f"report: {path}")
    sys.exit(0 if solution.outcome.name == "DONE" else STOPPED_EARLY)
