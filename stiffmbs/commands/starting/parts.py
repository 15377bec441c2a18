"""The command ``stiffmbs parts``."""

from __future__ import annotations

import json

import click

from ...reading.did_you_mean import did_you_mean


@click.command(short_help="The parts of vehicles that come with the package.")
@click.argument("name", required=False)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object on one line.")
def parts(name: str | None, as_json: bool) -> None:
    """List the parts that come with the package, or print the definition of the part NAME as a template.

    Exit status: 0 done, 2 there is no such part.
    """
    from ...model.parts.definitions import about, shipped_part, shipped_parts
    from ...reading.files.scene_text import scene_text

    if name is None:
        known = {part: about(part) for part in shipped_parts()}
        listed = "\n".join(f"{part:16} {words}" for part, words in known.items())
        click.echo(json.dumps({"parts": known}) if as_json else listed)
        return
    found = shipped_part(name)
    if found is None:
        near = did_you_mean(name, shipped_parts())
        raise click.UsageError(f"found '{name}'{near}, expected one of {', '.join(shipped_parts())}")
    click.echo(json.dumps({name: found}) if as_json else scene_text({"parts": {name: found}}), nl=as_json)
