"""The command ``stiffmbs handling``."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import click

from ...analyses.load_scene import load_scene
from ..process import Status
from ..scene import CHANGES, in_file, is_written, output_option, pairs, refuse_own_input, refusing


@click.command(short_help="Handling and ride tests of the standards on a car.")
@click.argument("scene")
@click.option(
    "--test", "tests", multiple=True, metavar="NAME", help="One of the tests; any number of times, all by default."
)
@click.option("--body", help="The sprung body; that of the section vehicle, or chassis, by default.")
@click.option("--steering", help="The joint that steers; steering_wheel or the only one named guide by default.")
@click.option("--width", type=float, help="Width of the vehicle, m; the track and 0.2 m by default.")
@click.option("--workers", type=click.IntRange(1), help="Number of processes; one for each core by default.")
@click.option(
    "--set-test",
    "parameters",
    multiple=True,
    callback=pairs,
    metavar="NAME=VALUE",
    help="Change a parameter of a test, such as step_steer.speed='100 km/h', or of each test that has it, speed=30; any number of times.",
)
@output_option("Write a page: .html.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object on one line instead of a table.")
@CHANGES
def handling(
    scene: str, tests: tuple[str, ...], body: str | None, steering: str | None, width: float | None,
    workers: int | None, parameters: list[tuple[str, str]], output: Path | None, as_json: bool, changes: list[tuple[str, str]],
) -> None:  # fmt: skip
    """Drive the car of SCENE through tests of the standards, and print their metrics.

    Tests: constant_speed and constant_radius (ISO 4138), step_steer and frequency_response (ISO 7401), sine_with_dwell
    (ISO 19365), lane_change (ISO 3888-1), obstacle_avoidance (ISO 3888-2), braking_in_a_turn (ISO 7975), straight_braking
    (ISO 21994), ride (ISO 2631-1). The scene's own driver, roads and start are left out.

    Exit status: 0 done, 1 a test was not done or the page could not be written, 2 the input is wrong.
    """
    from ...show.handling import handling_text, write_handling
    from ...show.report import check_report
    from ...studies.handling.study import handling as handled

    with refusing(scene, as_json):
        if output is not None:
            check_report(output)
            refuse_own_input("-o", scene, output)
        loaded = load_scene(scene, changes)
        with in_file(scene):
            found = handled(
                loaded,
                tests or None,
                body=body,
                steering=steering,
                width=width,
                workers=workers,
                parameters=dict(parameters),
            )
    written = output is None or is_written(output, lambda: write_handling(output, found))
    told = found.as_dict(scene)
    click.echo(json.dumps(told) if as_json else handling_text(scene, found))
    sys.exit(0 if written and told["status"] == "done" else Status.FAILED)
