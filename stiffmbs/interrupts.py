"""The command while it is being loaded: Ctrl-C, and the garbage collector."""

from __future__ import annotations

import gc
import itertools
import os
import signal
import sys
from typing import Any, NoReturn

INTERRUPTED = 130
"""Exit status of a command that was interrupted before it had any results: 128 + SIGINT, as shells have it."""


def quiet_while_loading() -> None:
    """Let Ctrl-C end the command ``stiffmbs`` without a traceback while it is being loaded, and nothing be collected.

    Programs that import the package keep their own ways.
    """
    if not _is_the_command():
        return
    gc.disable()  # modules and classes stay: looking through them again and again takes 5 % of a short run
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _end)


def collect_from_now_on() -> None:
    """Have the garbage collector look at what is made from now on."""
    gc.freeze()
    gc.enable()


def _is_the_command() -> bool:
    original = getattr(sys, "orig_argv", [])
    by_module = any(pair == ("-m", "stiffmbs") for pair in itertools.pairwise(original))
    return by_module or os.path.basename(sys.argv[0] if sys.argv else "").removesuffix(".exe") == "stiffmbs"


def _end(number: int, frame: Any) -> NoReturn:
    os._exit(INTERRUPTED)
