"""Parameter sweeps: many runs of one scene with other values."""

from __future__ import annotations

import pickle
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import closing
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..analyses.job import Runnable
from ..errors import InputError, StiffmbsError, refuse_text
from ..model.scene import Scene
from ..model.settings import RunSettings
from ..reading.files.quoted import quoted
from ..reading.variation import Range, Variation, variation
from ..results.provenance import Provenance, with_settings
from ..results.requests import units_of
from ..solve.settings import changed, output_grid
from .case_solver import CaseSolver, Row, Task, refuse_units, written_scene
from .cases import Cases, cases_of
from .data_set import data_set
from .executors import Chunk, executor_of, refuse_workers, rows_of
from .outputs import Output, outputs_of
from .store import Store

if TYPE_CHECKING:
    import xarray

LARGEST_CHUNK, CHUNKS_PER_WORKER = 8, 8
GRID = tuple(f"run.{name}" for name in ("start", "duration", "output", "points"))
StudyProgress = Callable[[int, int, float], None]
"""Callback with the number of completed cases, the number of all cases, and the estimated time left, s."""


@dataclass(frozen=True)
class Study:
    """Study that is ready to be solved.

    `time`: output instants of series, s. `origin`: scene without varied values. `units`: known units of outputs by name.
    """

    task: Task
    cases: Cases
    time: np.ndarray
    title: str
    origin: Provenance
    units: Mapping[str, str]

    @property
    def parts(self) -> dict[str, str]:
        """Return everything on which the rows depend, by its name in messages: texts, and digests of files."""
        from .. import __version__

        task = self.task
        return {
            "stiffmbs": __version__, "the scene": repr((task.scene.content, task.scene.changes)),
            "the varied values": repr(self.cases), "the settings": repr(task.settings), "the outputs": repr(task.outputs),
            **{f"'{quoted(name)}'": digest for name, digest in task.scene.files.items()},
        }  # fmt: skip

    def solve(
        self, workers: int | None = None, executor: Executor | None = None, store: str | Path | None = None,
        watch: StudyProgress | None = None,
    ) -> xarray.Dataset:  # fmt: skip
        """Solve the cases that the store lacks; parameters and errors as for `sweep`."""
        refuse_workers(workers)
        task = pickle.dumps(self.task)
        with (
            closing(Store(Path(store) if store else None, self.parts)) as rows,
            executor_of(workers, executor) as (found, count),
        ):
            done = rows.done()
            size = max(1, min(LARGEST_CHUNK, (len(self.cases) - len(done)) // (CHUNKS_PER_WORKER * count)))
            progress = _Progress(len(self.cases), len(done), watch)

            def keep(solved: list[Row]) -> None:
                rows.add(solved)
                progress.add(len(solved))

            rows_of(task, _chunks(self.cases, done, size), found, count, keep)
            solved = data_set(self.cases, self.task.outputs, rows.rows(), self.time, self.title)
        for name, unit in self.units.items():
            solved[name].attrs["units"] = unit
        return solved.assign_attrs(self.origin.as_texts())


class _Progress:
    """Progress reports of a study, with the time left estimated from the cases of this session."""

    def __init__(self, total: int, before: int, watch: StudyProgress | None) -> None:
        self._total, self._before, self._done, self._watch = total, before, before, watch
        self._begun = time.monotonic()

    def add(self, count: int) -> None:
        """Count solved cases, and report the progress."""
        self._done += count
        if self._watch:
            each = (time.monotonic() - self._begun) / (self._done - self._before)
            self._watch(self._done, self._total, each * (self._total - self._done))


def _chunks(cases: Cases, done: set[int], size: int) -> Iterator[Chunk]:
    left = ((number, values) for number, values in enumerate(cases) if number not in done)
    while chunk := list(islice(left, size)):
        yield chunk


def sweep(
    scene: Runnable,
    vary: Mapping[str, object] | Sequence[Variation] = (),
    *,
    sample: str | None = None,
    seed: int = 0,
    outputs: Mapping[str, str] | Sequence[str] | str | None = None,
    workers: int | None = None,
    executor: Executor | None = None,
    store: str | Path | None = None,
    watch: StudyProgress | None = None,
    **parameters: object,
) -> xarray.Dataset:
    """Solve a scene for many values of its parameters (needs xarray, the extra ``netcdf``).

    Parameters
    ----------
    scene : str, Path, Scene or Model
        A file of a scene has parameters; a model has only paths.
    vary : mapping, optional
        Values by parameters or paths that no keyword can name: ``{"forces.spring.stiffness": [100, 200]}``,
        ``{"bodies.bar.angle": Range(0, 1)}``, ``{"run.rtol": "1e-8:1e-4:5:log"}``.  Each value may be a vector or a
        matrix.
    sample : str, optional
        ``lhs:500`` (Latin hypercube), ``sobol:512`` or ``random:500`` cases instead of the full grid; values are drawn
        from ranges, or picked from lists.
    seed : int
        Seed of the sample.
    outputs : mapping of str to str, sequence of str, optional
        Formulas of channels and of ``peak``, ``t_peak``, ``rms``, ``mean``, ``integral``, ``min``, ``max``, ``t_min``,
        ``t_max``, ``first`` and ``final`` of them, at the output instants; by default the peak of every channel of the
        scene's figure, or of the total energy.
    workers : int, optional
        Number of threads; 1 by default.
    executor : concurrent.futures.Executor, optional
        Executor that replaces threads: a ``ProcessPoolExecutor``, or ``client.get_executor()`` of a Dask cluster.
    store : str or Path, optional
        File that keeps each completed case; an interrupted study continues from there.
    watch : callable, optional
        Called with the number of completed cases, the number of all cases, and the time left, s.
    **parameters
        Varied values by name; and settings of the run that all cases share, such as ``solver="auto"``, ``rtol=1e-8``.

    Returns
    -------
    xarray.Dataset
        A variable for each output, with the varied values as coordinates, and ``status`` and ``message`` of each case.
        In a failed case reductions are nan, and the message states the reason.

    Raises
    ------
    InputError
        If the scene, a varied value, an output or the store is invalid.
    SolverError
        If workers of an executor end repeatedly.

    Examples
    --------
    >>> found = stiffmbs.sweep("examples/half_car.yaml", k_b=np.logspace(5, 9, 200), zeta=[0.02, 0.1],
    ...                        outputs=["peak(front_bushing.fx)"], workers=2)
    """
    study = study_of(scene, vary, sample, seed, outputs, parameters)
    return study.solve(workers, executor, store, watch)


def study_of(
    scene: Runnable,
    vary: Mapping[str, object] | Sequence[Variation],
    sample: str | None,
    seed: int,
    outputs: Mapping[str, str] | Sequence[str] | str | None,
    parameters: Mapping[str, object],
) -> Study:
    """Return a study after a check that one of its cases can be prepared; parameters and errors as for `sweep`."""
    refuse_text("vary", vary, "variations, or values by parameter")
    written = written_scene(scene)
    known = CaseSolver(Task(written, (), {}, ())).scene(())
    settings = {
        name: value
        for name, value in parameters.items()
        if _path(name, known) != name and not isinstance(value, list | tuple | np.ndarray | Range | Variation)
    }
    varied = vary.items() if isinstance(vary, Mapping) else ((one.name, one) for one in vary)
    pairs = [*varied, *((name, found) for name, found in parameters.items() if name not in settings)]
    variations = [variation(_path(name, known), found) for name, found in pairs]
    refuse_units(written, variations)
    cases = cases_of(variations, sample, seed)
    usual = [f"peak({channel})" for channel in (known.figure.y if known.figure else ("energy.total",))]
    chosen = outputs_of(outputs if outputs is not None else usual)  # type: ignore[arg-type]
    _refuse_other_instants(cases, chosen)
    task = Task(written, cases.names, settings, chosen)
    _refuse_unfit(task, cases)
    origin = with_settings(written, settings, tuple(f"{name} is varied" for name in cases.names))
    of_channels = units_of(known, {channel for one in chosen for channel in one.channels})
    units = {one.name: unit for one in chosen if (unit := one.unit(of_channels))}
    return Study(task, cases, _instants(known, settings, chosen), known.name, origin, units)


def _refuse_unfit(task: Task, cases: Cases) -> None:
    """Reject names that the scene does not have, and channels that no run has.

    Raises InputError, AssemblyError if neither the first nor the last case can be prepared.
    """
    solver, values_of = CaseSolver(task), cases.drawn or tuple(one.values for one in cases.variations)
    faults = []
    for values in (tuple(each[k] for each in values_of) for k in (0, -1)):
        try:
            known = solver.channels(values)
        except StiffmbsError as error:
            faults.append(error)
            continue
        for output in task.outputs:
            output.refuse_unknown(known)
        return
    raise faults[0]


def _path(name: str, scene: Scene) -> str:
    """Return the path of a name, which may be the bare name of a setting."""
    return f"run.{name}" if name in RunSettings.model_fields and name not in scene.parameters else name


def _refuse_other_instants(cases: Cases, outputs: Sequence[Output]) -> None:
    """Reject series if output instants vary: those of all cases share one table."""
    series = next((one.name for one in outputs if one.is_series), None)
    other = next((name for name in cases.names if name in GRID), None)
    if series and other:
        raise InputError(
            f"output '{series}': found series with {other} varied, expected the same output instants in all cases"
        )


def _instants(scene: Scene, settings: Mapping[str, object], outputs: Sequence[Output]) -> np.ndarray:
    """Return the output instants of series; empty if there are none."""
    if not any(one.is_series for one in outputs):
        return np.empty(0)
    times = output_grid(changed(scene.run, dict(settings))).times
    if times is None:
        raise InputError(
            "points: found 'steps' with outputs over time, expected a number of output points, or reductions"
        )
    return times
