"""Page of tests of one or several variants of a scene: a finding, tables of metrics, and charts."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from typing import TYPE_CHECKING

import numpy as np

from ..origin import origin_section
from ..sections import MISSING, Section, Table, changed_values
from .data import environment, page_file

if TYPE_CHECKING:
    from ...results.provenance import Provenance

PLAIN = {ord("\N{MINUS SIGN}"): "-", ord("\N{NO-BREAK SPACE}"): " ", ord("\N{EN DASH}"): "-"}
"""Characters of pages and those of any terminal in their place."""
MINUS = "\N{MINUS SIGN}"
CHANGE = "change"
"""Head of the column of changes from the first to the second variant."""


@dataclass(frozen=True)
class Judgement:
    """Finding of a page of tests; `status` as of a `Finding`."""

    status: str
    mark: str
    sentence: str
    further: tuple[str, ...] = ()


def page_of_tests(
    kind: str, title: str, facts: Iterable[tuple[str, str]], judged: Judgement, sections: Sequence[Section],
    origins: Mapping[str, Provenance | None], keys: Sequence[str] = (),
) -> str:  # fmt: skip
    """Return the page as HTML.

    `kind`: the tests, above the title. `facts`: pairs of a name and a value. `origins`: those of the variants by name; a
    single one may have no name. `keys`: names of the curves of
    all charts, by default the variants.
    """
    first = next(iter(origins.values()))
    return environment().from_string(page_file("tests.html")).render(
        kind=kind, title=title, facts=facts, status=judged.status, mark=judged.mark, sentence=judged.sentence, further=judged.further,
        variants=keys or list(origins), changed=_changed(origins), sections=sections, sheet=page_file("report.css"), version=version("stiffmbs"),
        origin_section=origin_section(first) if first else "",
    )  # fmt: skip


def _changed(origins: Mapping[str, Provenance | None]) -> Table:
    """Return the values of the scenes that differ between variants."""
    first, *others = origins.values()
    rows: dict[str, list[str]] = {}
    for k, other in enumerate(others):
        for path, own, text in changed_values(first, other):
            rows.setdefault(path, [own] * len(origins))[k + 1] = text
    return Table(("changed", *origins), tuple((path, *texts) for path, texts in rows.items()))


def heads(variants: Sequence[str]) -> tuple[str, ...]:
    """Return the heads of a table of metrics."""
    names = variants if len(variants) > 1 else ("value",)
    return ("metric", *names, *((CHANGE,) if len(variants) == 2 else ()), "unit")


def change(values: Sequence[float]) -> Iterator[str]:
    """Yield the change from the first of two values to the second, in percent; nothing for another number of values.

    Of values of different signs, it is their difference: a part of a value near zero has no meaning.
    """
    if len(values) == 2:
        a, b = values
        if not (np.isfinite(a) and np.isfinite(b)):
            yield MISSING
        elif a * b > 0:
            part = 100 * (b - a) / abs(a)
            yield f"{f'{part:+.1f}' if abs(part) >= 0.05 else '0'}\N{NO-BREAK SPACE}%".replace("-", MINUS)
        else:
            yield (f"{b - a:+.3g}" if a != b else "0").replace("-", MINUS)


def compared_lines(variants: Mapping[str, Sequence[tuple[str, str, str]]]) -> list[str]:
    """Return a table of the metrics that differ between variants, as lines.

    `variants`: rows of name, value and unit of each variant, by its name.
    """
    values = {name: {metric: value for metric, value, _ in rows} for name, rows in variants.items()}
    units = {metric: unit for rows in variants.values() for metric, _, unit in rows}
    table = [("compared", *heads(list(variants))[1:])]
    for metric, unit in units.items():
        cells = [of_one.get(metric, MISSING) for of_one in values.values()]
        if len({*cells}) > 1:
            table.append((metric, *cells, *change([_number(cell) for cell in cells]), unit))
    table = [tuple(cell.translate(PLAIN) for cell in row) for row in table]
    widths = [max(map(len, column)) for column in zip(*table, strict=True)]
    return [
        "  ".join((name.ljust(widths[0]), *map(str.rjust, numbers, widths[1:]), unit)).rstrip()
        for name, *numbers, unit in table
    ]


def _number(cell: str) -> float:
    """Return the number in a cell; nan for words."""
    try:
        return float(cell)
    except ValueError:
        return float("nan")


def written_unit(unit: str) -> str:
    """Return a unit with raised powers: m/s²."""
    return unit.replace("^2", "\N{SUPERSCRIPT TWO}").replace("^3", "\N{SUPERSCRIPT THREE}")
