"""The command ``stiffmbs loads``."""

from __future__ import annotations

import json

import click

from ...analyses.load_scene import load_scene
from ...errors import InputError
from ..scene import CHANGES, in_file, refusing


@click.command(short_help="Peaks of all bushings' loads over load cases.")
@click.argument("scene")
@click.option(
    "--case", "cases", multiple=True, metavar="NAME=PATH=VALUE[,...]", help="A load case with what it changes in SCENE."
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object on one line instead of a table.")
@CHANGES
def loads(scene: str, cases: tuple[str, ...], as_json: bool, changes: list[tuple[str, str]]) -> None:
    """Run SCENE in each load case, and print the largest force and torque of every bushing in its own axes.

    --case kerb=choose.manoeuvre=bump --case fast=V=30,run.duration=5 runs two cases; by default SCENE runs as it is.

    Exit status: 0 done, 1 a run stopped early, 2 the input is wrong.
    """
    from ...analyses.run import run
    from ...show.suspension import road_loads_text
    from ...studies.suspension.road_loads import road_loads

    with refusing(scene, as_json):
        runs = {}
        for name, own in [_case(text) for text in cases] or [("run", [])]:
            loaded = load_scene(scene, [*changes, *own])
            with in_file(scene):
                runs[name] = run(loaded)
        with in_file(scene):
            found = road_loads(loaded, runs)
    stopped = {name: each.message for name, each in runs.items() if not each.success}
    told = {"scene": scene, "status": "stopped" if stopped else "done", "message": "; ".join(stopped.values())}
    click.echo(json.dumps({**told, "loads": found.as_dict()}) if as_json else road_loads_text(scene, found))
    for name, message in stopped.items():
        click.echo(f"stiffmbs: {name}: {message}", err=True)
    if stopped:
        raise SystemExit(1)


def _case(text: str) -> tuple[str, list[tuple[str, str]]]:
    name, _, rest = text.partition("=")
    changes = [tuple(change.split("=", 1)) for change in rest.split(",") if change]
    if not name or not changes or any(len(change) != 2 for change in changes):
        raise InputError(f"--case {text}: found no changes, expected NAME=PATH=VALUE")
    return name, [(path, value) for path, value in changes]  # type: ignore[misc]
