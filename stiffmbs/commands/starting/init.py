"""The command ``stiffmbs init``."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import click

from ..scene import STOPPED_EARLY, WRONG_INPUT

FIRST_SCENE = Path(__file__).with_name("first_scene.yaml")


@click.command(short_help="Write a first scene, with comments.")
@click.argument("file", type=click.Path(path_type=Path), default=Path("scene.yaml"))
def init(file: Path) -> None:
    """Write a first scene with comments to FILE, scene.yaml by default; an existing file is not overwritten."""
    from ...results.files import write_text

    try:
        if os.path.lexists(file):
            raise FileExistsError
        write_text(file, FIRST_SCENE.read_text(encoding="utf-8"))
    except FileExistsError:
        click.echo(f"stiffmbs: {file}: found a file, expected a name that is not taken", err=True)
        sys.exit(WRONG_INPUT)
    except OSError as error:
        click.echo(f"stiffmbs: not written: {file}: {error.strerror}", err=True)
        sys.exit(STOPPED_EARLY)
    click.echo(f"wrote {file}; next: stiffmbs check {file}, stiffmbs run {file}")
