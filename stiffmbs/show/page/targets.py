"""Targets of metrics as text and as a section of a page of tests."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from ...studies.targets import Target
from ..sections import MISSING, Section, Table
from .page_of_tests import CHANGE, MINUS, Judgement, heads, written_unit

Targets = Mapping[str, Sequence[Target]]
"""Targets of each variant by name; a single one may have no name."""
MET, MISSED = "\N{CHECK MARK}", "\N{BALLOT X}"


def target_lines(targets: Sequence[Target]) -> Iterator[str]:
    """Yield a line for each target: its range, the values that were found, and whether it is met."""
    for each in targets:
        verdict = "met" if each.met else "missed"
        yield f"target {each.name} {_range(each)} {each.metric.unit}".rstrip() + f": {verdict}, found {_values(each)}"


def targets_as_dict(targets: Sequence[Target]) -> dict[str, object]:
    """Return targets for JSON, by name; a missing bound and a value without a number are null."""

    def number(value: float) -> float | None:
        return value if math.isfinite(value) else None

    return {
        each.name: {
            "low": number(each.low), "high": number(each.high), "unit": each.metric.unit, "met": each.met,
            "values": {side: number(value) for side, value in each.metric.values.items()},
        }
        for each in targets
    }  # fmt: skip


def with_targets(judged: Judgement, targets: Targets) -> Judgement:
    """Return the finding of a page with the targets that are missed first, or that all are met."""
    missed = {name: [each.name for each in of if not each.met] for name, of in targets.items()}
    count = sum(map(len, targets.values()))
    if not count:
        return judged
    if not any(missed.values()):
        return replace(
            judged, further=(*judged.further, "The target is met." if count == 1 else "All targets are met.")
        )
    names = (f"{', '.join(map(_worded, of))}{f' ({name})' if name else ''}" for name, of in missed.items() if of)
    number = sum(map(len, missed.values()))
    sentence = f"{number} of {count} targets {'is' if number == 1 else 'are'} missed: {'; '.join(names)}."
    return Judgement("doubt", "! Missed", sentence, (judged.sentence, *judged.further))


def target_sections(targets: Targets) -> Iterator[Section]:
    """Yield the section of the targets, if there are any: ranges, and the values of all variants."""
    first = next(iter(targets.values()), ())
    if not first:
        return
    names = [name for name in heads(list(targets)) if name != CHANGE]
    rows = []
    for k, each in enumerate(first):
        cells = [f"{_values(of[k])} {MET if of[k].met else MISSED}" if of else MISSING for of in targets.values()]
        numbers = (cell.replace("-", MINUS) for cell in (*cells, _range(each)))
        rows.append((_worded(each.name), *numbers, written_unit(each.metric.unit)))
    yield Section("Targets", (), (Table((*names[:-1], "range", "unit"), tuple(rows)),))


def _worded(name: str) -> str:
    """Return the name of a target in words: ``bump: toe``."""
    return name.replace(".", ": ", 1).replace("_", " ")


def _range(target: Target) -> str:
    low, high = (f"{bound:.6g}" for bound in (target.low, target.high))
    if math.isinf(target.low):
        return f"\N{LESS-THAN OR EQUAL TO} {high}"
    return f"\N{GREATER-THAN OR EQUAL TO} {low}" if math.isinf(target.high) else f"{low} to {high}"


def _values(target: Target) -> str:
    """Return the values of all sides, or one if they are alike."""
    shown = {side: f"{value:.4g}" for side, value in target.metric.values.items()}
    alike = len(set(shown.values())) == 1
    return next(iter(shown.values())) if alike else ", ".join(f"{side} {value}" for side, value in shown.items())
