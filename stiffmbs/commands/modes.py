"""The command ``stiffmbs modes``."""

from __future__ import annotations

import json
from typing import Any

import click

from ..errors import StiffmbsError
from ..jobs.load_scene import load_scene
from .scene import changes_of, in_file, refuse, solving_options, start_of


@click.command(short_help="Natural frequencies and damping.")
@click.argument("scene")
@click.option("--from", "state", metavar="FILE", help="Take the state in FILE, results of run -o or equilibrium -o.")
@click.option(
    "--at",
    type=float,
    help="The instant whose state is taken, s: of that FILE (else its last row), or of the run (else its start).",
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object on one line instead of a table.")
@solving_options
def modes(scene: str, state: str | None, at: float | None, as_json: bool, **options: Any) -> None:
    """Linearise SCENE about a state: frequency, damping and participation of each mode, as many as degrees of freedom.

    Exit status: 0 done, 1 no motion leads to such a state, 2 the input is wrong.
    """
    from ..jobs.modes import modes as found_modes
    from ..show.modes import modes_text

    try:
        changes = changes_of(options)
        loaded = load_scene(scene, changes)
        start = {"at": at} if state is None else start_of(loaded, state, at, changes)
        with in_file(scene):
            found = found_modes(loaded, **start)
    except StiffmbsError as error:
        refuse(scene, error, as_json)
    click.echo(json.dumps(found.as_dict(scene)) if as_json else modes_text(found))
