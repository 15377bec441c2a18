"""The command ``stiffmbs flexible``."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import click

from ...errors import InputError
from ..process import Status
from ..scene import CHANGES, is_written, refusing


@click.command(short_help="Reduction of a flexible body.")
@click.argument("body")
@click.option("--hold", "held", multiple=True, metavar="NAME,...", help="Frequencies with these interfaces held too.")
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    help="Write the nodes and the mode shapes for ParaView: .vtu.",
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object on one line instead of text.")
@CHANGES
def flexible(
    body: str, held: tuple[str, ...], output: Path | None, as_json: bool, changes: list[tuple[str, str]]
) -> None:
    """Reduce a flexible BODY, described in a YAML file, and report mass, frequencies and quality of the reduction.

    BODY has mesh and material, or matrices, and units, interfaces and modes.

    Exit status: 0 done, 1 a file could not be written, 2 the input is wrong.
    """
    from ...flexible_bodies.read import read_flexible_body
    from ...flexible_bodies.reduced import reduced_body
    from ...show.flexible_body import flexible_body_as_dict, flexible_body_text

    with refusing(body, as_json):
        described = read_flexible_body(body, changes)
        names, folder = list(described.interfaces), Path(body).parent
        sets = {text: [_number(name, names) for name in text.split(",")] for text in held}
        try:
            found = reduced_body(described, folder)
        except InputError as error:
            raise InputError(f"{body}: {error}") from None
        frequencies = {f"{text} held": found.held_frequencies(numbers) for text, numbers in sets.items()}
        if output is not None:
            from ...flexible_bodies.shapes import check_shapes_file

            check_shapes_file(output)
    written = True
    if output is not None:
        from ...flexible_bodies.shapes import write_shapes

        written = is_written(output, lambda: write_shapes(output, described.model(folder), found))
    click.echo(
        json.dumps(flexible_body_as_dict(body, found, names, frequencies))
        if as_json
        else flexible_body_text(body, found, names, frequencies)
    )
    sys.exit(Status.DONE if written else Status.FAILED)


def _number(name: str, names: list[str]) -> int:
    if name.strip() not in names:
        raise InputError(
            f"--hold {name.strip()}: found no such interface, expected one of {', '.join(names) or 'none'}"
        )
    return names.index(name.strip())
