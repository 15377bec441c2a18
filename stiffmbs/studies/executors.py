"""Distribution of work over threads, processes or a cluster."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ThreadPoolExecutor, wait
from contextlib import contextmanager
from itertools import islice

from ..errors import SolverError, StiffmbsError
from .case_solver import Row
from .worker import Chunk, solve_chunk

AHEAD = 3
"""Number of chunks for each worker that are running or waiting, so that no worker is idle."""
TRIES = 3
"""Number of attempts for a chunk whose worker ended."""


@contextmanager
def executor_of(workers: int | None, executor: Executor | None) -> Iterator[tuple[Executor | None, int]]:
    """Yield an executor and the number of its workers, or None for work in the current thread."""
    if executor is not None:
        yield executor, workers or _workers_of(executor)
        return
    count = workers or 1
    if count == 1:
        yield None, 1
        return
    threads = ThreadPoolExecutor(count)
    try:
        yield threads, count
    finally:
        threads.shutdown(wait=True, cancel_futures=True)


def _workers_of(executor: Executor) -> int:
    """Return the number of workers that an executor reports, or else one for a small cluster."""
    return int(getattr(executor, "_max_workers", 0) or 16)


def rows_of(
    task: bytes, chunks: Iterator[Chunk], executor: Executor | None, workers: int, keep: Callable[[list[Row]], None]
) -> None:
    """Solve chunks of cases by an executor, and keep their rows as they are completed.

    Raises
    ------
    SolverError
        If workers of the executor end repeatedly.
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
        f"a worker of the study ended ({type(error).__name__}: {error}); what is done is kept: start the study again to go on"
    )
