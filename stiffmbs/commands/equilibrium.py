"""The command ``stiffmbs equilibrium``."""

from __future__ import annotations

import json
from typing import Any

import click

from ..errors import StiffmbsError
from ..jobs.load_scene import load_scene
from .scene import changes_of, in_file, refuse, solving_options


@click.command(short_help="The pose in which forces balance.")
@click.argument("scene")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object on one line instead of a table.")
@solving_options
def equilibrium(scene: str, as_json: bool, **options: Any) -> None:
    """Find the static equilibrium of SCENE from its described pose: poses, forces, and what is free to move.

    Exit status: 0 done, 1 no equilibrium was found, 2 the input is wrong.
    """
    from ..jobs.equilibrium import equilibrium as found_equilibrium
    from ..show.equilibrium import equilibrium_text

    try:
        loaded = load_scene(scene, changes_of(options))
        with in_file(scene):
            found = found_equilibrium(loaded)
    except StiffmbsError as error:
        refuse(scene, error, as_json)
    click.echo(json.dumps(found.as_dict(scene)) if as_json else equilibrium_text(found, loaded))
