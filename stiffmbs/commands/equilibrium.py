"""The command ``stiffmbs equilibrium``."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ..analyses.load_scene import load_scene
from .process import Status
from .scene import (
    changes_of,
    in_file,
    is_written,
    option,
    output_option,
    refuse_file,
    refusing,
    solving_options,
    start_of,
    state_options,
)

if TYPE_CHECKING:
    from ..model.settings import SteadyMotion


@click.command(short_help="The pose in which forces balance.")
@click.argument("scene")
@output_option("Write the state, which run --from starts from: .npz, .csv or .nc.")
@option("--json", "Print one JSON object on one line instead of a table.", "as_json")
@option("--velocity TEXT", "Equilibrium at constant velocity: VX,VY or VX,VY,VZ, m/s, or with units.")
@option(
    "--rotation TEXT",
    "Equilibrium in rotation: an angular velocity, rad/s, or found; in space about the vertical, or WX,WY,WZ.",
)
@option("--about TEXT", "A point of the axis of rotation: X,Y or X,Y,Z, m; by default the origin.")
@option("--rolling BODY ...", "A further body that rolls, or spins as described")
@option(
    "--speed [given|found]",
    "Whether the forces determine the speed along --velocity.",
    type=click.Choice(["given", "found"]),
)
@state_options
@solving_options
def equilibrium(
    scene: str, output: Path | None, as_json: bool, velocity: str | None, rotation: str | None, about: str | None,
    rolling: tuple[str, ...], speed: str | None, state: str | None, at: float | None, **options: object,
) -> None:  # fmt: skip
    """Find the equilibrium of SCENE from its described pose: poses, forces, and free motions.

    It is static, or steady if a velocity or a rotation is given, with which all bodies move together.

    Exit status: 0 done, 1 no equilibrium was found or the file could not be written, 2 the input is wrong.
    """
    from ..analyses.equilibrium import equilibrium as found_equilibrium
    from ..results.files import write
    from ..show.modes import equilibrium_text

    with refusing(scene, as_json):
        refuse_file("-o", output, scene, "results")
        changes = changes_of(options)
        loaded = load_scene(scene, changes)
        start = start_of(loaded, state, at, changes)
        motion = _motion(velocity, rotation, about, rolling, speed)
        with in_file(scene):
            found = found_equilibrium(loaded, motion=motion, **start)
    written = is_written(output, lambda path: write(path, found.solution))
    click.echo(json.dumps(found.as_dict(scene)) if as_json else equilibrium_text(found, loaded))
    sys.exit(0 if written else Status.FAILED)


def _motion(
    velocity: str | None, rotation: str | None, about: str | None, rolling: tuple[str, ...], speed: str | None
) -> SteadyMotion | None:
    """Return the steady motion that options request, or None."""
    turning = _numbers(rotation)
    given: dict[str, object] = {
        "velocity": _numbers(velocity), "rotation": turning[0] if turning and len(turning) == 1 else turning,
        "about": _numbers(about), "rolling": rolling or None, "speed": speed,
    }  # fmt: skip
    given = {name: value for name, value in given.items() if value is not None}
    from ..model.settings import SteadyMotion

    return SteadyMotion(**given) if given else None


def _numbers(text: str | None) -> list[object] | None:
    """Return numbers, or texts with units, separated by commas."""
    return None if text is None else [_number(part.strip()) for part in text.split(",")]


def _number(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text
