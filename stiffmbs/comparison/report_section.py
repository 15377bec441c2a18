"""Comparison as a section of a report."""

from __future__ import annotations

from ..show.sections import Section, Table
from .compare import Comparison
from .table import BETTER, BETTER_WORDS, failures, milliseconds


def comparison_section(comparison: Comparison) -> Section:
    """Return a section with times at equal errors, the reference, the conclusion, and the figure."""
    at = comparison.at_errors
    names = dict.fromkeys(name for one in at for name in one.seconds)
    rows = [
        [
            name,
            *(
                milliseconds(one.seconds[name]) + BETTER * (name in one.better) if name in one.seconds else ""
                for one in at
            ),
        ]
        for name in names
    ]
    sentences = [
        f"Median times of the integration, ms, by the error in {comparison.measure}.",
        *([BETTER_WORDS] if any(one.better for one in at) else []),
        *comparison.reference.sentences(), *failures(comparison.rows), comparison.conclusion,
    ]  # fmt: skip
    table = Table(("solver", *(f"{one.error:.0e}" for one in at)), tuple(tuple(row) for row in rows))
    return Section("Solvers compared", tuple(sentences), (table,), (comparison.plot(),))
