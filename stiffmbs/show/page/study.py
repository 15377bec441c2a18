"""Page of a study: ranges of its outputs, charts over the varied values, and all cases (needs jinja2, of the extra ``report``)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ...results.files import write_text
from ...studies.data_set import MESSAGE, STATUS, as_dict, numbers, varied
from ..curves import Curve, curve_chart
from ..loads_shown import MOST_CURVES
from ..sections import MISSING, Section, Table
from .page_of_tests import Judgement, page_of_tests

if TYPE_CHECKING:
    import xarray

    from ...results.provenance import Provenance

Case = Mapping[str, Any]
MOST_CASES = 200
"""Largest number of cases in the table of all cases."""


def write_study(path: Path, data: xarray.Dataset, origin: Provenance | None) -> None:
    """Write the page of a study, completely or not at all.

    `data`: result of a study, as `stiffmbs.studies.data_set.data_set` returns it. Raises OSError if the file cannot be written.
    """
    cases: list[Case] = as_dict("", data)["cases"]
    names, outputs = varied(data), numbers(data)
    facts = [("Cases", str(len(cases))), *((name, _span([case[name] for case in cases])) for name in names)]
    x, of_curve = _curves(cases, names)
    charts = [chart for output in outputs for chart in _charts(cases, names, output, x, of_curve)]
    sections = [
        Section("Outputs", ("In SI units.",), (_ranges(cases, names, outputs),), drawings=tuple(charts)),
        _table_of_cases(cases, names, outputs),
    ]
    keys = list(of_curve) if 1 < len(of_curve) <= MOST_CURVES else [""]
    page = page_of_tests("Study", str(data.attrs.get("title", "")), facts, _judged(cases), sections, {"": origin}, keys)
    write_text(path, page)


def _span(values: Sequence[Any]) -> str:
    """Return the values of a parameter in words."""
    distinct = list(dict.fromkeys(map(_text, values)))
    return ", ".join(distinct) if len(distinct) <= MOST_CURVES else f"{_text(min(values))} to {_text(max(values))}"


def _text(value: object) -> str:
    if value is None:
        return MISSING
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _judged(cases: Sequence[Case]) -> Judgement:
    failed = [case for case in cases if case[STATUS] != "done"]
    if not failed:
        return Judgement("done", "\N{CHECK MARK} Completed", f"All {len(cases)} cases were solved.")
    reason = f"Case {failed[0]['case']}: {failed[0][MESSAGE]}"
    return Judgement("doubt", "! Incomplete", f"{len(failed)} of {len(cases)} cases were not solved.", (reason,))


def _ranges(cases: Sequence[Case], names: Sequence[str], outputs: Sequence[str]) -> Table:
    """Return the least and greatest value of each output with the values of the parameters there."""
    rows = []
    for output in outputs:
        known = [case for case in cases if case[output] is not None]
        cells = []
        for extreme in (min, max) if known else ():
            at = extreme(known, key=lambda case: case[output])
            cells += [_text(at[output]), ", ".join(f"{name} {_text(at[name])}" for name in names)]
        rows.append((output, *(cells or [MISSING] * 4)))
    return Table(("output", "least", "at", "greatest", "at"), tuple(rows))


def _curves(cases: Sequence[Case], names: Sequence[str]) -> tuple[str, dict[str, list[Case]]]:
    """Return the parameter with the most values, and the cases by the values of the others; no parameter if it is no number."""
    counts = {
        name: len({_text(case[name]) for case in cases}) for name in names if isinstance(cases[0][name], float | int)
    }
    x = max(counts, key=lambda name: counts[name], default="")
    found: dict[str, list[Case]] = {}
    for case in cases:
        found.setdefault(", ".join(f"{name} {_text(case[name])}" for name in names if name != x), []).append(case)
    return x, found


def _charts(
    cases: Sequence[Case], names: Sequence[str], output: str, x: str, of_curve: Mapping[str, list[Case]]
) -> Iterator[str]:
    """Yield the charts of an output: curves over one parameter for a grid of few values, else points over each parameter."""
    known = [case for case in cases if case[output] is not None]
    if x and known and len(of_curve) <= MOST_CURVES:
        curves = []
        for k, part in enumerate(of_curve.values()):
            rows = sorted(part, key=lambda case: case[x])
            curves.append(Curve("", _column(rows, x), _column(rows, output), f"c{k}"))
        yield curve_chart(curves, output, x, includes_zero=False)
        return
    for name in names:
        if known and isinstance(known[0][name], float | int):
            points = np.array([[case[name], case[output]] for case in known], dtype=float)
            yield curve_chart([], output, name, marks=points, includes_zero=False)


def _column(cases: Sequence[Case], name: str) -> np.ndarray:
    """Return a value of all cases; nan where it is missing."""
    return np.array([np.nan if case[name] is None else case[name] for case in cases], dtype=float)


def _table_of_cases(cases: Sequence[Case], names: Sequence[str], outputs: Sequence[str]) -> Section:
    rows = tuple(
        (str(case["case"]), *(_text(case[name]) for name in (*names, *outputs)), str(case[STATUS]))
        for case in cases[:MOST_CASES]
    )
    left = len(cases) - MOST_CASES
    sentences = (f"The first {MOST_CASES} of {len(cases)} cases; a table (-o X.csv) has all.",) if left > 0 else ()
    return Section("Cases", sentences, (Table(("case", *names, *outputs, STATUS), rows),))
