"""The command ``stiffmbs init``."""

from __future__ import annotations

import os
from pathlib import Path

import click

from ...errors import InputError
from ..scene import refusing

FIRST_SCENE = Path(__file__).with_name("first_scene.yaml")


@click.command(short_help="Write a first scene, with comments.")
@click.argument("file", type=click.Path(path_type=Path), default=Path("scene.yaml"))
def init(file: Path) -> None:
    """Write a first scene with comments to FILE, scene.yaml by default; an existing file is not overwritten."""
    from ...results.files import write_text

    with refusing(str(file), output=file):
        if os.path.lexists(file):
            raise InputError(f"{file}: found a file, expected a name that is not taken")
        write_text(file, FIRST_SCENE.read_text(encoding="utf-8"))
    click.echo(f"wrote {file}; next: stiffmbs check {file}, stiffmbs run {file}")
