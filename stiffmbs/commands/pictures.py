"""The commands ``stiffmbs draw``, ``animate`` and ``plot``, and the runs that they show."""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ..analyses.load_scene import load_scene
from ..errors import InputError
from .process import Status
from .scene import (
    changes_of,
    file_beside,
    in_file,
    option,
    output_option,
    refuse_file,
    refuse_own_input,
    refusing,
    solve_scene,
    solving_options,
)

if TYPE_CHECKING:
    from ..model.scene import Figure
    from ..results.solution import Solution


RESULTS = ".npz"
"""File suffix of results."""


def loaded_runs(paths: Sequence[Path]) -> dict[str, Solution]:
    """Return runs from files of results, by distinct names."""
    from ..results.solution import Solution

    return {_name(path, paths): Solution.load(path) for path in paths}


def _name(path: Path, paths: Sequence[Path]) -> str:
    """Return the file's name without its suffixes, or its path if another file has the same name."""
    stem = path.name.removesuffix(RESULTS).removesuffix(".results")
    return stem if [other.name for other in paths].count(path.name) == 1 else str(path)


def runs_of(source: str, others: Sequence[Path], options: dict[str, object]) -> dict[str, Solution]:
    """Return the run of a scene, or of a file of results, and other runs from files; a single run has no name."""
    if source.endswith(RESULTS):
        changed = changes_of(options)
        if changed:
            raise InputError(f"{source}: found results with --{changed[0][0]}, expected a scene to solve")
        paths = [Path(source), *others]
        runs = loaded_runs(paths)
        return runs if others else {"": next(iter(runs.values()))}
    solution = solve_scene(source, load_scene(source, changes_of(options)), False)
    return {"solved": solution, **loaded_runs(others)} if others else {"": solution}


@click.command(short_help="A picture of a mechanism.")
@click.argument("scene")
@output_option("File to draw: .svg, .png, .pdf, or .json; by default SCENE.svg.")
@option("--at FLOAT", "Time of the run, s; by default the start.")
@option("--described", "Draw the bodies as described, before assembly, without forces.")
@option("--check", "Color redundant joints and reactions that are not unique.", "checked")
@option("--view TEXT", "front, side, top, isometric, a plane such as xz, or AZIMUTH,ELEVATION in degrees.", default="")
@option("--names/--no-names", "Whether names are written.", default=True)
@option("--forces/--no-forces", "Draw forces to scale; by default only for planar scenes.", default=None)
@option("--json", "Print one JSON object on one line on what was drawn.", "as_json")
@solving_options
def draw(
    scene: str, output: Path | None, at: float | None, described: bool, checked: bool, view: str, names: bool, forces: bool | None,
    as_json: bool, **options: object,
) -> None:  # fmt: skip
    """Draw SCENE at an instant: bodies, joints, forces and ground by their symbols, force arrows in the plane to scale.

    Exit status: 0 done, 1 no such state is found, or the file could not be written, 2 the input is wrong.
    """
    from ..results.provenance import provenance_of
    from ..show.drawing.draw import state_drawn, summary, write_drawing
    from ..show.drawing.view import check_view

    path = output or file_beside(scene, ".svg")
    with refusing(scene, as_json, path):
        refuse_file("-o", path, scene, "drawing")
        check_view(view)
        loaded = load_scene(scene, changes_of(options))
        with in_file(scene):
            drawing, poses = state_drawn(loaded, at, described, checked)
        write_drawing(path, drawing, poses, view, names, forces, provenance_of(loaded))
    if as_json:
        click.echo(json.dumps({"scene": scene, "output": str(path), **summary(drawing, poses)}))
    else:
        click.echo(f"drawing: {path}")


@click.command(short_help="A mechanism in motion: a film or a page.")
@click.argument("scene")
@click.argument("results", nargs=-1, type=click.Path(path_type=Path))
@output_option("File to write: .gif, .mp4 or .html; by default SCENE.html.")
@option("--view TEXT", "front, side, top, isometric, a plane such as xz, or AZIMUTH,ELEVATION in degrees.", default="")
@option(
    "--speed FLOAT", "Seconds of the model in one second of a film; by default 1, or less for a film of at least 4 s."
)
@option("--rate FLOAT", "Pictures in one second of a film.", default=25.0)
@option("--trace TEXT ...", "A marker, such as coupler.tip, or a body whose path is drawn", "traces")
@option("--names/--no-names", "Whether a film shows names.", default=False)
@option("--forces/--no-forces", "Show forces to scale in a film; by default only for planar scenes.", default=None)
@option("--json", "Print one JSON object on one line on what was written.", "as_json")
@solving_options
def animate(
    scene: str, results: tuple[Path, ...], output: Path | None, view: str, speed: float | None, rate: float, traces: tuple[str, ...],
    names: bool, forces: bool | None, as_json: bool, **options: object,
) -> None:  # fmt: skip
    """Animate SCENE: its run, or RESULTS (.npz) of runs and of mode shapes, drawn over each other.

    Exit status: 0 done, 1 stopped early (the part that was solved is shown) or not written, 2 the input is wrong.
    """
    from ..show.drawing.animate import check_animation, traced, write_animation
    from ..show.drawing.film import Playback
    from ..show.drawing.picture import Shown
    from ..show.drawing.view import check_view

    path, playback = output or file_beside(scene, ".html"), Playback(speed, rate)
    with refusing(scene, as_json, path):
        check_animation(path, playback)
        check_view(view)
        for read in (scene, *map(str, results)):
            refuse_own_input("-o", read, path)
        loaded = load_scene(scene, changes_of(options))
        traced(loaded, traces)
        runs = loaded_runs(results) if results else {"": solve_scene(scene, loaded, False)}
        write_animation(path, loaded, runs, view, playback, Shown(names, forces), traces)
    first = next(iter(runs.values()))
    printed = {
        "scene": scene,
        "output": str(path),
        "runs": list(runs),
        "time": {"start": float(first.time[0]), "end": float(first.time[-1])},
    }
    click.echo(json.dumps(printed) if as_json else f"animation: {path}")
    sys.exit(0 if all(run.outcome.name == "DONE" for run in runs.values()) else Status.FAILED)


@click.command(short_help="Plots of any channels.")
@click.argument("source", metavar="SCENE|RESULTS")
@click.argument("channels", nargs=-1)
@option("--against TEXT", "A channel, or time.", default="time")
@option("--with PATH ...", "Results (.npz) of another run, drawn over", "others")
@option("--title TEXT", "Title; by default the name of the scene.", default="")
@output_option("File to draw: .png, .svg or .pdf; by default a window.")
@option("--live", "Show the plots in a window while SCENE is solved.")
@option("--json", "Print one JSON object on one line on what was drawn.", "as_json")
@solving_options
def plot(
    source: str, channels: tuple[str, ...], against: str, others: tuple[Path, ...], title: str, output: Path | None,
    live: bool, as_json: bool, **options: object,
) -> None:  # fmt: skip
    """Plot CHANNELS of a run: of RESULTS (.npz), or of SCENE, which is solved first.  Each unit has its own plot.

    Exit status: 0 done, 1 the file could not be written, 2 the input is wrong.
    """
    from ..show.figure import check_plot, figure_of, plotted_runs
    from ..show.style import write_sheet

    with refusing(source, as_json, output):
        check_plot(output)
        if live:
            figure = _live(source, channels, against, title, others, output, options)
            _tell(source, figure, None, as_json)
            _show_window()
            return
        for path in (source, *(str(other) for other in others)):
            refuse_own_input("-o", path, output)
        runs = runs_of(source, others, options)
        figure = figure_of(runs, channels, against, title)
        sheet = plotted_runs(runs, figure, in_window=output is None)
        if output is not None:
            write_sheet(output, sheet, dpi=130, origin=next(iter(runs.values())).provenance)
    _tell(source, figure, output, as_json)
    if output is None:
        _show_window()


def _live(
    source: str, channels: tuple[str, ...], against: str, title: str, others: tuple[Path, ...], output: Path | None,
    options: dict[str, object],
) -> Figure:  # fmt: skip
    """Solve a scene and plot the solution so far in a window."""
    from ..show.figure import show_live
    from ..studies.follow import follow

    if source.endswith(RESULTS) or others or output is not None:
        wrong = "results" if source.endswith(RESULTS) else "--with" if others else "-o"
        raise InputError(f"--live: found {wrong}, expected a scene alone, which is solved in a window")
    return show_live(follow(load_scene(source, changes_of(options))), channels, against, title)


def _tell(source: str, figure: Figure, output: Path | None, as_json: bool) -> None:
    printed = {"source": source, "output": str(output or "window"), "channels": list(figure.y), "against": figure.x}
    click.echo(json.dumps(printed) if as_json else f"plot: {printed['output']}")


def _show_window() -> None:
    from matplotlib import pyplot

    pyplot.show()
