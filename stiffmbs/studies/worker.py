"""What a worker does, in a thread, another process or on another machine: solves a few cases."""

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
"""Of which a process keeps what it has compiled."""


@lru_cache(maxsize=STUDIES)
def _solvers(task: bytes) -> LifoQueue[CaseSolver]:
    """The solvers of a study in this process that no thread works with at the moment."""
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
        In the order of the cases; a case that failed is a row that says why.
    """
    idle = _solvers(task)
    try:
        solver = idle.get_nowait()
    except Empty:
        found: Task = pickle.loads(task)
        solver = CaseSolver(found)
    rows = [solver.row(case, values) for case, values in chunk]
    idle.put(solver)  # not after an interruption: what it holds may be half changed
    return rows
