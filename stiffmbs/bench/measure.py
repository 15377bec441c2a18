"""What a benchmark is: rows of error and time, medians of runs that take turns."""

from __future__ import annotations

import importlib
import os
import pkgutil
import platform
import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from importlib.metadata import version
from typing import Any


@dataclass(frozen=True)
class Contestant:
    """One way to solve a problem.

    Attributes
    ----------
    solver, setting : str
        What it is and how it is set.
    peer : bool
        Whether it is a yardstick beside this package.
    solve : callable
        Does the whole integration and returns its error.
    """

    solver: str
    setting: str
    peer: bool
    solve: Callable[[], float]


@dataclass(frozen=True)
class Row:
    """A measured contestant: its error and the median of its times, s."""

    solver: str
    setting: str
    error: float
    seconds: float
    peer: bool


def measure(contestants: Sequence[Contestant], rounds: int = 9) -> list[Row]:
    """Run the contestants in turns, so that noise of the machine meets all alike; the first round does not count."""
    times: list[list[float]] = [[] for _ in contestants]
    errors = [contestant.solve() for contestant in contestants]
    for _ in range(rounds):
        for contestant, spent in zip(contestants, times, strict=True):
            begun = time.perf_counter()
            contestant.solve()
            spent.append(time.perf_counter() - begun)
    return [
        Row(contestant.solver, contestant.setting, error, statistics.median(spent), contestant.peer)
        for contestant, error, spent in zip(contestants, errors, times, strict=True)
    ]


def problems() -> dict[str, Callable[[], list[Contestant]]]:
    """The problems found in the files of `stiffmbs.bench.problems`, by name."""
    from . import problems as package

    names = sorted(module.name for module in pkgutil.iter_modules(package.__path__))
    return {name: importlib.import_module(f"{package.__name__}.{name}").contestants for name in names}


def report(problem: str, rows: Sequence[Row]) -> dict[str, Any]:
    """The object of ``stiffmbs bench --json`` for one problem."""
    return {"problem": problem, "machine": machine(), "rows": [asdict(row) for row in rows]}


def machine() -> dict[str, Any]:
    """What the times were measured on."""
    packages = ("stiffmbs", "numpy", "numba", "scikit-sundae")
    return {
        "processor": platform.machine(),
        "cores": os.cpu_count(),
        "system": platform.system(),
        "python": platform.python_version(),
        **{package: version(package) for package in packages},
    }
