"""The command ``stiffmbs``."""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ..describe.scene import Scene
from ..describe.schema import scene_schema
from ..errors import InputError, StiffmbsError
from ..jobs.load_scene import load_scene
from .bench import bench
from .cache import cache
from .process import Process
from .report import report
from .scene import (
    CHANGES,
    STOPPED_EARLY,
    changes_of,
    file_beside,
    in_file,
    refuse,
    refuse_own_input,
    solve_scene,
    solving_options,
)  # fmt: skip
from .stress import stress

if TYPE_CHECKING:
    from rich.console import Console

PROBLEMS = 1
UNBROKEN = 10_000
"""Characters of a line in files and pipes."""


@click.group(cls=Process, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="stiffmbs")
def main() -> None:
    """Stiff multibody dynamics: motion and joint forces of mechanisms described in scenes."""


@main.command(short_help="Solve a scene.")
@click.argument("scene")
@click.option(
    "-o",
    "--output",
    "output",
    type=click.Path(path_type=Path),
    help="Write every channel: .csv, .npz or .nc; to SCENE.results.npz without it and without --json.",
)
@click.option("--figure", type=click.Path(path_type=Path), help="Draw the scene's figure: .png, .svg or .pdf.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object on one line instead of the summary.")
@solving_options
@click.option(
    "--verify", is_flag=True, help="Solve again, tighter and in another way: error bars, and what is in doubt."
)
def run(scene: str, output: Path | None, figure: Path | None, as_json: bool, verify: bool, **options: Any) -> None:
    """Solve SCENE and show the range of every joint force.

    Exit status: 0 done, 1 stopped early (results up to there are kept) or a file that was asked for could not be
    written, 2 the input is wrong.
    """
    try:
        if output is not None:
            _files().check_output(output)
            refuse_own_input("-o", scene, output)
        if figure is not None:
            _drawing().check_figure(figure)
            refuse_own_input("--figure", scene, figure)
        loaded = load_scene(scene, changes_of(options))
        solution = solve_scene(scene, loaded, verify)
    except StiffmbsError as error:
        refuse(scene, error, as_json)
    results, written = _write(scene, output, as_json, solution)
    if figure is not None:
        written = _draw(scene, figure, solution, loaded, as_json) and written
    _show(scene, solution, results, as_json)
    sys.exit(0 if solution.outcome.name == "DONE" and written else STOPPED_EARLY)


def _files() -> Any:
    from ..results import files

    return files


def _drawing() -> Any:
    from ..show import figure

    return figure


def _draw(scene: str, path: Path, solution: Any, loaded: Scene, as_json: bool) -> bool:
    """Draw the figure; whether it could be written."""
    try:
        _drawing().draw(path, solution, loaded.figure)
    except StiffmbsError as error:
        refuse(scene, error, as_json)
    except OSError as error:
        click.echo(f"stiffmbs: not written: {path}: {error.strerror}", err=True)
        return False
    return True


def _write(scene: str, output: Path | None, as_json: bool, solution: Any) -> tuple[str, bool]:
    """Write the results where asked, or beside the user's work; says where they lie, and whether none that was asked for is missing."""
    path = output or file_beside(scene, ".results.npz")
    if output is None and as_json:
        return "not written", True
    try:
        _files().write(path, solution)
    except OSError as error:
        reason = f"not written: {path}: {error.strerror}"
        if output is not None:
            click.echo(f"stiffmbs: {reason}", err=True)
        return reason, output is None
    return str(path), True


def _show(scene: str, solution: Any, results: str, as_json: bool) -> None:
    from ..show import summary

    if as_json:
        click.echo(summary.as_json(scene, solution))
        return
    summary.print_summary(scene, solution, results, _console())


def _console() -> Console:
    """Standard output; lines are broken to the width of a terminal, or of COLUMNS, and nowhere else."""
    from rich.console import Console

    to_a_width = sys.stdout.isatty() or "COLUMNS" in os.environ
    return Console(width=None if to_a_width else UNBROKEN, markup=False, emoji=False)


@main.command(short_help="Degrees of freedom, redundancy.")
@click.argument("scene")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object on one line instead of sentences.")
@CHANGES
def check(scene: str, as_json: bool, changes: list[tuple[str, str]]) -> None:
    """Report SCENE's degrees of freedom, redundant equations, and reactions without a unique value.

    Exit status: 0 sound, 1 problems, 2 the input is wrong.
    """
    from ..jobs.check import check as examine

    try:
        loaded = load_scene(scene, changes)
        with in_file(scene):
            report = examine(loaded)
    except StiffmbsError as error:
        refuse(scene, error, as_json)
    if as_json:
        from ..show.summary import check_as_json

        click.echo(check_as_json(scene, report))
    else:
        click.echo(report)
    sys.exit(0 if report.sound else PROBLEMS)


@main.command(short_help="Write a dataset, or a planar scene, anew.")
@click.argument("scene")
@click.option(
    "-o", "--output", "output", type=click.Path(path_type=Path), help="The scene file; standard output without."
)
@click.option("--in-space", is_flag=True, help="Take a planar SCENE, and write it in the x-y plane of space.")
@CHANGES
def convert(scene: str, output: Path | None, in_space: bool, changes: list[tuple[str, str]]) -> None:
    """Write the scene that an Adams/Solver dataset (.adm) is run as, or a planar scene in space.

    Exit status: 0 done, 1 the file could not be written, 2 the input is wrong.
    """
    try:
        if output is not None:
            refuse_own_input("-o", scene, output)
        text = _in_space(scene, changes) if in_space else _of_dataset(scene, changes)
    except StiffmbsError as error:
        refuse(scene, error)
    if output is None:
        click.echo(text, nl=False)
        return
    try:
        _files().written_whole(output, lambda part: part.write_text(text, encoding="utf-8"))
    except OSError as error:
        click.echo(f"stiffmbs: not written: {output}: {error.strerror}", err=True)
        sys.exit(STOPPED_EARLY)


def _in_space(scene: str, changes: list[tuple[str, str]]) -> str:
    from ..jobs.in_space import text_in_space

    return text_in_space(scene, changes)


def _of_dataset(dataset: str, changes: list[tuple[str, str]]) -> str:
    from ..adams.load import convert_file

    if changes:
        raise InputError(f"{dataset}: found --set, expected it with --in-space alone")
    if Path(dataset).suffix in (".yaml", ".yml"):
        raise InputError(f"{dataset}: found a scene, expected an Adams/Solver dataset (.adm), or --in-space")
    return convert_file(dataset)


@main.command()
def schema() -> None:
    """Print the JSON schema of scene files."""
    click.echo(json.dumps(scene_schema(), indent=2))


main.add_command(bench)
main.add_command(cache)
main.add_command(report)
main.add_command(stress)
