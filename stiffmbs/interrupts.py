"""How the command starts and ends quickly: Ctrl-C while it is loaded, searches that it leaves out, and garbage collection."""

from __future__ import annotations

import atexit
import contextlib
import gc
import itertools
import os
import signal
import sys
from collections.abc import Iterator
from typing import Any, NoReturn

INTERRUPTED = 130
"""Exit status of a command that was interrupted before it had any results: 128 + SIGINT, as shells have it."""
NEW_OBJECTS = 200_000
"""So many make the garbage collector look: more than a short run makes with the modules that it loads (70 000 to 160 000), as one look
at 50 000 of them takes 8 % of it."""


def quiet_while_loading() -> None:
    """Let Ctrl-C end the command ``stiffmbs`` without a traceback while it is being loaded, and nothing be collected.

    Pydantic does not look for plugins in all installed packages, as none serves here.  SymPy remembers all results, where it
    usually keeps 1000: that saves 10 % of deriving.
    Programs that import the package keep their own ways.
    """
    if not _is_the_command():
        return
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    os.environ.setdefault("SYMPY_CACHE_SIZE", "None")
    gc.disable()  # modules and classes stay: looking through them again and again takes 5 % of a short run
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _end)


def collect_from_now_on() -> None:
    """Have the garbage collector look at what is made from now on, seldom: a run loads modules whose classes stay."""
    gc.freeze()
    gc.set_threshold(NEW_OBJECTS)
    gc.enable()


@contextlib.contextmanager
def uncollected() -> Iterator[None]:
    """Collect nothing for a while: expressions live on in SymPy's caches, and looking through them takes 5 to 10 % of deriving.

    Of translating a kernel, whose syntax tree is kept until the end, it takes two fifths.
    """
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()


class QuickEnd:
    """Lets the process of a command end without taking its modules apart, which takes longer than many a run."""

    def __init__(self) -> None:
        self.status: int | None = None

    @classmethod
    def of_the_command(cls) -> QuickEnd:
        """One that is called as the process ends, after all that is registered later.

        Other programs end in their own ways, and so does a command for which something was registered earlier, as by a
        ``sitecustomize``: that would not be called.
        """
        end = cls()
        if _is_the_command() and not atexit._ncallbacks():
            atexit.register(end)
        return end

    @contextlib.contextmanager
    def noted(self) -> Iterator[None]:
        """Take note of the exit status that the command asks for."""
        try:
            yield
        except SystemExit as asked:
            self.status = asked.code if isinstance(asked.code, int) else None
            raise

    def __call__(self) -> None:
        """End at once; in the usual way after a traceback, and for a debugger or a tracer of lines."""
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


def _end(number: int, frame: Any) -> NoReturn:
    os._exit(INTERRUPTED)
