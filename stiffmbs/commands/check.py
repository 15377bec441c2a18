"""The command ``stiffmbs check``."""

from __future__ import annotations

import sys

import click

from ..errors import StiffmbsError
from ..jobs.load_scene import load_scene
from .scene import CHANGES, in_file, refuse

PROBLEMS = 1


@click.command(short_help="Degrees of freedom, redundancy.")
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
