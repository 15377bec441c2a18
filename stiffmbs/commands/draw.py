"""The command ``stiffmbs draw``."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import click

from ..analyses.load_scene import load_scene
from .scene import changes_of, file_beside, in_file, output_option, refuse_own_input, refusing, solving_options


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
