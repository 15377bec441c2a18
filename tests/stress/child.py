"""A process in which the trials of a fuzzer run, so that a hang or a crash of one ends neither the command nor the others."""

from __future__ import annotations

import importlib
import multiprocessing
import signal
import time
from functools import partial
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess

from .case import Outcome, Verdict, tried

TIME_LIMIT = 30.0
"""Processor time, s, in which a trial has to end: what else the machine does has no part in it."""
WAITING = 20.0
"""Times that a trial may take longer by the clock: it may wait for the processor, but not for ever."""
READY = "ready"
OUT_OF_TIME = getattr(signal, "SIGPROF", 0)
"""Ends the process of a trial that has used up its processor time, in compiled code as well."""


class Child:
    """Runs trials of a module in a process of its own.

    Parameters
    ----------
    module : str
        Has the function ``trial(seed) -> Verdict``.
    time_limit : float
        Processor time, s, after which a trial is given up and its process ends; where the system has no timer of it, 20 times
        as long by the clock.
    """

    def __init__(self, module: str, time_limit: float = TIME_LIMIT) -> None:
        self._module, self._time_limit = module, time_limit
        self._running: tuple[BaseProcess, Connection] | None = None

    def tried(self, seed: int) -> tuple[Verdict, float]:
        """The verdict of a trial, and the time that it took, s."""
        begun = time.perf_counter()
        try:
            connection = self._connection()
            begun = time.perf_counter()
            connection.send(seed)
            verdict = connection.recv() if connection.poll(WAITING * self._time_limit) else self._no_end()
        except (EOFError, OSError):
            verdict = self._crashed()
        return verdict, time.perf_counter() - begun

    def close(self) -> None:
        """End the process."""
        if self._running:
            process, connection = self._running
            self._running = None
            connection.close()
            process.kill()
            process.join()

    def _connection(self) -> Connection:
        """To the process at hand, or to a new one that has imported what it needs.

        Raises
        ------
        EOFError
            When a new process ends before that.
        """
        if self._running:
            return self._running[1]
        self._running = self._started()
        assert self._running[1].recv() == READY
        return self._running[1]

    def _started(self) -> tuple[BaseProcess, Connection]:
        context = multiprocessing.get_context("spawn")  # a fork would share threads and compiled code
        connection, theirs = context.Pipe()
        process = context.Process(target=_serve, args=(self._module, theirs, self._time_limit), daemon=True)
        process.start()
        theirs.close()  # so that the end of the child is the end of the pipe
        return process, connection

    def _no_end(self) -> Verdict:
        self.close()
        return Verdict(Outcome.WRONG, detail=f"no end within {self._time_limit:g} s")

    def _crashed(self) -> Verdict:
        assert self._running is not None
        process, _ = self._running
        process.join()
        code = process.exitcode or 0
        if OUT_OF_TIME and code == -OUT_OF_TIME:
            return self._no_end()
        self.close()
        how = f"by {signal.Signals(-code).name}" if code < 0 else f"with exit status {code}"
        return Verdict(Outcome.WRONG, detail=f"the process ended {how}")


def _serve(module: str, connection: Connection, time_limit: float) -> None:
    """Answer seeds with verdicts, until the other end is closed or a trial takes too much processor time."""
    trial = importlib.import_module(module).trial
    connection.send(READY)
    while True:
        try:
            seed = connection.recv()
        except EOFError:
            return
        _set_timer(time_limit)
        connection.send(tried(partial(trial, seed)))


def _set_timer(seconds: float) -> None:
    """Let the system end this process after so much more processor time."""
    if hasattr(signal, "setitimer"):
        signal.setitimer(signal.ITIMER_PROF, seconds)
