"""Process of a command: signals, memory, and a full or closed standard output, without tracebacks."""

from __future__ import annotations

import contextlib
import errno
import os
import signal
import sys
import threading
import warnings
from _thread import interrupt_main
from collections.abc import Callable, Iterator, Sequence
from enum import IntEnum
from typing import Any

import click

from ..interrupts import INTERRUPTED
from ..reading.files.quoted import quoted
from ..results.command_line import commanded
from ..show.escaped import EscapingStream

OF_OUTPUT = (errno.ENOSPC, errno.EIO, errno.EBADF, errno.EPIPE, errno.EDQUOT)
TOO_LITTLE_MEMORY = "found too little memory, expected more, or a smaller scene with fewer output points"
TO_TRY = "'stiffmbs init' writes a first scene, and 'stiffmbs examples list' lists scenes to try."
"""Advice for commands without a scene."""
ASKING_TO_END = ("SIGINT", "SIGTERM")
AGAIN = 0.01
"""Delay after which an interrupt lost in a callback is raised again, s."""


class Status(IntEnum):
    """Exit status of a command."""

    DONE = 0
    FAILED = 1
    """Stopped early, not written, or a negative finding."""
    WRONG_INPUT = 2


class Process(click.Group):
    """Group of commands that always ends with an exit status and a message.

    SIGTERM acts like Ctrl-C: a run that has started keeps its results, with exit status 1; otherwise the status is that
    of a shell: 130 after Ctrl-C, 143 after SIGTERM.
    """

    def main(self, *arguments: Any, **options: Any) -> Any:
        """Run the requested command; see `click.Command.main`."""
        closed = _with_standard_files()
        given = options.get("args", arguments[0] if arguments else None)
        line = commanded(sys.argv[1:] if given is None else list(given))
        with line, _signals() as received, _no_interrupt_lost(), _escaping(), warnings.catch_warnings():
            # Overflows are reported in sentences where they have an effect.
            warnings.simplefilter("ignore", RuntimeWarning)
            status = 0
            try:
                status = _status(
                    lambda: super(Process, self).main(*arguments, **{**options, "standalone_mode": False}), received
                )
            finally:
                written = _flushed(reported=status != 0)
        if closed:
            _tell("standard output is closed: nothing is shown")
        sys.exit(status or (0 if written and not closed else Status.FAILED))


def _status(command: Callable[[], object], received: Sequence[int]) -> int:
    """Return the exit status of a command; print a message on a failure. `received`: signals, which grow meanwhile."""
    try:
        ended = command()
    except SystemExit as end:
        return end.code if isinstance(end.code, int) else 0 if end.code is None else Status.FAILED
    except click.exceptions.Exit as end:
        return end.exit_code
    except click.ClickException as error:
        if isinstance(error, click.NoSuchOption):  # with the nearest option alone
            error = click.NoSuchOption(error.option_name, error.message, (error.possibilities or [])[:1], error.ctx)
        if isinstance(error, click.MissingParameter) and error.param and error.param.name == "scene":
            error = click.MissingParameter(TO_TRY, error.ctx, error.param, param_type=error.param.param_type_name)
        error.show()
        return error.exit_code
    except (KeyboardInterrupt, click.Abort):
        _tell("interrupted")
        return 128 + received[-1] if received else INTERRUPTED
    except MemoryError:
        _tell(TOO_LITTLE_MEMORY)
        return Status.FAILED
    except OSError as error:
        _tell(_reason(error))
        return Status.FAILED
    return ended if isinstance(ended, int) else 0


def _reason(error: OSError) -> str:
    if error.errno == errno.ENOMEM:
        return TOO_LITTLE_MEMORY
    if error.filename is None and error.errno in OF_OUTPUT:
        return f"standard output: cannot be written ({error.strerror})"
    where = f"{quoted(str(error.filename))}: " if error.filename is not None else ""
    return f"{where}found an error of the operating system ({quoted(error.strerror or str(error))})"


def _tell(sentence: str) -> None:
    with contextlib.suppress(OSError, ValueError):
        click.echo(f"stiffmbs: {sentence}", err=True)


def _with_standard_files() -> bool:
    """Reserve the descriptors of standard files; return True if standard output is closed."""
    closed = sys.stdout is None
    if not closed and sys.stdout is not sys.__stdout__:  # stream of a test, or of another program
        return False
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)
    if closed:
        sys.stdout = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115 as long as the process
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")
    return closed


def _flushed(reported: bool) -> bool:
    """Flush standard output and return True on success; otherwise discard it, so that Python does not retry.

    `reported`: true if a failure was already reported: an unwritable buffer fails here a second time.
    """
    try:
        sys.stdout.flush()
    except BrokenPipeError:
        pass
    except OSError as error:
        if not reported:
            _tell(f"standard output: cannot be written ({error.strerror})")
    except ValueError:
        return True
    else:
        return True
    with contextlib.suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    return False


@contextlib.contextmanager
def _escaping() -> Iterator[None]:
    """Escape control characters in all printed text."""
    before = sys.stdout, sys.stderr
    sys.stdout, sys.stderr = (stream and EscapingStream(stream) for stream in before)  # type: ignore[assignment]
    try:
        yield
    finally:
        sys.stdout, sys.stderr = before


@contextlib.contextmanager
def _signals() -> Iterator[list[int]]:
    """Let signals interrupt a command, and list them; ignore them afterwards, while the process ends."""
    received: list[int] = []
    if threading.current_thread() is not threading.main_thread():
        yield received
        return

    def interrupt(number: int, frame: object) -> None:
        received.append(number)
        raise KeyboardInterrupt

    numbers = [getattr(signal, name) for name in ASKING_TO_END if hasattr(signal, name)]
    before = [signal.signal(number, interrupt) for number in numbers]
    try:
        yield received
    finally:
        own = sys.stdout is sys.__stdout__
        for number, handler in zip(numbers, before, strict=True):
            signal.signal(number, signal.SIG_IGN if own else handler)


@contextlib.contextmanager
def _no_interrupt_lost() -> Iterator[None]:
    """Raise an interrupt again if it occurs in a weak reference's callback, where Python would only print it."""
    before = sys.unraisablehook

    def raised_again(unraisable: sys.UnraisableHookArgs) -> None:
        if unraisable.exc_type is KeyboardInterrupt:  # and not one that ends a solution in time
            threading.Timer(AGAIN, _interrupt).start()  # the callback has to end first
        else:
            before(unraisable)

    sys.unraisablehook = raised_again
    try:
        yield
    finally:
        sys.unraisablehook = before


def _interrupt() -> None:
    if hasattr(signal, "pthread_kill"):
        signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGINT)  # a real signal, which wakes sleep
    else:
        interrupt_main()
