"""The command ``stiffmbs plot``."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import click

from ..errors import StiffmbsError
from .runs import runs_of
from .scene import STOPPED_EARLY, refuse, refuse_own_input, solving_options


@click.command(short_help="Plots of any channels.")
@click.argument("source", metavar="SCENE|RESULTS")
@click.argument("channels", nargs=-1)
@click.option("--against", default="time", show_default=True, help="A channel, or time.")
@click.option(
    "--with",
    "others",
    multiple=True,
    type=click.Path(path_type=Path),
    help="Results (.npz) of another run, drawn over; any number of times.",
)
@click.option("--title", default="", help="Shown above; the scene's name without it.")
@click.option(
    "-o", "--output", type=click.Path(path_type=Path), help="Where to draw: .png, .svg or .pdf; a window without it."
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object on one line on what was drawn.")
@solving_options
def plot(
    source: str, channels: tuple[str, ...], against: str, others: tuple[Path, ...], title: str, output: Path | None,
    as_json: bool, **options: Any,
) -> None:  # fmt: skip
    """Plot CHANNELS of a run: of RESULTS (.npz), or of SCENE, which is solved first.  Each unit has a plot of its own.

    Exit status: 0 done, 1 the file could not be written, 2 the input is wrong.
    """
    from ..show.plot import check_plot, figure_of, plotted_runs, show_window, write_plot

    try:
        check_plot(output)
        for path in (source, *(str(other) for other in others)) if output is not None else ():
            refuse_own_input("-o", path, output)  # type: ignore[arg-type]
        runs = runs_of(source, others, options)
        figure = figure_of(runs, channels, against, title)
        sheet = plotted_runs(runs, figure, in_window=output is None)
        if output is not None:
            write_plot(output, sheet)
    except StiffmbsError as error:
        refuse(source, error, as_json)
    except OSError as error:
        click.echo(f"stiffmbs: not written: {output}: {error.strerror}", err=True)
        sys.exit(STOPPED_EARLY)
    told = {"source": source, "output": str(output or "window"), "channels": list(figure.y), "against": figure.x}
    click.echo(json.dumps(told) if as_json else f"plot: {told['output']}")
    if output is None:
        show_window()
