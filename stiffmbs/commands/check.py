"""The command ``stiffmbs check``."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ..analyses.load_scene import DATASET, load_scene
from ..errors import StiffmbsError
from .process import Status
from .scene import CHANGES, in_file, option, refusing

if TYPE_CHECKING:
    from ..adams.listing import ListedStatement


@click.command(short_help="Degrees of freedom, redundancy.")
@click.argument("scene")
@option("--json", "Print one JSON object on one line instead of sentences.", "as_json")
@CHANGES
def check(scene: str, as_json: bool, changes: list[tuple[str, str]]) -> None:
    """Report SCENE's degrees of freedom, redundant equations, and reactions without a unique value.

    For an Adams/Solver dataset every statement is listed first: read, left out, or refused, with the reason.

    Exit status: 0 sound, 1 problems, 2 the input is wrong.
    """
    from ..analyses.check import check as examine

    listed = _listed(scene)
    if not as_json:
        for statement in listed:
            click.echo(statement)
    with refusing(scene, as_json):
        loaded = load_scene(scene, changes)
        with in_file(scene):
            report = examine(loaded)
    if as_json:
        from ..show.summary import check_as_json

        click.echo(check_as_json(scene, report, listed))
    else:
        click.echo(report)
    sys.exit(Status.DONE if report.sound else Status.FAILED)


def _listed(scene: str) -> Sequence[ListedStatement]:
    """Return the statements of a dataset, or none for other or unreadable files."""
    if Path(scene).suffix.lower() != DATASET:
        return ()
    from ..adams.listing import listed_statements

    try:
        return listed_statements(scene)
    except StiffmbsError:  # reported when the scene is read
        return ()
