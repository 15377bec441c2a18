"""Report: a single page on a scene and its run (needs jinja2 and matplotlib, the extra ``report``).

The page begins with its finding, and with the loads of joints and force elements.  How it was computed is at its end.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..analyses.check import check
from ..analyses.linearised.modes import NO_EQUILIBRIUM, modes
from ..errors import InputError, StiffmbsError
from ..evaluation.loads import loads, unloaded
from ..evaluation.parameters import EVALUATION
from ..model.scene import Figure, Scene
from ..notes import Note
from ..reading.units.quantity import LARGEST
from ..results.displayed import displayed
from ..results.energy_balance_notes import balance_words
from ..results.error_bars import UNKNOWN
from ..results.files import write_text
from ..results.provenance import provenance_of
from ..results.scales import scales
from ..results.solution import Solution, channel_ranges
from ..results.verification_words import verification_outcome
from ..solve.trajectory import History
from .curves import Curve, curve_chart
from .drawing.derive import drawing_of
from .drawing.draw import marks_of
from .drawing.poses import Poses, poses_of
from .figure import drawn
from .finding import finding, note_rows
from .force_table import with_bar
from .html import MOST_ROWS
from .loads_shown import MOST_CURVES, Chart, loads_shown
from .origin import origin_section
from .page.data import environment, page_data, page_file, page_parts
from .page.modes import modes_data
from .sections import Section, differences_section, energy_section
from .style import COLORS, data_url, dress, new_sheet
from .summary import solver_lines
from .verdict import verdict

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Sheet

MOST_LINES = 5_000
"""Number of points above which a line drawing becomes a bitmap."""
ENERGIES = Figure(title="energy", y=("energy.kinetic", "energy.potential", "energy.total"))


def write_report(
    path: Path, scene: Scene, solution: Solution, text: str = "", sections: Sequence[Section] = (),
    other: tuple[str, Solution] | None = None,
) -> None:  # fmt: skip
    """Write the page to a file, completely or not at all.

    The scene is the one that was solved, and `text` that of its file. The solution has error bars if it was verified.
    `sections` are additional ones. With `other`, the name and solution of another run, the page begins with the
    differences and shows both motions. InputError if that run has no channels or times in common with this one.
    """
    write_text(path, report_page(scene, solution, text, sections, other))


@np.errstate(all="ignore")  # sums of a diverged run overflow
def report_page(
    scene: Scene, solution: Solution, text: str = "", sections: Sequence[Section] = (),
    other: tuple[str, Solution] | None = None,
) -> str:  # fmt: skip
    """Return the page as HTML, with its figures; parameters and errors as for `write_report`."""
    template, sheet = (page_file(f"report.{end}") for end in ("html", "css"))
    report, judged, origin = check(scene), verdict(solution), solution.provenance or provenance_of(scene)
    carried = loads(solution)
    figures = relevant_figures(solution, scene.figure)
    charts = [chart for figure in figures if is_charted(figure) for chart in figure_charts(solution, figure)]
    sheets = [drawn(solution, figure) for figure in figures if not is_charted(figure)]
    steps = [step_history(solution.history)] if len(solution.step_times) > 1 else []
    first = [differences_section(solution, *other, origin)] if other else []
    poses, shown = poses_of(scene, solution.time, solution.channels), scene.figure.y if scene.figure else ()
    moving = page_data(drawing_of(scene, marks_of(report), along=poses), _motions(scene, poses, other), solution, shown)
    lines, shapes = _modes(scene)
    chosen = scene.run.model_fields_set  # shown first
    settings = dict(sorted(scene.run, key=lambda field: field[0] not in chosen))
    points = len(solution.time) + len(solution.step_times)
    parts, energies = page_parts(), energy_section(solution)
    return environment().from_string(template).render(
        title=solution.name or "Model", origin=origin, origin_section=origin_section(origin, text), sheet=sheet,
        solution=solution, verdict=judged, finding=finding(judged, solution, carried), check=report, settings=settings,
        peaks=_peaks(solution), energy=balance_words(solution.balance, float(solution.channels["energy.total"][0])),
        charts=charts, figures=[_embedded(sheet, points) for sheet in sheets], figure_title=figures[0].title if figures else "", own_figure=scene.figure is not None, version=version("stiffmbs"),
        sections=_with_figures([*sections, *([energies] if energies else [])]), first=_with_figures(first), steps=[_embedded(figure, points) for figure in steps],
        counted=[f"{label}: {text}" for label, text in solver_lines(solution.solver)], violation=float(np.nanmax(solution.channels["constraint.position"])),
        **loads_shown(scene, solution, carried), unloaded=unloaded(solution, carried), notes=note_rows(solution.notes), modes=lines, moving=moving, modes_moving=shapes,
        verified=verification_outcome(solution.verification), **parts,
    )  # fmt: skip


def _with_figures(sections: Sequence[Section]) -> list[tuple[Section, list[str]]]:
    return [(section, [_embedded(sheet, 0) for sheet in section.figures]) for section in sections]


def _motions(scene: Scene, poses: Poses, other: tuple[str, Solution] | None) -> dict[str, Poses]:
    """Return the motions that are drawn over each other; another run only if it has the same bodies."""
    if other is None:
        return {"": poses}
    try:
        return {"this run": poses, other[0]: poses_of(scene, other[1].time, other[1].channels)}
    except (InputError, KeyError):
        return {"": poses}


def relevant_figures(solution: Solution, own: Figure | None) -> list[Figure]:
    """Return the figure of the scene, or the energies if it has none and they change by work."""
    if own is not None:
        return [own]
    return [] if solution.balance.keeps_energy else [ENERGIES]


def _modes(scene: Scene) -> tuple[list[str], dict[str, str] | None]:
    """Return natural modes about the start as lines of a table, and their motion; nothing if it is no equilibrium."""
    try:
        found = modes(scene)
    except StiffmbsError:
        return [], None
    if any(Note.of(note).kind == NO_EQUILIBRIUM.name for note in found.notes):
        return [], None
    lines = found.table().splitlines()
    left = len(lines) - MOST_ROWS
    shown = lines if left <= 0 else [*lines[:MOST_ROWS], f"and {left} more lines: stiffmbs modes"]
    return shown, modes_data(found)


def _peaks(solution: Solution) -> list[dict[str, str]]:
    """Return a row for each channel: its least and greatest value with bars and times, and its error over time."""
    rows = []
    sizes = scales(solution.channels, 1.0, solution.requested)
    shown = displayed(solution)
    for name, cell in channel_ranges(shown).items():
        bar, noise = (
            shown.errors.get(name, UNKNOWN),
            EVALUATION.zero * sizes[name] * solution.display.of(solution.unit(name))[1],
        )
        verified = name in solution.errors
        rows.append(
            {
                "name": name,
                "unit": shown.unit(name),
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
    """Return a figure as a data URL; above many points a line drawing becomes a bitmap."""
    return data_url(sheet, "svg" if points < MOST_LINES else "png", 110)


def step_history(history: History) -> Sheet:
    """Plot the step length over time on a logarithmic axis, and below it the order if known."""
    has_orders = len(history.order) == len(history.t)
    sheet = new_sheet((8, 5 if has_orders else 3))
    lengths = np.diff(history.t)
    rows = sheet.subplots(
        2 if has_orders else 1, sharex=True, squeeze=False, height_ratios=[2, 1] if has_orders else None
    )[:, 0]
    shown = lengths > 0
    rows[0].plot(history.t[1:][shown], lengths[shown], ".", color=COLORS[0], markersize=2)
    rows[0].set_yscale("log")
    dress(rows[0], ylabel="step (s)", title="steps of the solver")
    if has_orders:
        rows[1].plot(history.t, history.order, ".", color=COLORS[0], markersize=2)
        dress(rows[1], ylabel="order")
    rows[-1].set_xlabel("time (s)")
    return sheet


def is_charted(figure: Figure) -> bool:
    """Return True if a figure can be drawn by charts: no path in space, no equal scales."""
    return not figure.z and not figure.equal


def figure_charts(solution: Solution, figure: Figure) -> Iterator[Chart]:
    """Yield the charts of a figure: channels of one unit over time or over another channel, a few in each chart.

    Raises InputError if there is no such channel.
    """
    run = displayed(solution)
    x = run.time if figure.x == "time" else _known(run[figure.x])
    of_unit: dict[str, list[str]] = {}
    for channel in figure.y:
        of_unit.setdefault(run.unit(channel), []).append(channel)
    for unit, channels in of_unit.items():
        for first in range(0, len(channels), MOST_CURVES):
            names = channels[first : first + MOST_CURVES]
            quantity = names[0] if len(names) == 1 else figure.title or "channels"
            curves = [Curve(name, x, _known(run[name])) for name in names]
            yield Chart(
                curve_chart(
                    curves, _labelled(quantity, unit), _labelled(figure.x, run.unit(figure.x)), includes_zero=False
                ),
                tuple(names),
            )


def _known(values: np.ndarray) -> np.ndarray:
    """Return values without those of a diverged run."""
    return np.where(np.abs(values) < LARGEST, values, np.nan)


def _labelled(quantity: str, unit: str) -> str:
    return f"{quantity}, {unit}" if unit else quantity
