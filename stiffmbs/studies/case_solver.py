"""Sequential solution of the cases of a study; each structure is read, compiled and assembled once."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from ..analyses.job import Job, Runnable, prepare
from ..analyses.renumber import renumbered
from ..analyses.run import Finished, finished, solved
from ..errors import InputError, StiffmbsError
from ..model.files.changed_forces import ChangedForces
from ..model.files.written_scene import WrittenScene
from ..model.read_scene import read_changed
from ..model.scene import Scene
from ..model.settings import RunSettings
from ..reading.files.files_read import recorded
from ..reading.files.quoted import quoted
from ..reading.files.unchanged import Unchanged
from ..reading.units.units import Quantity, in_text
from ..reading.variation import Variation
from ..results.channels import channels_of
from ..results.solution import Solution
from ..solve.settings import changed
from ..solve.trajectory import Outcome, ProgressCallback
from .affine import is_affine
from .outputs import Output

MOST_STRUCTURES = 8
"""Number of jobs of different structures that are kept at a time."""
MOST_WORDS = 1000
"""Length of the message of a case at most, characters."""


@dataclass(frozen=True)
class Task:
    """Data that all cases of a study share; it can be pickled.

    `names`: varied parameters or paths, as `stiffmbs.load_scene` changes them. `settings`: settings of the run that all
    cases share.
    """

    scene: WrittenScene
    names: tuple[str, ...]
    settings: Mapping[str, object]
    outputs: tuple[Output, ...]


@dataclass(frozen=True)
class Row:
    """Result of a case."""

    case: int
    status: str  # ``done``, ``stopped`` early, or ``error``
    message: str  # error message, and notes of the run
    values: tuple[float | np.ndarray, ...]  # outputs, numbers or series; numbers are nan if the run was not completed
    # digests of the files that cases name, without those of the study's scene
    files: Mapping[str, str] = field(default_factory=dict)


class ChangedFileError(InputError):
    """A file has changed since the study began, so no further case can be solved."""


class CaseSolver:
    """Solver of cases in one thread; each thread needs its own."""

    def __init__(self, task: Task) -> None:
        self._task = task
        self._unchanged = Unchanged()
        self._changed_forces: ChangedForces | None = None
        self._jobs: list[Job] = []
        self._of_scene = self._changed = RunSettings()
        self._files: dict[str, str] = {}

    def take_jobs(self, other: CaseSolver) -> None:
        """Take over the jobs of another solver, whose structures may occur again; it must not be used any more."""
        self._jobs = other._jobs

    def scene(self, values: Sequence[object]) -> Scene:
        """Return the scene of a case.

        Raises InputError if a value is not valid, or a file has changed since the study began.
        """
        found = self._changed_forces.scene(values) if self._changed_forces and len(values) else None
        if found is not None:
            return found
        written, names = self._task.scene, self._task.names
        with recorded() as files:
            scene = read_changed(written, list(zip(names, values, strict=True)), self._unchanged)
        self._check_files(files)
        if self._changed_forces is None:
            self._changed_forces = ChangedForces(written, names, self._unchanged)
        return scene

    def is_affine(self, number: int) -> bool:
        """Return True if all numbers of the scene are affine functions of a varied value, by its number among the names."""
        written = self._task.scene
        return is_affine({**written.content, "": [value for _, value in written.changes]}, self._task.names[number])

    def _check_files(self, files: Mapping[str, str]) -> None:
        """Reject a file that has changed since the scene or another case was read."""
        for name, digest in files.items():
            if self._task.scene.files.get(name, self._files.get(name, digest)) != digest:
                raise ChangedFileError(
                    f"'{quoted(name)}' has changed since the scene was read; expected the same content in all cases"
                )
        self._files |= {name: digest for name, digest in files.items() if name not in self._task.scene.files}

    def solution(self, values: Sequence[object]) -> Solution:
        """Return the solution of a case; errors as for `stiffmbs.run`."""
        return solved(self.job(self.scene(values)))

    def channels(self, values: Sequence[object]) -> tuple[str, ...]:
        """Return the names of the channels of a case; errors as for `stiffmbs.run`."""
        job = self.job(self.scene(values))
        start = job.start
        rows = job.dynamics.report(np.array([job.grid.start]), start.q[None], start.u[None], project=False)
        return tuple(channels_of(job.data, job.dynamics.system, rows))

    def row(self, case: int, values: Sequence[object], watch: ProgressCallback | None = None) -> Row:
        """Solve a case and return its outputs, or its error; `watch` as for `stiffmbs.run`."""
        try:
            solution = finished(self.job(self.scene(values)), watch)
            done = solution.outcome is Outcome.DONE
            outputs = tuple(_kept(output, solution, done) for output in self._task.outputs)
        except ChangedFileError:
            raise
        except StiffmbsError as error:
            nothing = (np.nan,) * len(self._task.outputs)
            return Row(case, "error", str(error)[:MOST_WORDS], nothing, dict(self._files))
        if solution.outcome is Outcome.INTERRUPTED:
            raise KeyboardInterrupt
        sentences = "; ".join([*([] if done else [solution.message]), *self._undefined(outputs, done), *solution.notes])
        return Row(case, "done" if done else "stopped", sentences[:MOST_WORDS], outputs, dict(self._files))

    def _undefined(self, outputs: Sequence[float | np.ndarray], done: bool) -> Iterator[str]:
        """Yield a sentence for each output number of a completed run that is not finite, such as log(0)."""
        for output, value in zip(self._task.outputs, outputs, strict=True):
            if done and not output.is_series and not np.isfinite(value):
                yield f"output '{output.name}': found {value}, expected a finite number"

    def _settings(self, of_scene: RunSettings) -> RunSettings:
        """Return the settings of a scene with the task's changes, checked once for the same settings of the scene."""
        if self._of_scene is not of_scene:
            self._of_scene, self._changed = of_scene, changed(of_scene, dict(self._task.settings))
        return self._changed

    def job(self, scene: Scene, settings: RunSettings | None = None) -> Job:
        """Return a job for a scene, with changed numbers if the structure is known; errors as for `stiffmbs.run`.

        `settings`: settings of the run; by default those of the scene with the task's changes.
        """
        settings = settings or self._settings(scene.run)
        for k, known in enumerate(self._jobs):
            if known.settings == settings:
                found = renumbered(known, scene)
                if found is not None:
                    self._jobs.insert(0, found)
                    del self._jobs[k + 1]
                    return found
        found = prepare(scene, settings)
        for known in self._jobs:
            found.dynamics.take_input_features(known.dynamics)
        self._jobs.insert(0, found)
        del self._jobs[MOST_STRUCTURES:]
        return found


def _kept(output: Output, solution: Finished, done: bool) -> float | np.ndarray:
    """Return an output of a run; a reduction of a run that stopped early is nan."""
    value = output.value(solution)
    return value if done or output.is_series else np.nan


def written_scene(model: Runnable) -> WrittenScene:
    """Return the source from which the cases of a model are read.

    Raises InputError if the file cannot be read, the scene is a changed copy, or the model cannot be written as a
    scene.
    """
    from ..analyses.job import data_of, with_elements
    from ..analyses.run import run
    from ..model.model_text import model_text
    from ..model.read_scene import read_scene

    data = with_elements(data_of(model), run)
    if isinstance(data, Scene) and not data.is_as_read:
        raise InputError(
            "study: found a changed copy of a scene, expected a scene as it was read; give the changes as values"
        )
    if not isinstance(data, Scene) or data.written is None:
        data = read_scene(model_text(data))
    if data.written is None:
        raise InputError("study: found a scene that was not read from text, expected a file, a scene or a model")
    return data.written


def refuse_units(scene: WrittenScene, variations: Sequence[Variation]) -> None:
    """Reject units that the scene does not accept at the varied place."""
    for one in variations:
        if one.dimension is not None:
            value = one.range.low if one.range else one.values[0]
            CaseSolver(Task(scene, (one.name,), {}, ())).scene([in_text(Quantity(value, one.dimension))])
