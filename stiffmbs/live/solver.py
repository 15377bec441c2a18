"""Solution of a scene's text again and again: warm, with what did not change kept from one time to the next."""

from __future__ import annotations

import re
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from zlib import Z_BEST_SPEED

import numpy as np

from ..analyses.run import run, solved
from ..elements.element import Element
from ..errors import InputError, StiffmbsError
from ..model.model_data import ModelData
from ..model.parts.options import CHOOSE, OPTIONS, choices_of, words_chosen
from ..model.read_scene import read_scene
from ..model.scene import Scene
from ..notes import Severity
from ..reading.python_function import PythonFunction
from ..results.solution import Solution
from ..show.drawing.derive import drawing_of
from ..show.drawing.poses import described_poses, poses_of
from ..show.page.data import page_data
from ..show.summary import solver_lines
from ..show.verdict import verdict
from ..solve.trajectory import Outcome, ProgressCallback
from ..studies.case_solver import CaseSolver, Task

Numbers = Mapping[str, str]
"""Parameters with other values than in the text, such as ``{"L": "0.7 m"}``."""
NOTHING = "scene: type or paste a scene here; Ctrl-Space lists what may stand at the cursor"
_LINE, _LINE_FIRST = re.compile(r"line (\d+)"), re.compile(r"^line \d+[,:] ")


@dataclass(frozen=True)
class Solved:
    """Scene and its solution, and what they were solved for."""

    text: str
    numbers: tuple[tuple[str, str], ...]
    scene: ModelData
    solution: Solution


class NeedsConsent(InputError):
    """The model runs Python functions, and the user has not agreed yet."""


class LiveSolver:
    """Solver of the text of one page.

    `file`: file of the scene; files that it names are relative to its folder. `model`: a model in place of a text,
    which cannot be written as text.
    """

    def __init__(self, file: Path | None = None, model: ModelData | None = None) -> None:
        self._file, self._model = file, model
        self._read: tuple[str, Scene] | None = None
        self._cases: tuple[tuple[str, tuple[str, ...]], CaseSolver] | None = None
        self._allowed = False
        self.span = (0.0, 0.0)  # start and end of the run under way, s; equal if unknown
        self.last: Solved | None = None

    @property
    def source(self) -> str:
        """Name of the scene in messages."""
        return self._file.name if self._file else "scene"

    def allow(self) -> None:
        """Record that Python functions may run."""
        self._allowed = True

    def scene(self, text: str, numbers: Numbers) -> ModelData:
        """Return the scene of a text with other numbers.

        Raises InputError if it is not valid; the message contains the line. Raises NeedsConsent if it runs Python
        functions, before `allow`.
        """
        found = self._found(text, numbers)
        if not self._allowed:
            refuse_python(found)
        return found

    def _found(self, text: str, numbers: Numbers) -> ModelData:
        if self._model is not None:
            return self._model
        if not text.strip():
            raise InputError(NOTHING)
        if self._read is None or self._read[0] != text:
            self._read = (text, read_scene(text, (), self.source, self._file))
        scene = self._read[1]
        if not numbers or scene.written is None:
            return scene
        return self._solver(text, tuple(numbers)).scene(list(numbers.values()))

    def _solver(self, text: str, names: tuple[str, ...]) -> CaseSolver:
        """Return the solver of a text's cases; it takes over the prepared jobs of the last one."""
        if self._cases is None or self._cases[0] != (text, names):
            written = self._read[1].written if self._read else None
            made = CaseSolver(Task(written, names, {}, ()))  # type: ignore[arg-type]  # a model has no cases
            if self._cases is not None:
                made.take_jobs(self._cases[1])
            self._cases = ((text, names), made)
        return self._cases[1]

    def solve(self, text: str, numbers: Numbers, watch: ProgressCallback) -> Solved:
        """Solve a text with other numbers; return the last solution if they are the same.

        Raises StiffmbsError as for `stiffmbs.run`.
        """
        asked = tuple(numbers.items())
        if self.last is not None and (self.last.text, self.last.numbers) == (text, asked):
            return self.last
        scene = self.scene(text, numbers)
        begin = scene.run.start if isinstance(scene, Scene) else 0.0
        self.span = (begin, begin + scene.whole_duration if isinstance(scene, Scene) else begin)
        if self._model is None and isinstance(scene, Scene) and not scene.stages:
            solution = solved(self._solver(text, tuple(numbers)).job(scene), watch)
        else:
            solution = run(scene, watch=watch)
        found = Solved(text, asked, scene, solution)
        self.last = None if solution.outcome is Outcome.INTERRUPTED else found
        return found


def refuse_python(model: ModelData) -> None:
    """Raise NeedsConsent if a model contains Python functions, or elements of other packages."""
    package = __name__.partition(".")[0]
    found = []
    for name, element in (*model.joints.items(), *model.forces.items()):
        own = type(element).__module__
        if own.partition(".")[0] != package:
            found.append(f"{name} ({own})")
        found += [f"{name} ({function.name})" for function in functions_of(element)]
    if found:
        raise NeedsConsent(f"The scene runs Python code that is not of {package}: {', '.join(found)}.")


def functions_of(element: Element) -> list[PythonFunction]:
    """Return the Python functions of an element."""
    return [part for _, part in element.parts(PythonFunction)]


def shown(found: Solved, channels: Sequence[str]) -> dict[str, object]:
    """Return a solution as a page shows it: the motion, chosen channels, and the verdict."""
    scene, solution = found.scene, found.solution
    figure = solution.figure.y if solution.figure else ()
    wanted = [name for name in channels if name in solution.channels] or list(figure) or ["energy.total"]
    poses = poses_of(scene, solution.time, solution.channels)
    page = page_data(drawing_of(scene, along=poses), {"": poses}, solution, wanted, only=wanted, level=Z_BEST_SPEED)
    judged = verdict(solution)
    return {
        "status": judged.status, "message": judged.headline, "notes": list(judged.to_check),
        "grave": sum(note.severity is not Severity.REMARK for note in judged.to_check), "choices": choices_in(scene), "digits": judged.digits_words,
        "lines": [f"{label}: {line}" for label, line in solver_lines(solution.solver)], "page": page,
        "parameters": parameters_of(scene), "name": solution.name, "end": float(solution.time[-1]),
    }  # fmt: skip


def preview(scene: ModelData) -> dict[str, str]:
    """Return the bodies of a scene as described, for a page that waits for the first solution."""
    poses = described_poses(scene)
    poses = poses.at(np.zeros(2, dtype=int))
    return page_data(drawing_of(scene, along=poses), {"": poses}, level=Z_BEST_SPEED)


def parameters_of(scene: ModelData) -> list[dict[str, object]]:
    """Return the parameters of a scene: name, value in SI units, and the value with its unit as text."""
    if not isinstance(scene, Scene):
        return []
    written = scene.written_parameters()
    return [
        {"name": name, "value": value, "text": str(written[name])}
        for name, value in scene.parameters.items()
        if isinstance(value, float | int)
    ]


def choices_in(scene: ModelData) -> list[dict[str, object]]:
    """Return the choices among the options of a scene: name, words, and the chosen one."""
    written = scene.written if isinstance(scene, Scene) else None
    if written is None:
        return []
    chosen = words_chosen(written.content.get(CHOOSE))
    return [
        {"name": name, "words": list(words), "chosen": chosen.get(name, next(iter(words)))}
        for name, words in choices_of(written.content, OPTIONS).items()
    ]


def error_of(error: StiffmbsError, source: str) -> dict[str, object]:
    """Return an error as a page shows it, with the line in the text, or 0 if unknown."""
    message = str(error)
    head = message.partition(": ")[0] if message.startswith(source) else ""
    line = _LINE.search(head) if " of " not in head else None  # lines of included files are not lines of the text
    text = message.removeprefix(f"{source}, ").removeprefix(f"{source}: ")
    text = _LINE_FIRST.sub("", text) if line else text
    return {"status": "error", "message": text, "line": int(line[1]) if line else 0}


def timed(begun: float) -> float:
    """Return the time since an instant, s."""
    return round(time.perf_counter() - begun, 4)
