"""Processes of this package, which import no module of the current folder."""

from __future__ import annotations

import os
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import get_context

SAFE_PATH = "PYTHONSAFEPATH"
"""Environment variable with which Python does not put the current folder, or that of a script, on the search path."""


@contextmanager
def process_pool(workers: int | None = None) -> Iterator[ProcessPoolExecutor]:
    """Provide new processes for tasks; they get the search path of this one after they have started.

    A process that `multiprocessing` spawns searches the current folder for the modules that it starts with, and so
    would run a file ``pickle.py`` next to a scene. `workers`: number of processes; None for all processors.
    """
    before = os.environ.get(SAFE_PATH)
    os.environ[SAFE_PATH] = "1"  # processes start when they are needed, until the end
    try:
        with ProcessPoolExecutor(workers, get_context("spawn")) as executor:
            yield executor
    finally:
        if before is None:
            del os.environ[SAFE_PATH]
        else:
            os.environ[SAFE_PATH] = before
