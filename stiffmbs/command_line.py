"""The command ``stiffmbs``."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any, NoReturn

import click

from .describe.scene import Scene, load_scene, scene_schema
from .errors import StiffmbsError

WRONG_INPUT, STOPPED_EARLY, PROBLEMS = 2, 1, 1


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="stiffmbs")
def main() -> None:
    """Stiff multibody dynamics: motion and joint forces of mechanisms described in scenes."""


def _settings(_: click.Context, __: click.Parameter, values: tuple[str, ...]) -> list[tuple[str, str]]:
    pairs = []
    for value in values:
        path, equals, text = value.partition("=")
        if not equals or not path:
            raise click.BadParameter(f"found '{value}', expected PATH=VALUE such as bodies.cart.mass=12")
        pairs.append((path.strip(), text))
    return pairs


@main.command()
@click.argument("scene")
@click.option(
    "-o", "--output", "output", type=click.Path(path_type=Path), help="Write every channel: .csv, .npz or .nc."
)
@click.option("--figure", type=click.Path(path_type=Path), help="Draw the scene's figure: .png, .svg or .pdf.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object on one line instead of the summary.")
@click.option("--rtol", help="Relative tolerance of bdf and the adaptive schemes.")
@click.option("--duration", help="Time to solve, s.")
@click.option("--solver", help="bdf, projected, kinematic or auto.")
@click.option(
    "--set", "changes", multiple=True, callback=_settings, metavar="PATH=VALUE", help="Change a value of the scene."
)
def run(
    scene: str, output: Path | None, figure: Path | None, as_json: bool, rtol: str | None, duration: str | None, solver: str | None,
    changes: list[tuple[str, str]],
) -> None:  # fmt: skip
    """Solve SCENE and show the range of every joint force.

    Exit status: 0 done, 1 stopped early (results up to there are kept), 2 the input is wrong.
    """
    options = {"run.rtol": rtol, "run.duration": duration, "run.solver": solver}
    changes = changes + [(path, value) for path, value in options.items() if value is not None]
    try:
        if output is not None:
            _files().check_output(output)
        if figure is not None:
            _drawing().check_figure(figure)
        loaded = load_scene(scene, changes)
        solution = _solved(scene, loaded)
    except StiffmbsError as error:
        _refuse(scene, error, as_json)
    results = _write(scene, output, as_json, solution)
    if figure is not None:
        _draw(scene, figure, solution, loaded, as_json)
    _show(scene, solution, results, as_json)
    sys.exit(0 if solution.outcome.name == "DONE" else STOPPED_EARLY)


def _files() -> Any:
    from .show import files

    return files


def _drawing() -> Any:
    from .show import figure

    return figure


def _draw(scene: str, path: Path, solution: Any, loaded: Scene, as_json: bool) -> None:
    try:
        _drawing().draw(path, solution, loaded.figure)
    except StiffmbsError as error:
        _refuse(scene, error, as_json)


def _solved(path: str, scene: Scene) -> Any:
    from .errors import AssemblyError
    from .show.progress import ProgressBar
    from .show.run import run as solve

    start = scene.run.start
    try:
        with ProgressBar(start, start + scene.run.duration) as progress:
            return solve(scene, watch=progress)
    except AssemblyError as error:
        raise AssemblyError(f"{path}: {error}") from None


def _write(scene: str, output: Path | None, as_json: bool, solution: Any) -> str:
    """Write the results where asked, or beside the user's work; says where they lie."""
    path = output or Path(f"{Path(scene).stem}.results.npz")
    if output is None and as_json:
        return "not written"
    try:
        _files().write(path, solution)
    except OSError as error:
        reason = f"not written: {path}: {error.strerror}"
        if output is not None:
            click.echo(reason, err=True)
        return reason
    return str(path)


def _show(scene: str, solution: Any, results: str, as_json: bool) -> None:
    from .show import summary

    if as_json:
        click.echo(summary.as_json(scene, solution))
        return
    from rich.console import Console

    summary.print_summary(scene, solution, results, Console())


def _refuse(scene: str, error: StiffmbsError, as_json: bool) -> NoReturn:
    from .show.summary import error_as_json

    if as_json:
        click.echo(error_as_json(scene, str(error)))
    click.echo(f"stiffmbs: {error}", err=True)
    sys.exit(WRONG_INPUT)


@main.command()
@click.argument("scene")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object on one line instead of sentences.")
@click.option(
    "--set", "changes", multiple=True, callback=_settings, metavar="PATH=VALUE", help="Change a value of the scene."
)
def check(scene: str, as_json: bool, changes: list[tuple[str, str]]) -> None:
    """Report SCENE's degrees of freedom, redundant equations, and reactions without a unique value.

    Exit status: 0 sound, 1 problems, 2 the input is wrong.
    """
    from .show.check import check as examine

    try:
        report = examine(load_scene(scene, changes))
    except StiffmbsError as error:
        _refuse(scene, error, as_json)
    if as_json:
        from .show.summary import check_as_json

        click.echo(check_as_json(scene, report))
    else:
        click.echo(report)
    sys.exit(0 if report.sound else PROBLEMS)


@main.command()
def schema() -> None:
    """Print the JSON schema of scene files."""
    click.echo(json.dumps(scene_schema(), indent=2))


@main.command()
@click.argument("names", metavar="[PROBLEM]...", nargs=-1)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object a line for each problem.")
def bench(names: tuple[str, ...], as_json: bool) -> None:
    """Measure run time against error, with yardsticks beside it in the same process."""
    from .bench.measure import measure, problems, report

    known = problems()
    for name in names or known:
        if name not in known:
            click.echo(f"stiffmbs: found the problem '{name}', expected one of {', '.join(known)}", err=True)
            sys.exit(WRONG_INPUT)
        rows = measure(known[name]())
        if as_json:
            click.echo(json.dumps(report(name, rows)))
            continue
        click.echo(f"{name}: medians; error in the coordinates at the end")
        for row in rows:
            click.echo(f"  {row.solver:24} {row.setting:12} error {row.error:8.1e}  {row.seconds * 1e3:9.2f} ms")
