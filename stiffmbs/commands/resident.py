"""Commands in a resident process, which has loaded the program before and forks for each of them.

The variable STIFFMBS_RESIDENT asks for it: the time, s, for which the process waits for the next command. The first
command starts it and runs as usual. Processes with other limits, rights or interpreters have a resident process of their own.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any, Final

VARIABLE = "STIFFMBS_RESIDENT"
FOLDER = "resident"
"""Folder of the sockets in the cache directory; the user alone may enter it."""
ACCEPTED = b"a"
"""Answer of the resident process before it forks; without it the command runs as usual."""
LONGEST: Final = 100
"""Number of bytes in the longest path of a socket, for which systems have 104 or more."""
_OF_INTERPRETER = (
    "PYTHON", "LC_", "LANG", "LD_", "DYLD_", "MALLOC_", "OPENBLAS_", "OMP_", "TZ", VARIABLE, "SYMPY_", "PYDANTIC_"
)  # fmt: skip
"""Beginnings of the names of variables that take effect when a process starts, or a module is loaded."""


def passed_on() -> int | None:
    """Return the exit status of this command from the resident process; None if it has to run here."""
    from ..cache.ownership import NotOwnError, check_folder

    given = os.environ.get(VARIABLE, "")
    try:
        if not float(given or 0) > 0:
            return None
    except ValueError:
        print(f"stiffmbs: note: {VARIABLE}: found {given!r}, expected a number of seconds", file=sys.stderr)
        return None
    with suppress(OSError, NotOwnError):
        path = address() if can_be_passed_on() else None
        if path is not None:
            check_folder(path.parent)
            return _answered(path)
    return None


def can_be_passed_on() -> bool:
    """Return True if a fork of another process can do the same: files by number are open here alone."""
    first = sys.orig_argv[1:2]
    has_options = not first or (first[0].startswith("-") and first != ["-m"])
    by_number = any(argument.startswith(("/dev/fd/", "/proc/self/")) for argument in sys.argv)
    return hasattr(os, "fork") and not (has_options or sys.gettrace() or by_number)


def address() -> Path | None:
    """Return the path of the socket of the resident process for processes like this one; None if there can be none."""
    from ..cache.entries import NOWHERE, cache_directory, digest

    root = cache_directory()
    path = root / FOLDER / digest(*map(repr, _inherited()))[:16]
    return None if root == NOWHERE or len(os.fsencode(path)) > LONGEST else path


def _inherited() -> Iterator[Any]:
    """Yield all that a process has from its start, and a command does not change."""
    import resource

    yield from (sys.executable, sys.version, __file__, os.getgroups(), os.geteuid(), os.getegid())
    yield from (os.getpriority(os.PRIO_PROCESS, 0), getattr(os, "sched_getaffinity", id)(0))
    yield [resource.getrlimit(getattr(resource, name)) for name in dir(resource) if name.startswith("RLIMIT_")]
    yield sorted((name, value) for name, value in os.environ.items() if name.startswith(_OF_INTERPRETER))
    mask = os.umask(0o077)
    os.umask(mask)
    yield mask


def _answered(path: Path) -> int | None:
    import json
    import signal
    import socket

    connection = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    with connection:
        try:
            connection.connect(str(path))
        except OSError:
            _start(path)
            return None

        def forward(number: int, frame: object) -> None:
            with suppress(OSError):
                connection.sendall(bytes([number]))

        given = [sys.argv, sys.orig_argv, os.getcwd(), sys.path, dict(os.environ)]
        content = json.dumps(given).encode()
        socket.send_fds(connection, [len(content).to_bytes(8, "little")], [0, 1, 2])
        connection.sendall(content)
        if connection.recv(1) != ACCEPTED:
            return None
        for number in (signal.SIGINT, signal.SIGTERM):
            if signal.getsignal(number) != signal.SIG_IGN:
                signal.signal(number, forward)
        status = connection.recv(1)
    if not status:
        print("stiffmbs: the resident process ended before the command", file=sys.stderr)
    return status[0] if status else 1


def _start(path: Path) -> None:
    """Start the resident process, and do not wait for it."""
    import subprocess

    package = str(Path(__file__).parents[2])
    program = (
        f"import sys; sys.argv = ['stiffmbs']; sys.path[:] = {[package, *sys.path[1:]]!r}\n"
        f"from stiffmbs.__main__ import start; start({str(path)!r})"
    )
    quiet = subprocess.DEVNULL
    process = subprocess.Popen(
        [sys.executable, "-c", program], stdin=quiet, stdout=quiet, stderr=quiet, cwd="/", start_new_session=True
    )
    process.returncode = 0  # it outlives this process, without a warning
