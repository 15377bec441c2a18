"""The command ``stiffmbs study``."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ..analyses.load_scene import load_scene
from .process import Status
from .progress import CaseBar
from .scene import changes_of, in_file, is_written, option, output_option, refuse_file, refusing, solving_options

if TYPE_CHECKING:
    import xarray

    from ..studies.study import Study


@click.command(short_help="Solve a scene for many values of its parameters.")
@click.argument("scene")
@option("--vary NAME=VALUES ...", "FROM:TO:COUNT[:log] or VALUE,VALUE,... of a parameter or a path")
@option("--sample KIND:N", "lhs:N, sobol:N or random:N cases instead of the full grid.")
@option("--seed INTEGER", "Seed of the sample.", default=0)
@option("--of TEXT ...", "Output to keep: 'peak(rail.fy)', 'rms(bar.ax)', 'bar.x'", "outputs")
@option("--workers INTEGER RANGE", "How many cases are solved at once.", default=1)
@option("--processes", "Processes in place of threads.")
@output_option("Write the table, or a page: .nc, .csv or .html.")
@option("--json", "Print one JSON object on one line instead of a table.", "as_json")
@solving_options
def study(
    scene: str, vary: tuple[str, ...], sample: str | None, seed: int, outputs: tuple[str, ...], workers: int,
    processes: bool, output: Path | None, as_json: bool, **options: object,
) -> None:  # fmt: skip
    """Solve SCENE for a grid or a sample of values, and keep the requested outputs of each run.

    Each completed case is kept in FILE.study next to the output until the table is written: an interrupted study
    continues from there when it is started again.

    Exit status: 0 done, 1 not all cases could be solved or the file could not be written, 2 the input is wrong.
    """
    from ..reading.variation import read_variation
    from ..results.provenance import provenance_of
    from ..show.page.study import write_study
    from ..studies.data_set import as_dict, text, write
    from ..studies.sweep import study_of

    with refusing(scene, as_json):
        refuse_file("-o", output, scene, "cases")
        loaded = load_scene(scene, changes_of(options))
        varied = [read_variation(text, "--vary") for text in vary]
        store = None if output is None else output.with_name(f"{output.name}.study")
        with in_file(scene):
            ready = study_of(loaded, varied, sample, seed, outputs or None, {})
            with CaseBar() as watch:
                data = _solved(ready, workers, processes, store, watch)

    def write_data(path: Path, data: xarray.Dataset) -> None:
        """Write the page or the table."""
        if path.suffix == ".html":
            write_study(path, data, provenance_of(loaded))
        else:
            write(path, data)

    written = _write(output, store, data, write_data)
    click.echo(json.dumps(as_dict(scene, data)) if as_json else text(data))
    sys.exit(0 if written and bool((data["status"] == "done").all()) else Status.FAILED)


def _solved(ready: Study, workers: int, processes: bool, store: Path | None, watch: CaseBar) -> xarray.Dataset:
    if not processes:
        return ready.solve(workers, None, store, watch)
    from ..processes import process_pool

    with process_pool(workers) as executor:
        try:
            return ready.solve(workers, executor, store, watch)
        except BaseException:
            executor.shutdown(cancel_futures=True)
            raise


def _write(
    output: Path | None, store: Path | None, data: xarray.Dataset, write: Callable[[Path, xarray.Dataset], None]
) -> bool:
    """Write the table if requested, and then remove the stored rows; return True unless writing fails."""
    if output is None or store is None:
        return True
    if not is_written(output, lambda path: write(path, data)):
        return False
    for ending in ("", "-wal", "-shm"):
        store.with_name(store.name + ending).unlink(missing_ok=True)
    return True
