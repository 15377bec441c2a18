"""The command ``stiffmbs convert``."""

from __future__ import annotations

import sys
from functools import partial
from pathlib import Path

import click

from ..errors import InputError
from .process import Status
from .scene import CHANGES, is_written, output_option, refuse_own_input, refusing

DATASET = ".adm"


@click.command(short_help="Write a dataset, a robot, or a planar scene, as a scene; or a scene as a dataset.")
@click.argument("scene")
@output_option("The scene file, or a dataset where it ends in .adm; standard output without.")
@click.option("--in-space", is_flag=True, help="Take a planar SCENE, and write it in the x-y plane of space.")
@click.option(
    "--at",
    "coordinates",
    multiple=True,
    metavar="JOINT=VALUE",
    help="Where a hinge or slide of a robot starts, rad or m; as drawn without it.",
)
@CHANGES
def convert(
    scene: str, output: Path | None, in_space: bool, coordinates: tuple[str, ...], changes: list[tuple[str, str]]
) -> None:
    """Convert an Adams/Solver dataset (.adm) or a robot (URDF, MJCF) to a scene, or a planar scene to space.

    If OUTPUT ends in .adm, the scene is written as a dataset, with a command file (.acf) for its run next to it.

    Exit status: 0 done, 1 the file could not be written, 2 the input is wrong.
    """
    from ..analyses.in_space import text_in_space
    from ..results.files import write_text

    with refusing(scene):
        if output is not None:
            refuse_own_input("-o", scene, output)
        if output is not None and output.suffix.lower() == DATASET:
            texts = _as_dataset(scene, output, coordinates, changes)
        else:
            text = text_in_space(scene, changes) if in_space else _of_other(scene, coordinates, changes)
            texts = {output: text}
    for path, text in texts.items():
        if path is None:
            click.echo(text, nl=False)
        elif not is_written(path, partial(write_text, path, text)):
            sys.exit(Status.FAILED)


def _as_dataset(
    path: str, output: Path, coordinates: tuple[str, ...], changes: list[tuple[str, str]]
) -> dict[Path | None, str]:
    """Return a dataset and its command file, by their paths."""
    from ..adams.export.dataset_text import command_text, dataset_text
    from ..adams.load import COMMANDS
    from ..analyses.in_space import in_space
    from ..analyses.load_scene import ROBOTS, load_scene
    from ..model.spatial_scene import SpatialScene
    from ..robots.load import load_robot

    beside = output.with_suffix(COMMANDS)
    refuse_own_input("-o", path, beside)
    if coordinates and Path(path).suffix.lower() in ROBOTS:
        scene = load_robot(path, changes, coordinates=dict(map(_coordinate, coordinates)))
    else:
        scene = load_scene(path, changes)
    spatial = scene if isinstance(scene, SpatialScene) else in_space(scene)  # type: ignore[call-overload]
    return {output: dataset_text(spatial, path), beside: command_text(spatial)}


def _of_other(path: str, coordinates: tuple[str, ...], changes: list[tuple[str, str]]) -> str:
    """Return the text of a scene from a file of another program."""
    from ..adams.load import convert_file
    from ..analyses.load_scene import ROBOTS
    from ..robots.load import convert_robot

    suffix = Path(path).suffix.lower()
    if changes:
        raise InputError(f"{path}: found --set, expected it with --in-space alone")
    if suffix in ROBOTS:
        return convert_robot(path, coordinates=dict(map(_coordinate, coordinates)))
    if coordinates:
        raise InputError(f"{path}: found --at, expected it with a robot alone")
    if suffix in (".yaml", ".yml"):
        raise InputError(
            f"{path}: found a scene, expected an Adams/Solver dataset (.adm), a robot ({', '.join(ROBOTS)}), or --in-space"
        )
    return convert_file(path)


def _coordinate(text: str) -> tuple[str, float]:
    joint, _, value = text.partition("=")
    try:
        return joint.strip(), float(value)
    except ValueError:
        raise InputError(f"--at: found '{text}', expected JOINT=VALUE with a number") from None
