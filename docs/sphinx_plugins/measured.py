"""Tables and figures of measured times, made from what ``python -m tests.bench --json`` printed."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from as_rst import nodes_of
from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from tests.bench.benchmark import Row
from tests.bench.report import OWN, REFERENCE, read_json
from tests.bench.sweep import at_target_rows

PEER = "SciPy DOP853, minimal"
HEAD = (
    "problem",
    "yardstick, ms",
    "bdf without presolve",
    "ratio",
    "bdf",
    "ratio",
    "dop853",
    PEER,
    "auto",
    "to the better",
)

PLOT = """\
.. plot::
   :include-source: false
   :filename-prefix: measured_{problem}
   :alt: run time over error, {problem}

   from pathlib import Path
   from matplotlib import pyplot
   from tests.bench.figure import draw_rows
   from tests.bench.report import read_json

   rows = read_json(Path("{path}").read_text(encoding="utf-8"))
   draw_rows(pyplot.figure().add_subplot(), "{problem}", rows["{problem}"])
"""


class MeasuredTimes(SphinxDirective):
    """A table of the times at an error of 1e-6, with their ratios to the yardstick, a line for each problem of a file."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        text = _text(self, self.arguments[0])
        table = [HEAD, *(_line(problem, rows) for problem, rows in read_json(text).items())]
        rows = "\n".join("   * - " + "\n     - ".join(line) for line in table)
        return nodes_of(self, f".. list-table::\n   :header-rows: 1\n\n{rows}\n")


class MeasuredFigures(SphinxDirective):
    """Run time over error: a file, and the names of problems in it."""

    required_arguments, optional_arguments = 2, 100

    def run(self) -> list[nodes.Node]:
        file, *problems = self.arguments
        _text(self, file)
        path = Path(Path(self.env.srcdir).name, file).as_posix()
        return nodes_of(self, "\n".join(PLOT.format(problem=problem, path=path) for problem in problems))


def _text(directive: SphinxDirective, file: str) -> str:
    path = Path(directive.env.srcdir, file)
    directive.env.note_dependency(str(path))
    return path.read_text(encoding="utf-8")


def _line(problem: str, rows: list[Row]) -> tuple[str, ...]:
    """The cells of a problem: times in ms, and ratios."""
    at = {row.solver: row.seconds for row in at_target_rows(rows)}
    better = min(at[solver] for solver in OWN if solver in at)

    def time(solver: str) -> str:
        return f"{at[solver] * 1e3:.3g}" if solver in at else ""

    def ratio(solver: str, base: float) -> str:
        return f"{at[solver] / base:.2f}" if solver in at else ""

    yardstick, whole = at[REFERENCE], "bdf without presolve"
    return (
        problem, time(REFERENCE), time(whole), ratio(whole, yardstick), time("bdf"), ratio("bdf", yardstick), time("dop853"),
        time(PEER), time("auto"), ratio("auto", better),
    )  # fmt: skip


def setup(app: Sphinx) -> dict[str, Any]:
    app.add_directive("measured-times", MeasuredTimes)
    app.add_directive("measured-figures", MeasuredFigures)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
