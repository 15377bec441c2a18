"""What a benchmark is, whatever it measures, and where benchmarks are found."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol


@dataclass(frozen=True)
class Row:
    """A measurement.

    Attributes
    ----------
    solver, setting : str
        What was measured, and at which tolerance, size or number.
    error : float
        Largest over all output times and coordinates of all bodies, m or rad.
    seconds : float
        Median time of a solution.
    peer : bool
        Whether it is a yardstick beside this package.
    """

    solver: str
    setting: str
    error: float
    seconds: float
    peer: bool


class Benchmark(Protocol):
    """Something to measure."""

    @property
    def name(self) -> str: ...

    def measured(self) -> list[Row]:
        """The measurement as it is meant to be."""

    def glanced(self) -> list[Row]:
        """The same in small, for seconds rather than minutes: whether all works, not how fast."""


def families() -> dict[str, Sequence[Benchmark]]:
    """The benchmarks in the files of `tests.bench.problems` and of its folders, by the name of the file; the smallest comes first."""
    from . import problems as package

    modules = pkgutil.walk_packages(package.__path__, f"{package.__name__}.")
    files = {module.name.rpartition(".")[2]: module.name for module in modules if not module.ispkg}
    found = {name: importlib.import_module(files[name]).BENCHMARKS for name in sorted(files)}
    return {name: benchmarks for name, benchmarks in found.items() if benchmarks}  # scenes may be in no folder at hand
