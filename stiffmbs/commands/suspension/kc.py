"""The command ``stiffmbs kc``."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import click

from ...analyses.load_scene import load_scene
from ...errors import InputError
from ..process import Status
from ..scene import CHANGES, in_file, is_written, output_option, refusing


@click.command(short_help="Kinematics and compliance of an axle.")
@click.argument("scene")
@click.option("--axle", default="front", show_default=True, help="What stands before .left and .right; '' for nothing.")
@click.option("--points", type=int, default=11, show_default=True, help="Of each curve: odd, 5 or more.")
@click.option("--body", help="The body to clamp; chassis, or the one that carries the axle, by default.")
@click.option("--steering", help="The prismatic or revolute joint that steers; the axle's guide by default.")
@click.option(
    "--wheel", "wheels", multiple=True, metavar="BODY", help="The body of a wheel, once or twice, in any scene."
)
@click.option("--radius", type=float, help="From the wheels' centres to the road, m; the tyres' radius by default.")
@click.option("--wheelbase", type=float, help="m; from the scene by default.")
@click.option("--cg-height", type=float, help="Height of the centre of mass, m; from the scene by default.")
@click.option("--brake-share", type=float, help="Of this axle, 0 to 1; 0.6 in front and 0.4 behind by default.")
@click.option("--drive-share", type=float, help="Of this axle, 0 to 1; 1 by default.")
@click.option("--inboard-brakes", is_flag=True, help="Brakes are on the body.")
@click.option(
    "--outboard-drive/--inboard-drive",
    default=None,
    help="Whether the carriers react the driving torque; a solid axle does.",
)
@click.option("--case", "cases", multiple=True, metavar="NAME=SIZE", help="How far a load case goes; 0 leaves it out.")
@click.option("--figure", type=click.Path(path_type=Path), help="Draw the curves: .png, .svg or .pdf.")
@output_option("Write the curves: .csv.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object on one line instead of a table.")
@CHANGES
def kc(
    scene: str, axle: str, points: int, body: str | None, steering: str | None, wheels: tuple[str, ...],
    radius: float | None, cases: tuple[str, ...], figure: Path | None, output: Path | None, as_json: bool,
    changes: list[tuple[str, str]], **vehicle: Any,
) -> None:  # fmt: skip
    """Sweep an axle of SCENE on a test rig by equilibria, and print its kinematics and compliance.

    Toe, camber, caster, kingpin, scrub radius, trail, roll centre, wheel and roll rates, anti-dive, Ackermann, swing arms
    and compliance matrices follow from the motion of any suspension; cases that do not apply are left out.

    Load cases with their default sizes: bump=50 and roll=30 (mm), steer=30 (mm of the rack), lateral=2,
    lateral_parallel=2, brake=2 and traction=2 (kN), aligning=100 and aligning_parallel=100 (N m).  The suspensions have
    a body upright with the markers spindle and patch, as shipped parts have, or tyres on wheels with a revolute joint.

    Exit status: 0 done, 1 no equilibrium was found or a file could not be written, 2 the input is wrong.
    """
    from ...results.files import write_text
    from ...show.figure import check_figure
    from ...show.suspension import draw_kc, kc_csv, kc_text
    from ...studies.suspension.kinematics_and_compliance import kinematics_and_compliance
    from ...studies.suspension.vehicle import VehicleOptions

    with refusing(scene, as_json):
        if figure is not None:
            check_figure("--figure", figure)
        loaded = load_scene(scene, changes)
        with in_file(scene):
            given = VehicleOptions(**vehicle)
            found = kinematics_and_compliance(
                loaded, axle, points, body, steering, wheels, radius, given, **_sizes(cases)
            )
    written = output is None or is_written(output, lambda: write_text(output, kc_csv(found)))
    if figure is not None:
        written = is_written(figure, lambda: draw_kc(figure, found)) and written
    click.echo(json.dumps(found.as_dict(scene)) if as_json else kc_text(scene, found))
    sys.exit(0 if written else Status.FAILED)


def _sizes(cases: tuple[str, ...]) -> dict[str, float]:
    sizes = {}
    for text in cases:
        name, _, size = text.partition("=")
        try:
            sizes[name.strip()] = float(size)
        except ValueError:
            raise InputError(f"--case {text}: found no number, expected NAME=SIZE such as bump=40") from None
    return sizes
