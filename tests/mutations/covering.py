"""Tests that execute a line, from a coverage file with contexts.

The file comes from ``python -m pytest --cov=stiffmbs --cov-context=test --cov-report=`` (package pytest-cov) with an empty cache
of compiled equations, so that the equations of elements are executed.  Compiled routines are not seen by coverage.
"""

from __future__ import annotations

from pathlib import Path

from .areas import Area
from .operators import Mutation

MOST_TESTS = 60
"""Number of covering tests that are run, those of the area first."""


class Covering:
    """The tests that execute each line.

    Parameters
    ----------
    file : Path
        A coverage file with contexts.
    """

    def __init__(self, file: Path) -> None:
        from coverage import CoverageData

        self._data = CoverageData(basename=str(file))
        self._data.read()
        self._files = {
            name[name.rindex("/stiffmbs/") + 1 :]: name for name in self._data.measured_files() if "/stiffmbs/" in name
        }
        self._lines: dict[str, dict[int, list[str]]] = {}

    def tests(self, mutation: Mutation, area: Area) -> tuple[str, ...]:
        """Return the tests to run for a mutation: those that execute its line, or the area's where none is known to."""
        if mutation.path not in self._files:
            return area.tests
        if mutation.path not in self._lines:
            self._lines[mutation.path] = self._data.contexts_by_lineno(self._files[mutation.path])
        contexts = self._lines[mutation.path].get(mutation.line, [])
        found = sorted({context.partition("|")[0] for context in contexts} - {""})
        near = [test for test in found if test.startswith(area.tests)]
        spread = [test for test in found if test not in set(near)]
        chosen = [*_spread(near), *_spread(spread)][:MOST_TESTS]
        return tuple(chosen) or area.tests


def _spread(tests: list[str]) -> list[str]:
    """Return tests in turns from their files, so that the first ones come from many files."""
    turns: dict[str, int] = {}
    order = []
    for test in tests:
        file = test.partition("::")[0]
        turns[file] = turns.get(file, 0) + 1
        order.append((turns[file], test))
    return [test for _, test in sorted(order)]
