"""The table of cases and outcomes, for a terminal and for the documentation."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence

from .catalogue import Row

SHOWN = 160
"""Characters of a detail that the table shows."""


def line(row: Row) -> str:
    """A row as one line of text."""
    verdict = row.verdict
    error = "" if math.isnan(verdict.error) else f"{verdict.error:.1e} of {verdict.allowed:.0e}"
    name = f"{row.family}: {row.case.name}"
    return f"{verdict.outcome.value:6} {name:62} {error:18} {row.seconds:6.2f} s  {_short(verdict.detail)}"


def as_json(row: Row) -> str:
    """A row as one JSON object on one line; numbers that are none become null."""
    content = row.as_dict()
    found = {key: None if isinstance(v, float) and not math.isfinite(v) else v for key, v in content.items()}
    return json.dumps(found, allow_nan=False)


def summary(rows: Sequence[Row]) -> str:
    """How many cases had which outcome."""
    counts: dict[str, int] = {}
    for row in rows:
        counts[row.verdict.outcome.value] = counts.get(row.verdict.outcome.value, 0) + 1
    listed = ", ".join(f"{count} {outcome}" for outcome, count in counts.items())
    return f"{len(rows)} cases: {listed}" if rows else "no cases"


def _short(text: str) -> str:
    return text if len(text) <= SHOWN else f"{text[: SHOWN - 3]}..."
