"""The command ``stiffmbs draw``."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import click

from ..analyses.load_scene import load_scene
from ..errors import StiffmbsError
from .scene import STOPPED_EARLY, changes_of, file_beside, in_file, refuse, refuse_own_input, solving_options


@click.command(short_help="A picture of a mechanism.")
@click.argument("scene")
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    help="Where to draw: .svg, .png, .pdf, or .json; SCENE.svg without it.",
)
@click.option("--at", type=float, help="The instant of the run, s; its start by default.")
@click.option("--described", is_flag=True, help="The bodies as they are described, before assembly, without forces.")
@click.option("--check", "checked", is_flag=True, help="Show what is redundant or not unique in colors of its own.")
@click.option(
    "--view", default="", help="front, side, top, isometric, a plane such as xz, or AZIMUTH,ELEVATION in degrees."
)
@click.option("--names/--no-names", default=True, show_default=True, help="Whether names are written.")
@click.option("--forces/--no-forces", default=True, show_default=True, help="Whether forces are drawn, to scale.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object on one line on what was drawn.")
@solving_options
def draw(
    scene: str, output: Path | None, at: float | None, described: bool, checked: bool, view: str, names: bool, forces: bool,
    as_json: bool, **options: Any,
) -> None:  # fmt: skip
    """Draw SCENE at an instant: bodies, joints, forces and ground by their symbols, force arrows to scale.

    Exit status: 0 done, 1 no such state is found, or the file could not be written, 2 the input is wrong.
    """
    from ..show.drawing.draw import check_drawing, state_drawn, summary, write_drawing
    from ..show.drawing.view import check_view

    path = output or file_beside(scene, ".svg")
    try:
        check_drawing(path)
        check_view(view)
        refuse_own_input("-o", scene, path)
        loaded = load_scene(scene, changes_of(options))
        with in_file(scene):
            drawing, poses = state_drawn(loaded, at, described, checked)
        write_drawing(path, drawing, poses, view, names, forces)
    except StiffmbsError as error:
        refuse(scene, error, as_json)
    except OSError as error:
        click.echo(f"stiffmbs: not written: {path}: {error.strerror}", err=True)
        sys.exit(STOPPED_EARLY)
    if as_json:
        click.echo(json.dumps({"scene": scene, "output": str(path), **summary(drawing, poses)}))
    else:
        click.echo(f"drawing: {path}")
