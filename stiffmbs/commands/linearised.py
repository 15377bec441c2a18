"""Commands on a linearised scene: ``stiffmbs modes`` and ``stiffmbs response``."""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from pathlib import Path

import click

from ..analyses.load_scene import load_scene
from ..errors import InputError
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
)


@click.command(short_help="Natural frequencies and damping.")
@click.argument("scene")
@option("--from FILE", "Take the state in FILE, results of run -o or equilibrium -o.", "state")
@option(
    "--at FLOAT",
    "Time at which the state is taken, s: of FILE (by default its last row), or of the run (by default its start).",
)
@output_option(
    "Write a page with the modes in motion (.html), or one period of every mode: FILE.npz becomes FILE_1.npz, FILE_2.npz, "
    "..., results as of run -o."
)
@option(
    "--amplitude FLOAT RANGE", "Amplitude of the motion written, relative to the size of the mechanism.", default=0.1
)
@option(
    "--over NAME=VALUES",
    "Follow the modes over a parameter or any other value of SCENE: spin=0:6000 rpm:61. -o writes the diagram (.png, .svg, .pdf) or its "
    "columns (.csv).",
)
@option(
    "--order FLOAT RANGE ...",
    "With --over: list where a frequency is this multiple of the parameter, in rad/s; by default 1 if its unit is an angular velocity.",
    "orders",
)
@option("--json", "Print one JSON object on one line instead of a table.", "as_json")
@solving_options
def modes(
    scene: str, state: str | None, at: float | None, output: Path | None, amplitude: float, over: str | None, orders: tuple[float, ...],
    as_json: bool, **options: object,
) -> None:  # fmt: skip
    """Linearise SCENE about a state: frequency, damping and participation of each mode, one per degree of freedom.

    With --over these are followed over a parameter (Campbell diagram, root locus), with critical speeds and limits of stability.

    Exit status: 0 done, 1 no such state is found or a file could not be written, 2 the input is wrong.
    """
    if over:
        _modes_over(scene, over, state, at, orders or None, output, as_json, options)
        return
    from ..analyses.linearised.modes import modes as found_modes
    from ..results.files import write

    page = output is not None and output.suffix == ".html"
    with refusing(scene, as_json, output):
        if orders:
            raise InputError(f"--order {orders[0]:g}: found no --over, expected it with --over NAME=VALUES")
        if page:
            from ..show.page.modes import write_modes
        refuse_file("-o", output, scene, "modes in motion" if page else "results")
        changes = changes_of(options)
        loaded = load_scene(scene, changes)
        start = {"at": at} if state is None else start_of(loaded, state, at, changes)
        with in_file(scene):
            found = found_modes(loaded, **start)
        if output is not None and page:
            write_modes(output, found, amplitude)
        for number in range(1, len(found.modes) + 1) if output is not None and not page else ():
            assert output is not None
            write(output.with_stem(f"{output.stem}_{number}"), found.shape(number, amplitude))
    click.echo(json.dumps(found.as_dict(scene)) if as_json else found.table())


def _modes_over(
    scene: str, over: str, state: str | None, at: float | None, orders: Sequence[float] | None, output: Path | None,
    as_json: bool, options: dict[str, object],
) -> None:  # fmt: skip
    """Follow the modes of SCENE over a value, print them, and write the diagram or its columns."""
    from ..analyses.linearised.campbell import campbell
    from ..reading.variation import read_variation
    from ..results.files import write_table
    from ..results.provenance import provenance_of
    from ..show.campbell import campbell_csv
    from ..show.style import write_sheet
    from .progress import StatusLine

    changes = changes_of(options)
    with refusing(scene, as_json, output):
        if state:
            raise InputError(f"--from {state}: found it with --over, expected a state that follows from SCENE")
        refuse_file("-o", output, scene, "Campbell diagram")
        varied = read_variation(over, "--over")
        with StatusLine() as tell:
            found = campbell(scene, varied.name, varied, at=at, tell=tell, changes=changes)
    origin = provenance_of(load_scene(scene, changes), others=(f"{varied.name} is varied",))

    def write_diagram(path: Path) -> None:
        """Write the columns, or the figure."""
        if path.suffix == ".csv":
            write_table(path, campbell_csv(found), origin)
        else:
            write_sheet(path, found.plot(orders), origin=origin)

    written = is_written(output, write_diagram)
    click.echo(json.dumps(found.as_dict(scene, orders)) if as_json else found.table(orders))
    sys.exit(0 if written else Status.FAILED)


@click.command(short_help="Frequency response.")
@click.argument("scene")
@option("--input TEXT ...", "BODY.fx, BODY.MARKER.fy, ..., or a parameter of SCENE", "inputs", required=True)
@option("--output TEXT ...", "A channel or request", "outputs", required=True)
@option("--from FLOAT RANGE", "Lowest frequency, Hz.", "lowest", default=0.1)
@option("--to FLOAT RANGE", "Highest frequency, Hz.", "highest", default=100.0)
@option("--points INTEGER RANGE", "Frequencies, evenly on a logarithmic scale.", type=click.IntRange(2), default=400)
@option("--at FLOAT", "Time of the run at which the state is taken, s; by default the start.")
@option("-o, --to-file PATH", "Write gain and phase at every frequency: .csv.", "path")
@option("--json", "Print one JSON object on one line instead of a table.", "as_json")
@solving_options
def response(
    scene: str, inputs: tuple[str, ...], outputs: tuple[str, ...], lowest: float, highest: float, points: int,
    at: float | None, path: Path | None, as_json: bool, **options: object,
) -> None:  # fmt: skip
    """Linearise SCENE about a state, and show the frequency response of outputs to inputs: gain and phase.

    An input is a force or torque on a body in ground axes, or a parameter of SCENE, such as the height of a road in its
    formulas.

    Exit status: 0 done, 1 the file could not be written or no such state is found, 2 the input is wrong.
    """
    import numpy as np

    from ..analyses.linearised.inputs import force_on, parameter_of
    from ..analyses.linearised.transfer import transfer
    from ..results.files import write_table
    from ..results.provenance import provenance_of
    from ..show.modes import response_as_json, response_csv, response_text

    changes = changes_of(options)
    with refusing(scene, as_json):
        if not lowest < highest:
            raise InputError(f"--from {lowest:g} --to {highest:g}: found no range, expected --from below --to")
        refuse_file("-o", path, scene, "curves")
        loaded = load_scene(scene, changes)
        with in_file(scene):
            given = {
                name: force_on(loaded, name)
                if "." in name or name in loaded.inputs
                else parameter_of(scene, name, changes)
                for name in inputs
            }
            found = transfer(loaded, given, outputs, at=at)
            frequencies = np.geomspace(lowest, highest, points)
            values = found.response(frequencies)
    text = response_csv(found, frequencies, values)
    written = is_written(path, lambda path: write_table(path, text, provenance_of(loaded)))
    click.echo((response_as_json if as_json else response_text)(scene, found, frequencies, values))
    sys.exit(0 if written else Status.FAILED)
