"""Page of kinematics and compliance of an axle, of one or several variants (needs jinja2, of the extra ``report``)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ...results.files import write_text
from ...studies.suspension.kinematics_and_compliance import KinematicsAndCompliance
from ...studies.targets import Target
from ..curves import Curve, curve_chart
from ..sections import MISSING, Section, Table
from ..suspension import PANELS, ROUNDING, SHOWN, Panel, curves_of, kc_words, measure_rows, slope_rows, unit_of, worded
from .page_of_tests import Judgement, change, heads, page_of_tests, written_unit
from .targets import Targets, target_sections, with_targets

if TYPE_CHECKING:
    from ...results.provenance import Provenance

Variants = Mapping[str, KinematicsAndCompliance]
TITLES = {
    "bump": "Bump", "roll": "Roll", "steer": "Steering", "lateral": "Lateral force, outwards", "lateral_parallel": "Lateral force, to the left",
    "brake": "Braking", "traction": "Traction", "aligning": "Aligning torque, inwards", "aligning_parallel": "Aligning torque, to the left",
}  # fmt: skip
"""Titles of the load cases."""


def write_kc(
    path: Path, variants: Variants, origins: Mapping[str, Provenance | None], targets: Targets | None = None
) -> None:
    """Write the page, completely or not at all.

    `variants`: by name; a single one may have no name. `targets`: those of the variants; charts show the slopes of a range. Raises OSError if the file cannot be written.
    """
    first = next(iter(variants.values()))
    wanted = targets or {}
    slopes = {each.name: each for each in next(iter(wanted.values()), ())}
    cases = (_of_case(variants, case, slopes) for case in TITLES if _has(variants, case))
    sections = [*target_sections(wanted), _described(variants), *cases]
    page = page_of_tests(
        "Kinematics and compliance", f"{first.name}: {first.axle.title}", (), with_targets(_judged(variants), wanted), sections, origins
    )  # fmt: skip
    write_text(path, page)


def _has(variants: Variants, case: str) -> bool:
    return any(case in found.sweeps for found in variants.values())


def _judged(variants: Variants) -> Judgement:
    """Return the number of load cases, and whether both sides are alike."""
    first = next(iter(variants.values()))
    further = [f"{name}: {found.message}".removeprefix(": ") for name, found in variants.items()]
    cases = sum(_has(variants, case) for case in TITLES)
    words = f"{cases} load cases on a test rig, from minus to plus their amplitudes"
    if len(first.axle.wheels) == 2:
        largest = max(found.asymmetry() for found in variants.values())
        alike = (
            "left and right are alike"
            if largest < ROUNDING
            else f"left and right differ by up to {largest:.1e} of their curves"
        )
        words = f"{words}; {alike}"
    return Judgement("done", "\N{CHECK MARK} Completed", f"{words}.", (*further, *kc_words(first)))


def _described(variants: Variants) -> Section:
    tables = [measure_rows(found) for found in variants.values()]
    return Section("At the described heights", (), (_table(variants, tables, ""),))


def _of_case(variants: Variants, case: str, slopes: Mapping[str, Target]) -> Section:
    """Return the section of a load case: slopes of its curves at the described heights, and charts."""
    sweep = next(found.sweeps[case] for found in variants.values() if case in found.sweeps)
    rows = [[row for row in slope_rows(found) if row[0].startswith(f"{case}: ")] for found in variants.values()]
    tables = (_table(variants, rows, f"{case}: "),) if SHOWN[case] else ()
    charts = (chart for panel in PANELS if panel.case == case for chart in _charts(variants, panel, slopes))
    sentence = f"Over the {sweep.case.swept}, {written_unit(sweep.case.unit)}. Slopes at the middle."
    if len(next(iter(variants.values())).axle.wheels) == 2:
        sentence += " Solid: left, dotted: right."
    return Section(TITLES[case], (sentence,), tables, drawings=tuple(charts))


def _table(variants: Variants, tables: list[list[tuple[str, ...]]], start: str) -> Table:
    """Return the table of measures: all sides of one variant, or the left side, or axle, of several."""
    if len(tables) == 1:
        columns = [wheel.side for wheel in next(iter(variants.values())).axle.wheels]
        names = ("measure", *columns, *(("axle",) if len(columns) == 2 else ()), "unit")
        filled = [k for k, name in enumerate(names) if name != "axle" or any(row[k] for row in tables[0])]
        rows = [(worded(row[0].removeprefix(start)), *row[1:-1], written_unit(row[-1])) for row in tables[0]]
        return Table(tuple(names[k] for k in filled), tuple(tuple(row[k] for k in filled) for row in rows))
    by_name = [{row[0]: row for row in rows} for rows in tables]
    found = []
    for name in dict.fromkeys(name for rows in by_name for name in rows):
        cells = [
            next((cell for cell in rows[name][1:-1] if cell), MISSING) if name in rows else MISSING for rows in by_name
        ]
        values = [float(cell) if cell != MISSING else np.nan for cell in cells]
        unit = next(rows[name][-1] for rows in by_name if name in rows)
        found.append((worded(name.removeprefix(start)), *cells, *change(values), written_unit(unit)))
    return Table(("measure, left or axle", *heads(list(variants))[1:]), tuple(found))


def _charts(variants: Variants, panel: Panel, slopes: Mapping[str, Target]) -> Iterator[str]:
    """Yield a chart for each measure of a panel; a variant has one colour, its right side is dotted.

    `slopes`: targets of slopes by ``case.measure``, which are lines through the middle of the first curve.
    """
    first = next(iter(variants.values()))
    for name in panel.shown:
        curves = [
            _curve(panel, k, style, x, y)
            for k, found in enumerate(variants.values())
            if panel.case in found.sweeps
            for shown, style, x, y in curves_of(found, panel)
            if shown == name
        ]
        target = slopes.get(f"{panel.case}.{name}")
        if curves:
            curves += _range_of_slopes(curves[0], target, panel.upright) if target else ()
            own = f"{worded(name)}, {written_unit(unit_of(first, name))}".removesuffix(", ")
            case = next(found.sweeps[panel.case].case for found in variants.values() if panel.case in found.sweeps)
            other = (
                f"{worded(panel.over)}, {written_unit(unit_of(first, panel.over))}"
                if panel.over
                else f"{case.swept}, {written_unit(case.unit)}"
            )
            across, upwards = (own, other) if panel.upright else (other, own)
            yield curve_chart(curves, f"{panel.title}: {upwards}", across)


def _range_of_slopes(curve: Curve, target: Target, upright: bool) -> Iterator[Curve]:
    """Yield lines with the least and the largest slope of a target through the middle of a curve."""
    over, measure = (curve.y, curve.x) if upright else (curve.x, curve.y)
    middle = len(over) // 2
    for slope in (target.low, target.high):
        if np.isfinite(slope):
            line = measure[middle] + slope * (over - over[middle])
            x, y = (line, over) if upright else (over, line)
            yield Curve("", x, y, "path")


def _curve(panel: Panel, variant: int, style: str, x: np.ndarray, y: np.ndarray) -> Curve:
    """Return a curve without rounding, with wheel travel upwards if the panel asks for it."""
    across, upwards = (np.where(np.abs(part) > ROUNDING, part, 0.0) for part in ((y, x) if panel.upright else (x, y)))
    return Curve("", across, upwards, f"c{variant % 4}" + ("" if style == "-" else " other"))
