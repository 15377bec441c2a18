"""The command ``stiffmbs examples``."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import click

from ...errors import InputError
from ..run import run
from ..scene import refusing
from .shipped import examples_folder, first_words, scene_file, scene_files


@click.group(short_help="List, copy or run the examples.")
def examples() -> None:
    """List, copy or run the example scenes that are installed with stiffmbs."""


@examples.command("list", short_help="List the examples.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object on one line.")
def list_all(as_json: bool) -> None:
    """List the examples, each with its subject."""
    with refusing("examples"):
        found = {name: first_words(path) for name, path in scene_files().items()}
        folder = examples_folder()
    if as_json:
        click.echo(json.dumps({"folder": str(folder), "examples": found}))
        return
    for name, words in found.items():
        click.echo(f"{name:22} {words}")


@examples.command(short_help="Copy examples to a folder.")
@click.argument("names", nargs=-1, metavar="[NAME]...")
@click.option(
    "--to", "folder", type=click.Path(path_type=Path), default=Path("examples"), show_default=True, help="The folder."
)
def copy(names: tuple[str, ...], folder: Path) -> None:
    """Copy the examples with these NAMEs, or all of them, with the files that they read.

    Existing files are not overwritten.
    """
    with refusing("examples"):
        scenes, source = set(scene_files().values()), examples_folder()
        chosen = [scene_file(name) for name in names] or sorted(scenes)
        read_by_scenes = [path for path in sorted(source.rglob("*")) if path.is_file() and path not in scenes]
        wanted = {path: folder / path.relative_to(source) for path in [*chosen, *read_by_scenes]}
        for target in wanted.values():
            if target.exists():
                raise InputError(f"{target}: found a file, expected none: --to names another folder")
    for path, target in wanted.items():
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(path, target)
    click.echo(f"{len(wanted)} files copied to {folder}")


@examples.command("run", short_help="Run an example.", context_settings={"ignore_unknown_options": True})
@click.argument("name")
@click.argument("options", nargs=-1, type=click.UNPROCESSED)
@click.pass_context
def run_one(context: click.Context, name: str, options: tuple[str, ...]) -> None:
    """Run the example NAME; all options of ``stiffmbs run`` can follow."""
    with refusing("examples"):
        path = scene_file(name)
    with run.make_context("run", [str(path), *options], parent=context) as own:
        run.invoke(own)
