"""Sections of a report, and that of the differences of two runs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import astuple, dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..elements.spatial.orientation import AXES
from ..evaluation.loads import loads
from ..evaluation.parameters import EVALUATION
from ..model.parts.definitions import shipped_part
from ..reading.files.yaml_text import Content
from ..results.displayed import displayed
from ..results.listings import Difference, differences
from ..results.scales import ROUNDING
from ..results.solution import Solution
from .curves import Curve, curve_chart
from .loads import Column

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Sheet

    from ..results.provenance import Provenance


@dataclass(frozen=True)
class Table:
    """Table: heads of columns, and rows of cells."""

    heads: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


@dataclass(frozen=True)
class Section:
    """Section: a title, sentences, tables, figures of matplotlib, and charts of a page as SVG."""

    title: str
    sentences: tuple[str, ...]
    tables: tuple[Table, ...] = ()
    figures: tuple[Sheet, ...] = ()
    drawings: tuple[str, ...] = ()


MOST_ROWS, MOST_FIGURES = 15, 3
"""Numbers of channels that are listed and drawn, those with the largest relative differences first."""
MISSING = "\N{EN DASH}"


def differences_section(solution: Solution, name: str, other: Solution, origin: Provenance | None = None) -> Section:
    """Return what was changed, the loads of both runs, and the largest differences of a run from another one.

    `name`: name of the other run. `origin`: that of the run, by default its own. Raises InputError if the runs have no
    channels or times in common.
    """
    found = sorted(differences(solution, other), key=lambda one: -np.nan_to_num(one.relative))
    unequal = [one for one in found if one.relative > ROUNDING]
    only = [
        f"{len(names)} channels are in {where} alone, such as {names[0]}."
        for where, names in (
            ("this run", [c for c in solution.channels if c not in other.channels]),
            (name, [c for c in other.channels if c not in solution.channels]),
        )
        if names
    ]
    head = f"{len(unequal)} of {len(found)} common channels differ from {name} by more than {ROUNDING:g} of their largest value."
    pair = displayed(solution), displayed(other, solution)
    rows = tuple(_row(one, *pair) for one in unequal[:MOST_ROWS])
    tables = (
        Table(("changed", "this run", name), tuple(changed_values(origin or solution.provenance, other.provenance))),
        Table(("peak of", "this run", name, "change", "unit"), tuple(_changed_loads(solution, other))),
        Table(("channel", "largest difference", "relative", "unit", "at (s)", "this run", name), rows),
    )
    charts = [
        curve_chart(
            [Curve(run_name, run.time, run.channels[one.channel]) for run_name, run in zip(("this run", name), pair, strict=True)],
            f"{one.channel}, {pair[0].unit(one.channel)}".rstrip(", "), "time, s",
        )
        for one in unequal[:MOST_FIGURES]
    ]  # fmt: skip
    lines = (f"Solid: this run. Dashed: {name}.",) if charts else ()
    spans = [f"{run.time[0]:.6g} s to {run.time[-1]:.6g} s" for run in (solution, other)]
    if spans[0] != spans[1]:
        lines = (f"Peaks are those of {spans[0]} in this run, and of {spans[1]} in {name}.", *lines)
    shown = tuple(table for table in tables if table.rows)
    return Section(f"Differences from {name}", (head, *only, *lines), shown, drawings=tuple(charts))


def energy_section(solution: Solution) -> Section | None:
    """Return the energies that elements exchange with the mechanism, the largest first; None if none does work.

    Energies that are rounding of those of the motion are not listed.
    """
    sizes = {
        name: max(abs(each.stored), each.supplied, each.dissipated) for name, each in solution.balance.elements.items()
    }
    largest = max(sizes.values(), default=0.0)
    least = EVALUATION.zero * max(largest, solution.balance.scale)
    if solution.balance.keeps_energy or not largest > least:
        return None
    column = Column.of("J", largest, solution.display)
    rows = tuple(
        (name, *(f"{value * column.factor:.4g}" for value in astuple(solution.balance.elements[name])))
        for name in sorted(sizes, key=lambda each: -sizes[each])
        if sizes[name] > least
    )
    heads = "element", *(f"{head}, {column.unit}" for head in ("stored", "supplied", "dissipated"))
    words = (
        "Stored: change of the potential energy. Supplied and dissipated: work of other forces while they drive the mechanism, "
        "and while they resist it."
    )
    unresolved = "Supplied and dissipated follow from the power at the output times, which must resolve the motion."
    sentences = (words,) if solution.balance.resolved else (words, unresolved)
    return Section("Energy of the elements", sentences, (Table(heads, rows),))


def changed_values(own: Provenance | None, other: Provenance | None) -> Iterator[tuple[str, str, str]]:
    """Yield each value of two scenes that differs, by its path, with its two texts.

    A missing value is a dash, and a missing parameter of a part the one of its definition.
    """
    if own is None or other is None:
        return
    scenes = own.scene, other.scene
    here, there = (dict(_leaves("", scene)) for scene in scenes)
    for path in {**here, **there}:
        pair = (here.get(path) or _of_part(scenes[0], path), there.get(path) or _of_part(scenes[1], path))
        if pair[0] != pair[1]:
            yield path, *pair


def _of_part(scene: Content, path: str) -> str:
    """Return the value that the definition of a part gives a parameter of its use, or a dash."""
    for name, entry in (scene.get("use") or {}).items():
        parameter = path.removeprefix(f"use.{name}.parameters.")
        part = entry.get("part") if isinstance(entry, Mapping) and parameter != path else None
        definition = (scene.get("parts") or {}).get(part) or shipped_part(str(part))
        known = (definition or {}).get("parameters")
        if not isinstance(known, Mapping):
            continue
        vector, _, component = parameter.rpartition("_")
        if parameter in known:
            return str(known[parameter])
        if vector in known and component in AXES:
            return str(known[vector][AXES.index(component)])
    return MISSING


def _leaves(path: str, value: object) -> Iterator[tuple[str, str]]:
    if isinstance(value, Mapping):
        for key, part in value.items():
            yield from _leaves(f"{path}.{key}".lstrip("."), part)
    else:
        yield path, f"{value:g}" if isinstance(value, float) else str(value)


def _changed_loads(solution: Solution, other: Solution) -> Iterator[tuple[str, ...]]:
    """Yield peaks of loads that differ between two runs, the largest first, in the unit of the largest."""
    here = {(load.element, load.unit): load.peak for load in loads(solution)}
    there = {(load.element, load.unit): load.peak for load in loads(other)}
    for element, unit in {**here, **there}:
        a, b = here.get((element, unit), 0.0), there.get((element, unit), 0.0)
        if abs(a - b) > ROUNDING * max(a, b):
            column = Column.of(unit, max(a, b), solution.display)
            change = f"{100 * (a - b) / b:+.3g} %" if b > 0 else MISSING
            yield element, f"{a * column.factor:.5g}", f"{b * column.factor:.5g}", change, column.unit


def _row(one: Difference, solution: Solution, other: Solution) -> tuple[str, ...]:
    factor = solution.display.of(Solution.unit(solution, one.channel))[1]
    values = (np.interp(one.t, run.time, run.channels[one.channel]) for run in (solution, other))
    return (
        one.channel, f"{one.largest * factor:.4g}", f"{one.relative:.2g}", solution.unit(one.channel), f"{one.t:.6g}",
        *(f"{value:.6g}" for value in values),
    )  # fmt: skip
