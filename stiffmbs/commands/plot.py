"""The command ``stiffmbs plot``."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ..analyses.load_scene import load_scene
from ..errors import InputError
from .runs import RESULTS, runs_of
from .scene import changes_of, output_option, refuse_own_input, refusing, solving_options

if TYPE_CHECKING:
    from ..model.scene import Figure


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
@output_option("Where to draw: .png, .svg or .pdf; a window without it.")
@click.option("--live", is_flag=True, help="A window whose plots grow while SCENE is solved.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object on one line on what was drawn.")
@solving_options
def plot(
    source: str, channels: tuple[str, ...], against: str, others: tuple[Path, ...], title: str, output: Path | None,
    live: bool, as_json: bool, **options: Any,
) -> None:  # fmt: skip
    """Plot CHANNELS of a run: of RESULTS (.npz), or of SCENE, which is solved first.  Each unit has its own plot.

    Exit status: 0 done, 1 the file could not be written, 2 the input is wrong.
    """
    from ..show.figure import check_plot, figure_of, plotted_runs, write_plot

    with refusing(source, as_json, output):
        check_plot(output)
        if live:
            figure = _live(source, channels, against, title, others, output, options)
            _tell(source, figure, None, as_json)
            _show_window()
            return
        for path in (source, *(str(other) for other in others)) if output is not None else ():
            refuse_own_input("-o", path, output)  # type: ignore[arg-type]
        runs = runs_of(source, others, options)
        figure = figure_of(runs, channels, against, title)
        sheet = plotted_runs(runs, figure, in_window=output is None)
        if output is not None:
            write_plot(output, sheet)
    _tell(source, figure, output, as_json)
    if output is None:
        _show_window()


def _live(
    source: str, channels: tuple[str, ...], against: str, title: str, others: tuple[Path, ...], output: Path | None,
    options: dict[str, Any],
) -> Figure:  # fmt: skip
    """Solve a scene and plot the solution so far in a window."""
    from ..show.figure import show_live
    from ..studies.follow import follow

    if source.endswith(RESULTS) or others or output is not None:
        wrong = "results" if source.endswith(RESULTS) else "--with" if others else "-o"
        raise InputError(f"--live: found {wrong}, expected a scene alone, which is solved in a window")
    return show_live(follow(load_scene(source, changes_of(options))), channels, against, title)


def _tell(source: str, figure: Figure, output: Path | None, as_json: bool) -> None:
    told = {"source": source, "output": str(output or "window"), "channels": list(figure.y), "against": figure.x}
    click.echo(json.dumps(told) if as_json else f"plot: {told['output']}")


def _show_window() -> None:
    """Show the window until it is closed."""
    from matplotlib import pyplot

    pyplot.show()
