"""Ctrl-C while the command is being loaded."""

from __future__ import annotations

import itertools
import os
import signal
import sys
from typing import Any, NoReturn

INTERRUPTED = 130
"""Exit status of a command that was interrupted before it had any results: 128 + SIGINT, as shells have it."""


def quiet_while_loading() -> None:
    """Let Ctrl-C end the command ``stiffmbs`` without a traceback while it is being loaded; programs that import the package
    keep their own ways."""
    if _is_the_command() and signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _end)


def _is_the_command() -> bool:
    original = getattr(sys, "orig_argv", [])
    by_module = any(pair == ("-m", "stiffmbs") for pair in itertools.pairwise(original))
    return by_module or os.path.basename(sys.argv[0] if sys.argv else "").removesuffix(".exe") == "stiffmbs"


def _end(number: int, frame: Any) -> NoReturn:
    os._exit(INTERRUPTED)
