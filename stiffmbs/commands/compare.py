"""The commands ``stiffmbs compare`` and ``stiffmbs bench``."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any, get_args

import click

from ..analyses.load_scene import load_scene
from ..errors import InputError, StiffmbsError
from ..solver_names import SchemeName
from .process import Status
from .scene import CHANGES, in_file, is_written, option, output_option, refuse_file, refusing

if TYPE_CHECKING:
    from ..comparison.compare import Comparison
    from ..comparison.comparison_over import ComparisonOver
    from ..results.provenance import Provenance

    Found = Comparison | ComparisonOver


@click.command(short_help="Solvers compared on any scene.")
@click.argument("scene")
@option(
    "--solver, --solvers NAME,...",
    f"bdf, radau, auto, kinematic, {', '.join(get_args(SchemeName))}, or all; bdf,dop853,auto by default.",
    "solvers",
)
@option("--formulation, --formulations NAME,...", "Of bdf: SI2, SI1, I3, ...", "formulations")
@option(
    "--rtol VALUES",
    "Relative tolerances, FROM:TO[:COUNT][:log] or VALUE,VALUE,...; 1e-3:1e-8:log, four per decade, by default.",
)
@option("--step VALUES", "Steps of the fixed-step schemes, s, in the forms of --rtol.")
@option("--measure TEXT", "Quantity whose errors are compared: positions, velocities or forces.", default="positions")
@option(
    "--over NAME=VALUES",
    "Time at an equal error against a parameter or a path, as in k_b=1e5:1e9:9:log, k=1:100 N/mm:5 or N=10,20.",
)
@option(
    "--error FLOAT", "With --over: the error at which run times are compared; by default 1e-4 m or rad for positions."
)
@option("--repeats INTEGER RANGE", "How often a run is timed.", default=9)
@option(
    "--longest FLOAT RANGE",
    "Longest time of a run, s; ten times as long for the reference. Longer runs are aborted.",
    default=20.0,
)
@option("--duration TEXT", "Time to solve, s, or with a unit.")
@CHANGES
@output_option("Draw the figure: .svg, .png or .pdf.")
@option("--json", "Print one JSON object on one line instead of tables.", "as_json")
def compare(scene: str, output: Path | None, as_json: bool, **options: object) -> None:
    """Measure run time against error of solvers, schemes and formulations on SCENE.

    The reference is a motion on which bdf and dop853 agree at tight tolerances; if they disagree, the comparison is
    refused. With --over it measures time at an equal error against a parameter, and names where bdf and explicit steps
    cross.

    Exit status: 0 done, 1 interrupted (measurements so far are shown), there is no reference, or the figure could not
    be written, 2 the input is wrong.
    """
    from ..comparison.figure import write_figure
    from .progress import StatusLine

    with refusing(scene, as_json):
        refuse_file("-o", output, scene, "figure")
        with StatusLine() as tell:
            found, origin = _found(scene, options, tell)
    _show(scene, found, as_json)
    written = is_written(output, lambda path: write_figure(path, found.plot(), origin))
    sys.exit(0 if written and not found.interrupted else Status.FAILED)


def _found(scene: str, options: dict[str, Any], tell: Any) -> tuple[Found, Provenance]:
    """Return the comparison that the options request, and its origin."""
    asked = {name: options[name] for name in ("measure", "repeats", "longest")}
    for name in ("solvers", "formulations"):
        if options[name]:
            asked[name] = [part.strip() for part in options[name].split(",") if part.strip()]
    changes = [*options["changes"], *([("run.duration", options["duration"])] if options["duration"] else [])]
    if options["error"] is not None and not options["over"]:
        raise InputError(f"--error {options['error']:g}: found no --over, expected it with --over NAME=VALUES")
    from ..reading.variation import read_variation, variation
    from ..results.provenance import provenance_of

    asked |= {
        name: variation(f"--{option}", options[option])
        for name, option in (("tolerances", "rtol"), ("steps", "step"))
        if options[option]
    }
    if options["over"]:
        from ..analyses.job import data_of
        from ..analyses.load_scene import with_parameter
        from ..comparison.over import compare_over

        over = read_variation(options["over"], "--over")
        made = with_parameter(scene, over.name, changes, over.dimension)
        found = compare_over(made, over.name, over, error=options["error"], tell=tell, **asked)
        return found, provenance_of(data_of(made(float(over.values[0]))), others=(f"{over.name} is varied",))
    from ..comparison.compare import compare

    loaded = load_scene(scene, changes)
    with in_file(scene):
        return compare(loaded, tell=tell, **asked), provenance_of(loaded)


def _show(scene: str, found: Found, as_json: bool) -> None:
    if as_json:
        from ..show.summary import json_line

        click.echo(json_line(found.as_dict(scene)))
        return
    from ..comparison.table import show
    from .run import console

    show(found, console())


@click.command(short_help="Run time against error of the examples.")
@click.argument("names", metavar="[EXAMPLE]...", nargs=-1)
@option("--json", "Print one JSON object a line for each example.", "as_json")
def bench(names: tuple[str, ...], as_json: bool) -> None:
    """Measure run time against error of bdf, dop853 and auto on the shipped examples.

    EXAMPLE is a name that `stiffmbs examples list` shows; by default all examples are measured.  Errors and times are
    those of `stiffmbs compare`.

    Exit status: 0 measured, 1 some example could not be measured or the command was interrupted, 2 there is no such
    example.
    """
    from ..comparison.compare import compare
    from ..comparison.machine import machine, machine_sentence
    from .starting import scene_file, scene_files

    with refusing("bench"):
        files = {name: scene_file(name) for name in names or scene_files()}
    if not as_json:
        click.echo(machine_sentence())
    status = Status.DONE
    for name, path in files.items():
        try:
            found = compare(path)
        except StiffmbsError as error:
            click.echo(f"stiffmbs: {name}: {error}", err=True)
            status = Status.FAILED
            continue
        rows = [row.as_dict(found.measure) for row in found.rows]
        as_object = {"problem": name, "machine": machine(), "rows": rows}
        click.echo(json.dumps(as_object) if as_json else _table(name, found))
        if found.interrupted:
            sys.exit(Status.FAILED)
    sys.exit(status)


def _table(name: str, found: Comparison) -> str:
    rows = [
        f"  {row.solver:22} {row.setting:14} "
        + (row.message or f"error {row.errors[found.measure]:8.1e}  {row.seconds * 1e3:10.3f} ms")
        for row in found.rows
    ]
    return "\n".join([f"{name}: {found.conclusion}", *rows])
