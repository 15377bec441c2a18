"""The command ``stiffmbs schema``."""

from __future__ import annotations

import json

import click


@click.command()
def schema() -> None:
    """Print the JSON schema of scene files."""
    from ...model.schema import scene_schema

    click.echo(json.dumps(scene_schema(), indent=2))
