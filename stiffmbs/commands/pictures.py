"""The commands ``stiffmbs draw`` and ``stiffmbs animate``."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import click

from ..analyses.load_scene import load_scene
from .process import Status
from .runs import loaded_runs
from .scene import (
    changes_of,
    file_beside,
    in_file,
    output_option,
    refuse_own_input,
    refusing,
    solve_scene,
    solving_options,
)


@click.command(short_help="A picture of a mechanism.")
@click.argument("scene")
@output_option("Where to draw: .svg, .png, .pdf, or .json; SCENE.svg without it.")
@click.option("--at", type=float, help="The instant of the run, s; its start by default.")
@click.option("--described", is_flag=True, help="The bodies as they are described, before assembly, without forces.")
@click.option("--check", "checked", is_flag=True, help="Show what is redundant or not unique in colors of its own.")
@click.option(
    "--view", default="", help="front, side, top, isometric, a plane such as xz, or AZIMUTH,ELEVATION in degrees."
)
@click.option("--names/--no-names", default=True, show_default=True, help="Whether names are written.")
@click.option(
    "--forces/--no-forces", default=None, help="Whether forces are drawn, to scale; by default in the plane alone."
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object on one line on what was drawn.")
@solving_options
def draw(
    scene: str, output: Path | None, at: float | None, described: bool, checked: bool, view: str, names: bool, forces: bool | None,
    as_json: bool, **options: Any,
) -> None:  # fmt: skip
    """Draw SCENE at an instant: bodies, joints, forces and ground by their symbols, force arrows in the plane to scale.

    Exit status: 0 done, 1 no such state is found, or the file could not be written, 2 the input is wrong.
    """
    from ..show.drawing.draw import check_drawing, state_drawn, summary, write_drawing
    from ..show.drawing.view import check_view

    path = output or file_beside(scene, ".svg")
    with refusing(scene, as_json, path):
        check_drawing(path)
        check_view(view)
        refuse_own_input("-o", scene, path)
        loaded = load_scene(scene, changes_of(options))
        with in_file(scene):
            drawing, poses = state_drawn(loaded, at, described, checked)
        write_drawing(path, drawing, poses, view, names, forces)
    if as_json:
        click.echo(json.dumps({"scene": scene, "output": str(path), **summary(drawing, poses)}))
    else:
        click.echo(f"drawing: {path}")


@click.command(short_help="A mechanism in motion: a film or a page.")
@click.argument("scene")
@click.argument("results", nargs=-1, type=click.Path(path_type=Path))
@output_option("Where to write: .gif, .mp4 or .html; SCENE.html without it.")
@click.option(
    "--view", default="", help="front, side, top, isometric, a plane such as xz, or AZIMUTH,ELEVATION in degrees."
)
@click.option(
    "--speed", type=float, default=1.0, show_default=True, help="Seconds of the model in one second of a film."
)
@click.option("--rate", type=float, default=25.0, show_default=True, help="Pictures in one second of a film.")
@click.option(
    "--trace",
    "traces",
    multiple=True,
    help="A marker, such as coupler.tip, or a body whose path is drawn; any number of times.",
)
@click.option("--names/--no-names", default=False, show_default=True, help="Whether a film shows names.")
@click.option(
    "--forces/--no-forces", default=None, help="Whether a film shows forces, to scale; by default in the plane alone."
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object on one line on what was written.")
@solving_options
def animate(
    scene: str, results: tuple[Path, ...], output: Path | None, view: str, speed: float, rate: float, traces: tuple[str, ...],
    names: bool, forces: bool | None, as_json: bool, **options: Any,
) -> None:  # fmt: skip
    """Animate SCENE: its run, or RESULTS (.npz) of runs and of mode shapes, drawn over each other.

    Exit status: 0 done, 1 stopped early (the part that was solved is shown) or not written, 2 the input is wrong.
    """
    from ..show.drawing.animate import check_animation, check_pace, traced, write_animation
    from ..show.drawing.film import Pace
    from ..show.drawing.picture import Shown
    from ..show.drawing.view import check_view

    path, pace = output or file_beside(scene, ".html"), Pace(speed, rate)
    with refusing(scene, as_json, path):
        check_animation(path)
        check_pace(pace)
        check_view(view)
        for read in (scene, *map(str, results)):
            refuse_own_input("-o", read, path)
        loaded = load_scene(scene, changes_of(options))
        traced(loaded, traces)
        runs = loaded_runs(results) if results else {"": solve_scene(scene, loaded, False)}
        write_animation(path, loaded, runs, view, pace, Shown(names, forces), traces)
    first = next(iter(runs.values()))
    told = {
        "scene": scene,
        "output": str(path),
        "runs": list(runs),
        "time": {"start": float(first.time[0]), "end": float(first.time[-1])},
    }
    click.echo(json.dumps(told) if as_json else f"animation: {path}")
    sys.exit(0 if all(run.outcome.name == "DONE" for run in runs.values()) else Status.FAILED)
