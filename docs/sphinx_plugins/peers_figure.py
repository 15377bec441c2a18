"""Draw the run time against error of this package and other programs, for the README and the landing page.

    python docs/sphinx_plugins/peers_figure.py

It draws ``docs/_static/andrews.svg`` from ``docs/peers.jsonl``, which ``python -m tests.bench andrews --peers --json`` prints.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from math import floor, log10
from pathlib import Path

from themed_svg import label, line, path, picture, spread

DOCS = Path(__file__).parents[1]
sys.path.insert(0, str(DOCS.parent))

from tests.bench.benchmark import Row  # noqa: E402
from tests.bench.report import read_json  # noqa: E402
from tests.bench.sweep import at_target_rows  # noqa: E402

TARGET, PROBLEM = DOCS / "_static" / "andrews.svg", "andrews"
NAMES = {
    "auto": "stiffmbs auto", "bdf": "stiffmbs bdf", "SciPy DOP853": "SciPy DOP853*", "SciPy LSODA": "SciPy LSODA*",
    "SciPy Radau": "SciPy Radau*", "CasADi IDAS index 1": "CasADi IDAS", "Exudyn generalised-alpha": "Exudyn gen.-alpha",
}  # fmt: skip
"""Solvers that are drawn, and their labels; a star marks minimal equations, without joint forces."""
WIDTH, HEIGHT = 640, 340
LEFT, RIGHT, TOP, BOTTOM = 52, 500, 34, 286
LINE = 17.0
"""Least distance of labels, pixels."""
RULES = """\
.own { stroke: var(--own); stroke-width: 3 } .peer { stroke: var(--peer); stroke-width: 1.4 }
text.own { fill: var(--own); stroke: none; font-weight: 700 } text.peer { fill: var(--soft); stroke: none }
.dashed { stroke-dasharray: 6 5 }
"""


def figure(rows: Sequence[Row]) -> str:
    """Return the figure as SVG, from rows with a time at each decade of error."""
    times = {
        name: {row.error: row.seconds * 1e3 for row in at_target_rows(rows) if row.solver == name} for name in NAMES
    }
    errors = sorted({error for found in times.values() for error in found}, reverse=True)
    values = [time for found in times.values() for time in found.values()]
    low, high = floor(log10(min(values))), log10(max(values))

    def place(error: float, time: float) -> tuple[float, float]:
        across = log10(errors[0] / error) / log10(errors[0] / errors[-1])
        return LEFT + (RIGHT - LEFT) * across, BOTTOM - (BOTTOM - TOP) * (log10(time) - low) / (high - low)

    def content() -> Iterator[str]:
        yield label(0, 15, "processor time, ms", "strong")
        for power in range(low, floor(high) + 1):
            y = place(errors[0], 10.0**power)[1]
            yield line(LEFT, y, RIGHT, y, "grid")
            yield label(LEFT - 8, y + 5, f"{10.0**power:g}", "soft", "end")
        yield line(LEFT, BOTTOM, RIGHT, BOTTOM, "axis")
        for error in errors:
            yield label(place(error, 1.0)[0], BOTTOM + 20, f"1e\N{MINUS SIGN}{-log10(error):.0f}", "soft", "middle")
        yield label(RIGHT, BOTTOM + 42, "largest error of an angle, rad (smaller to the right)", "soft", "end")
        for name, found in reversed(times.items()):
            yield path((place(*pair) for pair in found.items()), _kind(name))
        ends = {name: place(*list(found.items())[-1]) for name, found in times.items()}
        for (name, (x, _)), y in zip(ends.items(), spread((end[1] for end in ends.values()), LINE), strict=True):
            yield label(x + 8, y + 5, NAMES[name], _kind(name))

    return picture(WIDTH, HEIGHT, "Processor time over error of Andrews' squeezing mechanism", RULES, content())


def _kind(name: str) -> str:
    return {"auto": "own", "bdf": "own dashed"}.get(name, "peer")


if __name__ == "__main__":
    measured = read_json((DOCS / "peers.jsonl").read_text(encoding="utf-8"))
    TARGET.write_text(figure(measured[PROBLEM]), encoding="utf-8")
    print(TARGET, TARGET.stat().st_size)
