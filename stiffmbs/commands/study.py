"""The command ``stiffmbs study``."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any

import click

from ..analyses.load_scene import load_scene
from ..errors import StiffmbsError
from ..show.escaped import console
from .progress import SHOWN_AFTER
from .scene import STOPPED_EARLY, changes_of, in_file, is_written, refuse, refuse_own_input, solving_options

if TYPE_CHECKING:
    import xarray


@click.command(short_help="Solve a scene for many values of its parameters.")
@click.argument("scene")
@click.option(
    "--vary",
    multiple=True,
    metavar="NAME=VALUES",
    help="LOW:HIGH:COUNT[:log], or VALUE,VALUE,... of a parameter or a path; any number of times.",
)
@click.option("--sample", metavar="KIND:N", help="lhs:N, sobol:N or random:N cases in place of the full grid.")
@click.option("--seed", type=int, default=0, help="Of the sample.")
@click.option(
    "--of", "outputs", multiple=True, help="What is kept: 'peak(rail.fy)', 'rms(bar.ax)', 'bar.x'; any number of times."
)
@click.option("--workers", type=click.IntRange(1), default=1, help="How many cases are solved at once.")
@click.option("--processes", is_flag=True, help="Processes in place of threads.")
@click.option("-o", "--output", type=click.Path(path_type=Path), help="Write the table: .nc or .csv.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object on one line instead of a table.")
@solving_options
def study(
    scene: str, vary: tuple[str, ...], sample: str | None, seed: int, outputs: tuple[str, ...], workers: int,
    processes: bool, output: Path | None, as_json: bool, **options: Any,
) -> None:  # fmt: skip
    """Solve SCENE for a grid or a sample of values, and keep the requested outputs of each run.

    Each completed case is kept in FILE.study next to the output until the table is written: an interrupted study
    continues from there when it is started again.

    Exit status: 0 done, 1 not all cases could be solved or the file could not be written, 2 the input is wrong.
    """
    from ..studies.data_set import check_output, write
    from ..studies.sweep import study_of
    from ..studies.variation import read_variation

    try:
        if output is not None:
            check_output(output)
            refuse_own_input("-o", scene, output)
        loaded = load_scene(scene, changes_of(options))
        varied = [read_variation(text) for text in vary]
        store = None if output is None else output.with_name(f"{output.name}.study")
        with in_file(scene):
            ready = study_of(loaded, varied, sample, seed, outputs or None, {})
            with _Bar() as watch:
                data = _solved(ready, workers, processes, store, watch)
    except StiffmbsError as error:
        refuse(scene, error, as_json)
    written = _write(output, store, data, write)
    _show(scene, data, as_json)
    sys.exit(0 if written and bool((data["status"] == "done").all()) else STOPPED_EARLY)


def _solved(ready: Any, workers: int, processes: bool, store: Path | None, watch: _Bar) -> xarray.Dataset:
    if not processes:
        return ready.solve(workers, None, store, watch)
    from concurrent.futures import ProcessPoolExecutor
    from multiprocessing import get_context

    with ProcessPoolExecutor(workers, get_context("spawn")) as executor:
        try:
            return ready.solve(workers, executor, store, watch)
        except BaseException:
            executor.shutdown(cancel_futures=True)
            raise


def _write(output: Path | None, store: Path | None, data: xarray.Dataset, write: Any) -> bool:
    """Write the table if requested, and then remove the stored rows; return True unless writing fails."""
    if output is None or store is None:
        return True
    if not is_written(output, lambda: write(output, data)):
        return False
    for ending in ("", "-wal", "-shm"):
        store.with_name(store.name + ending).unlink(missing_ok=True)
    return True


def _show(scene: str, data: xarray.Dataset, as_json: bool) -> None:
    from ..studies.table import as_dict, text

    click.echo(json.dumps(as_dict(scene, data)) if as_json else text(data))


class _Bar:
    """Progress bar of a study on standard error, on a terminal."""

    def __init__(self) -> None:
        self._bar: Any = None

    def __call__(self, done: int, total: int, left: float) -> None:
        if self._bar is None:
            if not sys.stderr.isatty() or left < SHOWN_AFTER:
                return
            from rich.progress import Progress

            self._bar = Progress(console=console(stderr=True), transient=True)
            self._bar.start()
            self._task = self._bar.add_task("solving", total=total)
        self._bar.update(self._task, completed=done, description=f"case {done} of {total}, {left:.0f} s left")

    def __enter__(self) -> _Bar:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._bar is not None:
            self._bar.stop()
