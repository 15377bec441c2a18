"""The command ``stiffmbs modes``."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import click

from ..analyses.load_scene import load_scene
from .scene import changes_of, in_file, output_option, refusing, solving_options, start_of


@click.command(short_help="Natural frequencies and damping.")
@click.argument("scene")
@click.option("--from", "state", metavar="FILE", help="Take the state in FILE, results of run -o or equilibrium -o.")
@click.option(
    "--at",
    type=float,
    help="The instant whose state is taken, s: of that FILE (else its last row), or of the run (else its start).",
)
@output_option("Write one period of every mode: FILE.npz becomes FILE_1.npz, FILE_2.npz, ..., results as of run -o.")
@click.option(
    "--amplitude",
    type=click.FloatRange(0, min_open=True),
    default=0.1,
    show_default=True,
    help="Of what is written, relative to the mechanism's size.",
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object on one line instead of a table.")
@solving_options
def modes(
    scene: str, state: str | None, at: float | None, output: Path | None, amplitude: float, as_json: bool, **options: Any
) -> None:  # fmt: skip
    """Linearise SCENE about a state: frequency, damping and participation of each mode, one per degree of freedom.

    Exit status: 0 done, 1 no such state is found or a file could not be written, 2 the input is wrong.
    """
    from ..analyses.linearised.modes import modes as found_modes
    from ..results.files import check_output, write
    from ..show.modes import modes_text

    with refusing(scene, as_json, output):
        if output is not None:
            check_output(output)
        changes = changes_of(options)
        loaded = load_scene(scene, changes)
        start = {"at": at} if state is None else start_of(loaded, state, at, changes)
        with in_file(scene):
            found = found_modes(loaded, **start)
        for number in range(1, len(found.modes) + 1) if output is not None else ():
            assert output is not None
            write(output.with_stem(f"{output.stem}_{number}"), found.shape(number, amplitude))
    click.echo(json.dumps(found.as_dict(scene)) if as_json else modes_text(found))
