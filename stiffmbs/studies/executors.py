"""Distribution of work over threads, processes or a cluster."""

from __future__ import annotations

import pickle
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ThreadPoolExecutor, wait
from contextlib import contextmanager
from functools import lru_cache
from itertools import islice
from numbers import Integral
from queue import Empty, LifoQueue
from threading import Event
from typing import Any

from ..errors import InputError, SolverError, StiffmbsError
from ..reading.files.quoted import written
from ..solve.trajectory import ProgressCallback
from .case_solver import CaseSolver, Row, Task

Chunk = Sequence[tuple[int, tuple[Any, ...]]]
"""Cases with their numbers."""
STUDIES = 2
"""Number of studies whose compiled jobs a process keeps."""
AHEAD = 3
"""Number of chunks for each worker that are running or waiting, so that no worker is idle."""
TRIES = 3
"""Number of attempts for a chunk whose worker ended."""


class Threads(ThreadPoolExecutor):
    """Threads that solve cases until the study ends, as Ctrl-C reaches the main thread alone."""

    def __init__(self, workers: int) -> None:
        super().__init__(workers)
        self._end = Event()

    def submit(self, function: Callable[..., Any], /, *arguments: Any, **named: Any) -> Future[Any]:
        """Call a function that accepts `watch` in a thread."""
        return super().submit(function, *arguments, **named, watch=self._watch)

    def _watch(self, _: float) -> None:
        if self._end.is_set():
            raise KeyboardInterrupt

    def end(self) -> None:
        """End the runs under way, and wait for them."""
        self._end.set()
        self.shutdown(wait=True, cancel_futures=True)


def refuse_workers(workers: object) -> None:
    """Raise an InputError if a number of workers is given that is not a whole number above zero."""
    if workers is not None and (isinstance(workers, bool) or not isinstance(workers, Integral) or workers < 1):
        raise InputError(f"workers: found {written(workers)}, expected a whole number, 1 or more")


@contextmanager
def executor_of(workers: int | None, executor: Executor | None) -> Iterator[tuple[Executor | None, int]]:
    """Yield an executor and the number of its workers, or None for work in the current thread."""
    if executor is not None:
        yield executor, workers or int(getattr(executor, "_max_workers", 0) or 16)  # else a small cluster
        return
    count = workers or 1
    if count == 1:
        yield None, 1
        return
    threads = Threads(count)
    try:
        yield threads, count
    finally:
        threads.end()


def rows_of(
    task: bytes, chunks: Iterator[Chunk], executor: Executor | None, workers: int, keep: Callable[[list[Row]], None]
) -> None:
    """Solve chunks of cases by an executor, and keep their rows as they are completed.

    Raises SolverError if workers of the executor end repeatedly.
    """
    if executor is None:
        for chunk in chunks:
            keep(solve_chunk(task, chunk))
        return
    under_way: dict[Future[list[Row]], tuple[Chunk, int]] = {}

    def give(chunk: Chunk, tries: int) -> None:
        try:
            under_way[executor.submit(solve_chunk, task, chunk)] = chunk, tries
        except RuntimeError as error:
            raise _ended(error) from error

    try:
        for chunk in islice(chunks, AHEAD * workers):
            give(chunk, 1)
        while under_way:
            done, _ = wait(under_way, return_when=FIRST_COMPLETED)
            for future in done:
                chunk, tries = under_way.pop(future)
                try:
                    keep(future.result())
                except StiffmbsError:
                    raise
                except Exception as error:
                    if tries == TRIES:
                        raise _ended(error) from error
                    give(chunk, tries + 1)
                    continue
                for following in islice(chunks, 1):
                    give(following, 1)
    finally:
        for future in under_way:
            future.cancel()


def _ended(error: Exception) -> SolverError:
    return SolverError(
        f"a worker of the study ended ({type(error).__name__}: {error}); the completed cases are kept; start the study again to continue"
    )


@lru_cache(maxsize=STUDIES)
def _solvers(task: bytes) -> LifoQueue[CaseSolver]:
    """Return the idle solvers of a study in this process."""
    return LifoQueue()


def solve_chunk(task: bytes, chunk: Chunk, watch: ProgressCallback | None = None) -> list[Row]:
    """Solve cases of a pickled `Task`; the row of a failed case has the reason. `watch` as for `stiffmbs.run`."""
    idle = _solvers(task)
    try:
        solver = idle.get_nowait()
    except Empty:
        found: Task = pickle.loads(task)
        solver = CaseSolver(found)
    rows = [solver.row(case, values, watch) for case, values in chunk]
    idle.put(solver)  # not after an interruption, which may leave the solver inconsistent
    return rows
