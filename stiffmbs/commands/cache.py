"""The command ``stiffmbs cache``."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import click

WORDS = {
    "record": "derived kinds",
    "kernel": "kernels",
    "routine": "routines",
    "draft": "drafts of kernels and routines",
    "object": "kernels and routines for FMUs",
    "file": "contents of YAML files",
    "scene": "scenes read before",
    "start": "starts of runs",
    "body": "reduced flexible bodies",
    "other": "of earlier versions, or unfinished",
}


@click.group()
def cache() -> None:
    """Show, clear or fill the cache of compiled equations.

    It is in the user's cache directory, or in the directory named by the variable STIFFMBS_CACHE, and can be removed at
    any time.
    """


@cache.command()
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object on one line.")
def show(as_json: bool) -> None:
    """Show the directory of the cache and its content."""
    from ..cache.contents import stored
    from ..cache.entries import DIRECTORY_VARIABLE, cache_directory

    found = stored(cache_directory())
    if as_json:
        kinds = {kind: {"entries": own.entries, "bytes": own.size} for kind, own in found.items()}
        click.echo(json.dumps({"directory": str(cache_directory()), **kinds}))
        return
    click.echo(f"{cache_directory()}  (chosen by {DIRECTORY_VARIABLE}, or the user's cache directory)")
    for kind, own in found.items():
        click.echo(f"  {WORDS[kind]:30} {own.entries:6} entries {own.size / 1e6:9.2f} MB")


@cache.command()
def clear() -> None:
    """Remove all entries; the next runs compile again."""
    from ..cache.contents import clear as cleared
    from ..cache.entries import cache_directory

    try:
        removed = cleared(cache_directory())
    except OSError as error:
        click.echo(f"stiffmbs: {cache_directory()}: {error.strerror}", err=True)
        sys.exit(1)
    click.echo(f"removed {removed.entries} entries, {removed.size / 1e6:.2f} MB, from {cache_directory()}")


@cache.command(short_help="Compile all solvers, usual elements, and scenes in advance.")
@click.argument("scenes", metavar="[SCENE]...", nargs=-1, type=click.Path(exists=True, dir_okay=False, path_type=Path))
def warm(scenes: tuple[Path, ...]) -> None:
    """Compile all solvers, all elements in their usual forms, and SCENEs with all their options, to shorten first runs.

    Without SCENE the examples are compiled, which use most shipped parts.

    Exit status: 0 done, 1 nothing can be stored, 2 a scene cannot be assembled.
    """
    from ..analyses.warm import warm as fill
    from ..cache.contents import stored
    from ..cache.entries import cache_directory
    from .progress import StatusLine
    from .starting import scene_files

    with StatusLine() as status:
        faults = fill(
            scenes or tuple(scene_files().values()), lambda done, total: status(f"{done} of {total} compiled")
        )
    own = [found for kind, found in stored(cache_directory()).items() if kind in ("record", "kernel", "routine")]
    if not any(found.entries for found in own):
        click.echo(f"stiffmbs: {cache_directory()} cannot be written to: nothing is kept", err=True)
        sys.exit(1)
    click.echo(
        f"{sum(found.entries for found in own)} entries, {sum(found.size for found in own) / 1e6:.2f} MB, in {cache_directory()}"
    )
    for fault in faults if scenes else ():
        click.echo(f"stiffmbs: {fault}", err=True)
    if scenes and faults:
        sys.exit(2)
