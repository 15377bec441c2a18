"""Fast start and exit of the command: Ctrl-C during loading, plugin searches, garbage collection."""

from __future__ import annotations

import atexit
import contextlib
import gc
import itertools
import os
import signal
import sys
from collections.abc import Iterator
from typing import NoReturn

INTERRUPTED = 128 + signal.SIGINT.value
"""Exit status of a command that is interrupted before it has results, as of shells."""
NEW_OBJECTS = 200_000
"""Number of new objects after which the garbage collector runs; more than a short run creates."""


def quiet_while_loading() -> None:
    """Prepare the command ``stiffmbs`` for a fast start: quiet Ctrl-C, no plugin search, no garbage collection.

    SymPy's cache gets no size limit.  OpenBLAS gets one thread, unless the environment sets another number: the dense
    matrices of a run are small, waiting threads cost more than they save, and rounding does not depend on the number of
    processors.  Nothing changes for programs that import the package.
    """
    if not _is_the_command():
        return
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    os.environ.setdefault("SYMPY_CACHE_SIZE", "None")
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    gc.disable()  # modules and classes stay alive: scanning them is wasted time
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _end)


def collect_from_now_on() -> None:
    """Resume garbage collection at a low frequency, without the objects that exist already."""
    gc.freeze()
    gc.set_threshold(NEW_OBJECTS)
    gc.enable()


@contextlib.contextmanager
def uncollected() -> Iterator[None]:
    """Suspend garbage collection, as during derivation and translation, whose objects stay alive."""
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()


class QuickEnd:
    """Exit handler that ends the process without the teardown of its modules."""

    def __init__(self) -> None:
        self.status: int | None = None

    @classmethod
    def of_the_command(cls) -> QuickEnd:
        """Return a handler that is called last at exit.

        It is not registered in other programs, nor if an earlier exit function exists, which it would skip.
        """
        end = cls()
        if _is_the_command() and not atexit._ncallbacks():
            atexit.register(end)
        return end

    @contextlib.contextmanager
    def noted(self) -> Iterator[None]:
        """Record the exit status that the command requests."""
        try:
            yield
        except SystemExit as asked:
            self.status = asked.code if isinstance(asked.code, int) else None
            raise

    def __call__(self) -> None:
        """End the process; do nothing after a traceback or under a debugger or line tracer."""
        if self.status is None or sys.gettrace() is not None:
            return
        for stream in (sys.stdout, sys.stderr):
            with contextlib.suppress(OSError, ValueError, AttributeError):
                stream.flush()
        os._exit(self.status)


def _is_the_command() -> bool:
    original = getattr(sys, "orig_argv", [])
    by_module = any(pair == ("-m", "stiffmbs") for pair in itertools.pairwise(original))
    return by_module or os.path.basename(sys.argv[0] if sys.argv else "").removesuffix(".exe") == "stiffmbs"


def _end(number: int, frame: object) -> NoReturn:
    os._exit(INTERRUPTED)
