"""Commands for the exchange with other programs: datasets and robots, listings of results, FMUs."""

from __future__ import annotations

import sys
from functools import partial
from pathlib import Path
from typing import Any

import click

from ..errors import InputError
from ..notes import note_lines
from ..reading.files.files_read import content_of
from .process import Status
from .scene import CHANGES, assigned, file_beside, is_written, option, output_option, refuse_own_input, refusing

DATASET, ASSEMBLY, AT = ".adm", ".asmt", "--at JOINT=VALUE with a number"

OPTIONS_OF_ROBOTS = {
    "coordinates": "--at",
    "limits": "--limits",
    "contacts": "--contacts",
    "ground": "--ground",
    "free_root": "--free-root",
}
"""Options for robots by the arguments of `load_robot`."""


@click.command(short_help="Convert datasets, robots and assemblies to scenes, and scenes to datasets and assemblies.")
@click.argument("scene")
@output_option("Scene file, dataset if it ends in .adm, or assembly if it ends in .asmt; by default standard output.")
@option("--in-space", "Take a planar SCENE, and write it in the x-y plane of space.")
@option(
    "--at JOINT=VALUE ...",
    "Initial position of a hinge or slide of a robot, rad or m; by default as drawn",
    "coordinates",
)
@option("--limits", "Hold the joints of a robot within their limits by stops.")
@option("--contacts", "Add the contacts between shapes of a robot that its file states.")
@option("--ground HEIGHT", "Add a level ground plane, and contacts with it; height in m.", type=float)
@option("--free-root", "Let the root link of a URDF file move freely; by default it is fixed to ground.")
@CHANGES
def convert(
    scene: str, output: Path | None, in_space: bool, coordinates: tuple[str, ...], limits: bool, contacts: bool,
    ground: float | None, free_root: bool, changes: list[tuple[str, str]],
) -> None:  # fmt: skip
    """Convert an Adams/Solver dataset (.adm), a robot (URDF, SDF, MJCF) or an assembly (Simscape Multibody XML, .asmt) to a scene,
    or a planar scene to space.

    If OUTPUT ends in .adm, the scene is written as a dataset, with a command file (.acf) for its run next to it; if it ends in
    .asmt, as an assembly for FreeCAD's solver.

    Exit status: 0 done, 1 the file could not be written, 2 the input is wrong.
    """
    from ..analyses.in_space import text_in_space
    from ..results.files import write_text

    with refusing(scene):
        refuse_own_input("-o", scene, output)
        of_robot: dict[str, Any] = {"coordinates": assigned(AT, coordinates, float)} if coordinates else {}
        of_robot |= {"limits": True} if limits else {}
        of_robot |= {"contacts": True} if contacts else {}
        of_robot |= {"ground": ground} if ground is not None else {}
        of_robot |= {"free_root": True} if free_root else {}
        if of_robot and (in_space or not _is_robot(scene)):
            given = OPTIONS_OF_ROBOTS[next(iter(of_robot))]
            raise InputError(f"{scene}: found {given}, expected it with a robot alone")
        if output is not None and output.suffix.lower() in (DATASET, ASSEMBLY):
            texts = _exported(scene, output, of_robot, changes)
        else:
            text = text_in_space(scene, changes) if in_space else _of_other(scene, of_robot, changes)
            texts = {output: text}
    for path, text in texts.items():
        if path is None:
            click.echo(text, nl=False)
        elif not is_written(path, partial(write_text, text=text)):
            sys.exit(Status.FAILED)


def _is_robot(path: str) -> bool:
    from ..analyses.load_scene import ROBOTS
    from ..cad.load import is_cad

    return Path(path).suffix.lower() in ROBOTS and not is_cad(path)


def _exported(
    path: str, output: Path, of_robot: dict[str, Any], changes: list[tuple[str, str]]
) -> dict[Path | None, str]:
    """Return a dataset and its command file, or an assembly, by their paths; `of_robot`: arguments of `load_robot`."""
    from ..adams.export.dataset_text import written_dataset
    from ..adams.load import COMMANDS
    from ..analyses.in_space import in_space
    from ..analyses.load_scene import load_scene
    from ..cad.ondsel.write import written_assembly
    from ..model.spatial_scene import SpatialScene
    from ..robots.load import load_robot

    commands = output.with_suffix(COMMANDS) if output.suffix.lower() == DATASET else None
    refuse_own_input("-o", path, commands)
    scene = load_robot(path, changes, **of_robot) if of_robot else load_scene(path, changes)
    spatial = scene if isinstance(scene, SpatialScene) else in_space(scene)  # type: ignore[call-overload]
    texts: dict[Path | None, str]
    if commands is None:
        assembly = written_assembly(spatial, path)
        texts, notes = {output: assembly.text}, assembly.notes
    else:
        dataset = written_dataset(spatial, path)
        texts, notes = {output: dataset.text, commands: dataset.commands}, dataset.notes
    for line in note_lines(notes):
        click.echo(line, err=True)
    return texts


def _of_other(path: str, of_robot: dict[str, Any], changes: list[tuple[str, str]]) -> str:
    """Return the text of a scene from a file of another program; `of_robot`: arguments of `convert_robot`."""
    from ..adams.load import convert_file
    from ..analyses.load_scene import CAD, ROBOTS, refuse_others
    from ..cad.load import convert_cad, is_cad
    from ..robots.load import convert_robot

    refuse_others(path)
    suffix, found = Path(path).suffix.lower(), convert_file
    if changes:
        raise InputError(f"{path}: found --set, expected it with --in-space alone")
    if suffix in CAD and is_cad(path):
        found = convert_cad
    elif suffix in ROBOTS:
        return convert_robot(path, **of_robot)
    if suffix in (".yaml", ".yml"):
        raise InputError(
            f"{path}: found a scene, expected an Adams/Solver dataset (.adm), a robot ({', '.join(ROBOTS)}), or --in-space"
        )
    return found(path)


@click.command(short_help="Results compared with another program's listing.")
@click.argument("results")
@click.argument("listing")
@option(
    "--map CHANNEL=COLUMN[*FACTOR] ...",
    "A channel and the column that it is compared with, by name or number (1 is time), times a factor; or a file of such lines",
    "mapped",
)
@option("--tolerance FLOAT", "Largest relative difference that counts as equal.", default=1e-3)
@option("--json", "Print one JSON object on one line.", "as_json")
def diff(results: str, listing: str, mapped: tuple[str, ...], tolerance: float, as_json: bool) -> None:
    """Compare RESULTS (.npz, .nc, .csv) with LISTING: a table as text, Adams' .res in XML, FreeCAD's .asmt, or results of another run.

    Differences are the largest over time, relative to the largest value of the column.

    Exit status: 0 all within the tolerance, 1 some are not, 2 the input is wrong.
    """
    from ..results.listings import differences

    with refusing(results, as_json):
        lines = [line for text in mapped for line in _lines(text)]
        found = differences(results, listing, assigned("--map CHANNEL=COLUMN", lines, str))
    far = [one for one in found if not one.relative <= tolerance]
    if as_json:
        from ..show.summary import json_line

        printed = {"results": results, "listing": listing, "tolerance": tolerance, "within": not far}
        click.echo(json_line({**printed, "differences": [one.as_dict() for one in found]}))
    else:
        for one in found:
            mark = "  more than the tolerance" if one in far else ""
            click.echo(
                f"{one.channel} - {one.column}: {one.largest:.3g} at t = {one.t:.6g} s, relative {one.relative:.2e}{mark}"
            )
        click.echo(f"{len(found) - len(far)} of {len(found)} channels are within {tolerance:g}")
    sys.exit(Status.FAILED if far else Status.DONE)


def _lines(text: str) -> list[str]:
    """Return the lines of a file, or of a text with an assignment."""
    if "=" in text:
        return [text]
    try:
        content = content_of(text).decode()
    except (OSError, ValueError):
        raise InputError(f"--map {text}: found no such file, expected one, or CHANNEL=COLUMN") from None
    return [line for line in content.splitlines() if line.strip() and not line.lstrip().startswith("#")]


@click.command(short_help="An FMU for co-simulation, or without Python for model exchange too.")
@click.argument("scene")
@output_option("The FMU, .fmu; by default SCENE.fmu in the working folder.")
@option("--channel TEXT ...", "An output of the FMU; by default the requests of the scene, or all channels", "outputs")
@option("--native", "Write an FMU without Python: machine code for co-simulation and model exchange.")
@option("--fmi VERSION", "Version of FMI: 2.0, or 3.0 with --native.", "version", default="2.0")
@option("--json", "Print one JSON object on one line.", "as_json")
@CHANGES
def fmu(
    scene: str, output: Path | None, outputs: tuple[str, ...], native: bool, version: str, as_json: bool,
    changes: list[tuple[str, str]],
) -> None:  # fmt: skip
    """Write SCENE as an FMU (co-simulation) with its inputs, parameters and channels.

    The FMU needs this package in the Python of the program that runs it (needs the extra fmu). With --native it needs no
    Python: only parameters of forces can be changed, and it is for model exchange too (needs a C compiler or the
    extra fmu).

    Exit status: 0 done, 1 the FMU could not be written, 2 the input is wrong.
    """
    from ..show.summary import json_line
    from ..studies.fmu.build import written_fmu

    target = output or file_beside(scene, ".fmu")
    with refusing(scene, as_json):
        refuse_own_input("-o", scene, target)
        written = written_fmu(scene, target, outputs, changes, native, version)
    if as_json:
        printed = {"scene": scene, "output": str(target), "outputs": list(written.outputs)}
        click.echo(json_line(printed | ({"notes": list(map(str, written.notes))} if written.notes else {})))
        return
    click.echo(f"fmu: {target}, {len(written.outputs)} outputs")
    for line in note_lines(written.notes):
        click.echo(line, err=True)
