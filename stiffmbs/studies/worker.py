"""Worker of a study, in a thread, another process or on another machine."""

from __future__ import annotations

import pickle
from collections.abc import Sequence
from functools import lru_cache
from queue import Empty, LifoQueue
from typing import Any

from .case_solver import CaseSolver, Row, Task

Chunk = Sequence[tuple[int, tuple[Any, ...]]]
"""Cases with their numbers."""
STUDIES = 2
"""Number of studies whose compiled jobs a process keeps."""


@lru_cache(maxsize=STUDIES)
def _solvers(task: bytes) -> LifoQueue[CaseSolver]:
    """Return the idle solvers of a study in this process."""
    return LifoQueue()


def solve_chunk(task: bytes, chunk: Chunk) -> list[Row]:
    """Solve cases.

    Parameters
    ----------
    task : bytes
        A pickled `Task`.
    chunk : sequence of (int, tuple)

    Returns
    -------
    list of Row
        Rows in the order of the cases; that of a failed case has the reason.
    """
    idle = _solvers(task)
    try:
        solver = idle.get_nowait()
    except Empty:
        found: Task = pickle.loads(task)
        solver = CaseSolver(found)
    rows = [solver.row(case, values) for case, values in chunk]
    idle.put(solver)  # not after an interruption, which may leave the solver inconsistent
    return rows
