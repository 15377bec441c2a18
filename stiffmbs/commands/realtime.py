"""The command ``stiffmbs realtime``."""

from __future__ import annotations

import sys
from typing import Any, get_args

import click

from ..analyses.load_scene import load_scene
from ..errors import InputError
from ..reading.did_you_mean import instead_of
from ..solver_names import SchemeName, SolverName
from .process import Status
from .scene import CHANGES, assigned, in_file, option, refusing
from .subcommands import is_quiet

DEFAULT, PROJECTED = "extrapolated_euler", "projected"
SOLVERS = tuple(name for name in get_args(SolverName) if name != PROJECTED)
"""Solvers in addition to the schemes of `projected`."""


@click.command(short_help="A scene in real time, with inputs and outputs.")
@click.argument("scene")
@option("--step TEXT", "Time step, s, or with a unit: 1ms; by default that of a scene with fixed steps.")
@option("--duration TEXT", "Time to solve, s, or with a unit; by default that of SCENE.")
@option("--solver NAME", f"{', '.join((*get_args(SchemeName), *SOLVERS))}.", default=DEFAULT)
@option("--channels NAME,...", "Outputs, which are read after each step.", default="")
@option(
    "--input NAME=VALUE ...", "An input in addition to those of SCENE: a parameter or a path, with its value", "inputs"
)
@option("--as-fast-as-possible", "Do not wait for the clock; with --udp, take a step for each packet.")
@option("--udp HOST:PORT", "Receive inputs and send outputs by packets, such as at 127.0.0.1:5005.", default="")
@option("--network", "Allow a HOST that other computers can reach.")
@CHANGES
@option("--json", "Print one JSON object on one line.", "as_json")
def realtime(
    scene: str, step: str | None, duration: str | None, solver: str, channels: str, inputs: tuple[str, ...],
    as_fast_as_possible: bool, udp: str, network: bool, changes: list[tuple[str, str]], as_json: bool,
) -> None:  # fmt: skip
    """Take steps of fixed length on SCENE in real time, and report their times and their accuracy.

    Steps are paced by the clock. The accuracy is the largest difference of each kind of channels from a run of SCENE
    with error control. With --udp, a packet is the time and the values, each as a little-endian float64: inputs in the
    order of SCENE and then of --input, outputs in the order of --channels. The first packet starts the steps.

    Exit status: 0 done, 1 a step failed or the command was interrupted (the report is that up to there), 2 the input is
    wrong.
    """
    from ..real_time.realtime import realtime as taken
    from ..show.summary import json_line
    from ..solve.trajectory import Outcome

    with refusing(scene, as_json):
        numbers = assigned("--input NAME=VALUE", inputs, float)
        of_run = {"run.duration": duration, "run.step": step}
        chosen = _chosen(solver)
        loaded = load_scene(scene, [*changes, *((path, text) for path, text in of_run.items() if text is not None)])
        named = [name.strip() for name in channels.split(",") if name.strip()]
        settings: dict[str, Any] = chosen if step is None else {**chosen, "step": loaded.run.step}
        with in_file(scene):
            found = taken(loaded, None, numbers, named, not as_fast_as_possible, udp, network, _tell, **settings)
    click.echo(json_line(found.as_dict(scene)) if as_json else str(found))
    if found.outcome is not Outcome.DONE:
        click.echo(f"stiffmbs: {found.message}", err=True)
    sys.exit(Status.DONE if found.outcome is Outcome.DONE else Status.FAILED)


def _chosen(solver: str) -> dict[str, str]:
    """Return the settings of a solver or of a scheme of `projected`."""
    if solver in get_args(SchemeName):
        return {"solver": PROJECTED, "scheme": solver}
    if solver not in SOLVERS:
        raise InputError(f"--solver: found '{solver}'{instead_of(solver, (*get_args(SchemeName), *SOLVERS))}")
    return {"solver": solver}


def _tell(sentence: str) -> None:
    if not is_quiet():
        click.echo(f"stiffmbs: {sentence}", err=True)
