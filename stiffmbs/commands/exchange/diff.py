"""The command ``stiffmbs diff``."""

from __future__ import annotations

import sys

import click

from ...errors import InputError
from ...reading.files.files_read import content_of
from ..process import Status
from ..scene import refusing


@click.command(short_help="Results beside another program's listing.")
@click.argument("results")
@click.argument("listing")
@click.option(
    "--map",
    "mapped",
    multiple=True,
    metavar="CHANNEL=COLUMN[*FACTOR]",
    help="A channel and the column that it is compared with, by name or number (1 is time), times a factor; or a file of such lines.",
)
@click.option(
    "--tolerance",
    type=float,
    default=1e-3,
    show_default=True,
    help="Largest relative difference that is no difference.",
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object on one line.")
def diff(results: str, listing: str, mapped: tuple[str, ...], tolerance: float, as_json: bool) -> None:
    """Compare RESULTS (.npz, .nc, .csv) with LISTING: a table as text, Adams' .res in XML, or results of another run.

    Differences are the largest over time, relative to the largest value of the column.

    Exit status: 0 all within the tolerance, 1 some are not, 2 the input is wrong.
    """
    from ...results.listings.differences import differences

    with refusing(results, as_json):
        found = differences(results, listing, _pairs(mapped))
    far = [one for one in found if not one.relative <= tolerance]
    if as_json:
        from ...show.summary import json_line

        told = {"results": results, "listing": listing, "tolerance": tolerance, "within": not far}
        click.echo(json_line({**told, "differences": [one.as_dict() for one in found]}))
    else:
        for one in found:
            mark = "  more than the tolerance" if one in far else ""
            click.echo(
                f"{one.channel} - {one.column}: {one.largest:.3g} at t = {one.t:.6g} s, relative {one.relative:.2e}{mark}"
            )
        click.echo(f"{len(found) - len(far)} of {len(found)} channels are within {tolerance:g}")
    sys.exit(Status.FAILED if far else Status.DONE)


def _pairs(mapped: tuple[str, ...]) -> dict[str, str]:
    lines = [line for text in mapped for line in _lines(text)]
    pairs = {}
    for line in lines:
        channel, equals, column = (part.strip() for part in line.partition("="))
        if not equals or not channel or not column:
            raise InputError(f"--map: found '{line}', expected CHANNEL=COLUMN")
        pairs[channel] = column
    return pairs


def _lines(text: str) -> list[str]:
    """Return the lines of a file, or of a text with an assignment."""
    if "=" in text:
        return [text]
    try:
        content = content_of(text).decode()
    except (OSError, ValueError):
        raise InputError(f"--map {text}: found no such file, expected one, or CHANNEL=COLUMN") from None
    return [line for line in content.splitlines() if line.strip() and not line.lstrip().startswith("#")]
