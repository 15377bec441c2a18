"""Report: a single page on a scene and its run (needs jinja2 and matplotlib, the extra ``report``)."""

from __future__ import annotations

import base64
import io
import math
from collections.abc import Sequence
from importlib.metadata import version
from importlib.resources import files
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..analyses.check import Report, check
from ..analyses.linearised.modes import modes
from ..describe.figure import Figure
from ..describe.scene import Scene
from ..errors import InputError, StiffmbsError
from ..results.energy_balance_notes import balance_words
from ..results.error_bars import UNKNOWN
from ..results.files import refuse_path, write_text
from ..results.scales import scales
from ..results.solution import Solution, channel_ranges
from .counters import solver_lines
from .digits import with_bar
from .drawing.derive import drawing_of
from .drawing.marks import marks_of
from .drawing.poses import poses_of
from .figure import drawn
from .force_table import SHOWN_AS_ZERO
from .joint_forces import joint_forces
from .modes import modes_text
from .page.data import page_data
from .page.moving import environment
from .page.parts import page_parts
from .sections import Section
from .step_history import step_history

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Sheet

NEEDED = ("jinja2", "matplotlib")
MOST_MODES = 40
"""Number of lines of modes."""
MOST_LINES = 5_000
"""Number of points above which a line drawing becomes a bitmap."""
ENERGIES = Figure(title="energy (J)", y=("energy.kinetic", "energy.potential", "energy.total"))


def check_report(path: Path) -> None:
    """Check that a report can be written, before anything is solved.

    Raises
    ------
    InputError
        If the suffix is not .html, or the folder or a package is missing.
    """
    refuse_path("-o", path, (".html",))
    for package in NEEDED:
        if find_spec(package) is None:
            raise InputError(f"-o {path}: found no {package}, expected it installed: pip install 'stiffmbs[report]'")


def write_report(
    path: Path, scene: Scene, solution: Solution, text: str = "", sections: Sequence[Section] = ()
) -> None:
    """Write the page to a file, completely or not at all.

    Parameters
    ----------
    path : Path
    scene : Scene
        Scene as it was solved.
    solution : Solution
        Its solution, with error bars if it was verified.
    text : str
        Text of the scene's file.
    sections : sequence of Section
        Additional sections.
    """
    page = report_page(scene, solution, text, sections)
    write_text(path, page)


@np.errstate(all="ignore")  # sums of a diverged run overflow
def report_page(scene: Scene, solution: Solution, text: str = "", sections: Sequence[Section] = ()) -> str:
    """Return the page as HTML, with its figures."""
    template = environment().from_string(files(__package__).joinpath("report.html").read_text(encoding="utf-8"))
    report = check(scene)
    figures = [drawn(solution, scene.figure)] if scene.figure else []
    figures.append(drawn(solution, ENERGIES))
    if len(solution.step_times) > 1:
        figures.append(step_history(solution.history))
    points = len(solution.time) + len(solution.step_times)
    return template.render(
        solution=solution, check=report, settings=_settings(scene), peaks=_peaks(solution),
        start=float(solution.time[0]), end=float(solution.time[-1]), energy=balance_words(solution.balance, float(solution.channels["energy.total"][0])),
        figures=[_embedded(sheet, points) for sheet in figures], version=version("stiffmbs"),
        sections=[(section, [_embedded(sheet, 0) for sheet in section.figures]) for section in sections],
        counted=[f"{label}: {text}" for label, text in solver_lines(solution.solver)], violation=float(np.nanmax(solution.channels["constraint.position"])),
        forces=joint_forces(solution), modes=_modes(scene), text=text, moving=_moving(scene, solution, report), **page_parts(),
    )  # fmt: skip


def _moving(scene: Scene, solution: Solution, report: Report) -> dict[str, str]:
    """Return the page data of the moving mechanism, with its channels."""
    shown = scene.figure.y if scene.figure else ()
    drawing = drawing_of(scene, marks_of(report))
    return page_data(drawing, {"": poses_of(scene, solution.time, solution.channels)}, solution, shown)


def _modes(scene: Scene) -> list[str]:
    """Return natural modes about the start as lines of a table, the slowest first, or the reason why there are none."""
    try:
        lines = modes_text(modes(scene)).splitlines()
    except StiffmbsError as error:
        return [f"no modes: {error}"]
    left = len(lines) - MOST_MODES
    return lines if left <= 0 else [*lines[:MOST_MODES], f"and {left} more lines: stiffmbs modes"]


def _settings(scene: Scene) -> dict[str, Any]:
    """Return every setting, those of the scene first."""
    chosen = {
        name: getattr(scene.run, name) for name in type(scene.run).model_fields if name in scene.run.model_fields_set
    }
    return {**chosen, **{name: value for name, value in scene.run if name not in chosen}}


def _peaks(solution: Solution) -> list[dict[str, str]]:
    """Return a row for each channel: its least and greatest value with bars and times, and its error over time."""
    rows = []
    sizes = scales(solution.channels, 1.0, solution.requested)
    for name, cell in channel_ranges(solution).items():
        bar, noise = solution.errors.get(name, UNKNOWN), SHOWN_AS_ZERO * sizes[name]
        verified = name in solution.errors
        rows.append(
            {
                "name": name,
                "unit": solution.unit(name),
                "min": with_bar(cell["min"], bar.least, noise) if verified else f"{cell['min']:.6g}",
                "max": with_bar(cell["max"], bar.greatest, noise) if verified else f"{cell['max']:.6g}",
                "t_min": f"{cell['t_min']:.6g}",
                "t_max": f"{cell['t_max']:.6g}",
                "error": "" if math.isnan(bar.over_time) else f"{bar.over_time:.1g}",
                "mark": "*" if name in solution.not_unique else "",
            }
        )
    return rows


def _embedded(sheet: Sheet, points: int) -> str:
    """Return a figure as a data URL."""
    form = "svg" if points < MOST_LINES else "png"
    content = io.BytesIO()
    sheet.savefig(content, format=form, dpi=110, metadata={"Date": None} if form == "svg" else None)
    kind = {"svg": "image/svg+xml", "png": "image/png"}[form]
    return f"data:{kind};base64,{base64.b64encode(content.getvalue()).decode('ascii')}"
