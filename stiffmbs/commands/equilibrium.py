"""The command ``stiffmbs equilibrium``."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import click

from ..errors import StiffmbsError
from ..jobs.load_scene import load_scene
from .scene import (
    STOPPED_EARLY,
    changes_of,
    in_file,
    refuse,
    refuse_own_input,
    solving_options,
    start_of,
    state_options,
)  # fmt: skip


@click.command(short_help="The pose in which forces balance.")
@click.argument("scene")
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    help="Write the state, which run --from starts from: .npz, .csv or .nc.",
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object on one line instead of a table.")
@state_options
@solving_options
def equilibrium(
    scene: str, output: Path | None, as_json: bool, state: str | None, at: float | None, **options: Any
) -> None:
    """Find the static equilibrium of SCENE from its described pose: poses, forces, and what is free to move.

    Exit status: 0 done, 1 no equilibrium was found or the file could not be written, 2 the input is wrong.
    """
    from ..jobs.equilibrium import equilibrium as found_equilibrium
    from ..results.files import check_output, write
    from ..show.equilibrium import equilibrium_text

    try:
        if output is not None:
            check_output(output)
            refuse_own_input("-o", scene, output)
        changes = changes_of(options)
        loaded = load_scene(scene, changes)
        start = start_of(loaded, state, at, changes)
        with in_file(scene):
            found = found_equilibrium(loaded, **start)
    except StiffmbsError as error:
        refuse(scene, error, as_json)
    if output is not None:
        try:
            write(output, found.solution)
        except OSError as error:
            click.echo(f"stiffmbs: not written: {output}: {error.strerror}", err=True)
            sys.exit(STOPPED_EARLY)
    click.echo(json.dumps(found.as_dict(scene)) if as_json else equilibrium_text(found, loaded))
