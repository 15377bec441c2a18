"""Requests of a live page on the scene in its editor, by name, and their answers."""

from __future__ import annotations

import base64
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np

from ..analyses.check import check
from ..analyses.linearised.modes import modes
from ..comparison.compare import compare
from ..comparison.table import text as comparison_text
from ..errors import InputError
from ..model.model_data import ModelData
from ..reading.files.quoted import quoted
from ..results.displayed import displayed
from ..results.files import WRITERS, refuse_path, write
from ..results.solution import Solution
from ..show.verdict import verdict
from ..solve.trajectory import Outcome, ProgressCallback
from ..verification.verify import verify
from .solver import LiveSolver, Solved, shown

MOST_CASES = 41
"""Largest number of runs of a sweep."""
MOST_INSTANTS = 400
"""Largest number of instants of a band."""
PAGES = (".html", ".report.html")
Tell = Callable[[dict[str, object]], None]
"""Function that reports progress to the page."""


class Request:
    """Request of a page, with the solver that answers it.

    `text`: text of the scene. `numbers`: parameters with other values than in the text. `rest`: further fields. `watch`,
    `tell`: functions that report the time reached, and other progress.
    """

    def __init__(self, content: Mapping[str, object], solver: LiveSolver, watch: ProgressCallback, tell: Tell) -> None:
        self._solver, self.watch, self.tell = solver, watch, tell
        self.text = str(content.get("text", ""))
        numbers = content.get("numbers")
        self.numbers = {str(k): str(v) for k, v in numbers.items()} if isinstance(numbers, dict) else {}
        self.rest = content

    @property
    def scene(self) -> ModelData:
        """Scene of the text; errors as for `LiveSolver.scene`."""
        return self._solver.scene(self.text, self.numbers)

    def solved(self, numbers: Mapping[str, str] | None = None) -> Solved:
        """Return the solution of the scene, with other numbers if they are given."""
        return self._solver.solve(self.text, self.numbers if numbers is None else numbers, self.watch)

    def names(self, field: str) -> list[str]:
        """Return a field that is a list of names."""
        found = self.rest.get(field)
        return [str(name) for name in found] if isinstance(found, list) else []

    def number(self, field: str, least: float, greatest: float) -> float:
        """Return a field that is a number within bounds. Raises InputError if it is not."""
        found = self.rest.get(field)
        if not isinstance(found, int | float) or not least <= found <= greatest:
            raise InputError(f"{field}: found {found!r}, expected a number from {least:g} to {greatest:g}")
        return float(found)


def _verify(request: Request) -> dict[str, object]:
    judged = verdict(verify(request.scene, watch=request.watch))
    notes = [f"- {note}" for note in judged.to_check] or ["Nothing to check."]
    return {"status": judged.status, "text": "\n".join([judged.headline, judged.digits_words, *notes])}


def _compare(request: Request) -> dict[str, object]:
    def line(text: str) -> None:
        request.watch(np.nan)
        request.tell({"stage": text})

    found = compare(request.scene, tolerances="1e-3:1e-8:6:log", repeats=3, tell=line)
    return {"status": "done", "text": comparison_text(found)}


def _sweep(request: Request) -> dict[str, object]:
    """Return each channel over time for several values of a parameter, and the least and greatest value at each instant."""
    name = str(request.rest.get("parameter", ""))
    count = int(request.number("count", 2, MOST_CASES))
    low, high = (request.number(end, -1e300, 1e300) for end in ("low", "high"))
    unit = str(request.rest.get("unit", ""))
    values = np.geomspace(low, high, count) if request.rest.get("log") and low > 0 else np.linspace(low, high, count)
    runs: list[tuple[str, Solution]] = []
    failed: list[tuple[str, Solution]] = []
    for k, value in enumerate(values):
        request.tell({"stage": f"case {k + 1} of {count}"})
        text = f"{value:.9g} {unit}".strip()
        found = displayed(request.solved({**request.numbers, name: text}).solution)
        if found.outcome is Outcome.INTERRUPTED:
            raise KeyboardInterrupt
        (runs if found.outcome is Outcome.DONE else failed).append((text, found))
    if not runs:
        raise InputError(f"sweep of {name}: no run was completed; the first one: {failed[0][1].message}")
    time = runs[0][1].time
    rows = np.unique(np.linspace(0, len(time) - 1, min(len(time), MOST_INSTANTS)).astype(int))
    bands = []
    for channel in request.names("channels"):
        curves = [np.interp(time[rows], run.time, run.channels[channel]) for _, run in runs if channel in run.channels]
        if curves:
            least, greatest = np.min(curves, axis=0), np.max(curves, axis=0)
            band = {"channel": channel, "low": least.tolist(), "high": greatest.tolist()}
            bands.append({**band, "curves": [c.tolist() for c in curves]})
    notes = [f"{name} = {text}: {run.message}" for text, run in failed]
    head = f"{name}: {count} values from {low:g} to {high:g} {unit}; the bands hold all of their curves"
    return {"status": "done", "text": "\n".join([head, *notes]), "time": time[rows].tolist(), "bands": bands}


def _export(request: Request) -> dict[str, object]:
    """Return the file of the results, of the page in motion, or of the report, in base64."""
    suffix = str(request.rest.get("suffix", ""))
    if suffix not in (*WRITERS, *PAGES):
        raise InputError(f"export: found '{suffix}', expected one of {', '.join((*WRITERS, *PAGES))}")
    found = request.solved()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"scene{suffix}"
        if suffix == ".report.html":
            from ..show.report import write_report

            refuse_path("export", path, "report")
            write_report(path, found.scene, found.solution, request.text)  # type: ignore[arg-type]  # a scene, or a model
        elif suffix == ".html":
            from ..show.drawing.animate import write_animation

            refuse_path("export", path, "animation")
            write_animation(path, found.scene, {"": found.solution})
        else:
            write(path, found.solution)
        content = path.read_bytes()
    return {"status": "done", "suffix": suffix, "content": base64.b64encode(content).decode("ascii")}


ANSWERS: dict[str, Callable[[Request], dict[str, object]]] = {
    "solve": lambda request: shown(request.solved(), request.names("channels")),
    "check": lambda request: {"status": "done", "text": str(check(request.scene))},
    "modes": lambda request: {"status": "done", "text": modes(request.scene).table()},
    "verify": _verify,
    "compare": _compare,
    "sweep": _sweep,
    "export": _export,
}
"""Answers by the field ``what`` of a request."""


def answer_to(request: Request) -> dict[str, object]:
    """Return the answer to a request. Raises InputError if there is none of that name; others as for `ANSWERS`."""
    what = str(request.rest.get("what"))
    if what not in ANSWERS:
        raise InputError(f"what: found '{quoted(what)}', expected one of {', '.join(ANSWERS)}")
    return ANSWERS[what](request)
