"""The command ``stiffmbs schema``."""

from __future__ import annotations

import json

import click

from ..describe.schema import scene_schema


@click.command()
def schema() -> None:
    """Print the JSON schema of scene files."""
    click.echo(json.dumps(scene_schema(), indent=2))
