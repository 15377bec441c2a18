"""The resident process: it loads the program, and forks for each command (`stiffmbs.commands.resident`)."""

from __future__ import annotations

import atexit
import gc
import json
import os
import select
import signal
import socket
import sys
import threading
from contextlib import suppress
from importlib import import_module
from pathlib import Path

from ..compile.machine.finish import alone
from .resident import ACCEPTED, VARIABLE

OWN = ("stiffmbs", "llvmlite", "sympy")
"""Packages whose modules this process loads after a command needed them."""


class Sources:
    """Files of the loaded modules, with the times of their last changes."""

    def __init__(self) -> None:
        self._times: dict[str, int] = {}
        self.have_changed()

    def have_changed(self) -> bool:
        """Return True if a file is not the one that was loaded; record those of new modules."""
        for module in tuple(sys.modules.values()):
            if file := getattr(module, "__file__", None):
                time = os.stat(file).st_mtime_ns if os.path.exists(file) else 0
                if self._times.setdefault(file, time) != time:
                    return True
        return False


class Server:
    """Socket, and commands under way with what they are to tell.

    - `running`: connection, and pipe of the names of loaded modules, by number of the process.
    """

    def __init__(self, listening: socket.socket) -> None:
        self.listening = listening
        self.running: dict[int, tuple[socket.socket, int]] = {}
        self._sources = Sources()
        self._patience = float(os.environ[VARIABLE])
        self._ended, waking = os.pipe()
        os.set_blocking(waking, False)
        signal.signal(signal.SIGCHLD, lambda number, frame: None)
        signal.set_wakeup_fd(waking)

    def wait(self) -> tuple[socket.socket, int] | None:
        """Wait for commands, and return what is given to `_become` in the process of each; None when none came for long,
        or a source has changed."""
        listening = self.listening.fileno()
        sources = [self._ended, listening]
        while listening in sources or self.running:
            ready, _, _ = select.select(sources, [], [], self._patience)
            if self._ended in ready:
                os.read(self._ended, 4096)
                self._collect()
            if listening in ready and not self._sources.have_changed():
                if taken := self._forked():
                    return taken
            elif listening in sources and (listening in ready or not (ready or self.running)):
                sources.remove(listening)
                self.listening.close()  # a command that waits there runs as usual
        return None

    def _forked(self) -> tuple[socket.socket, int] | None:
        """Accept a command; return its connection, and the pipe to this process, in the process that is to run it."""
        connection, _ = self.listening.accept()
        names, telling = os.pipe()
        gc.freeze()
        number = os.fork()
        if number:
            os.close(telling)
            self.running[number] = connection, names
            return None
        for other, of_other in self.running.values():
            other.close()
            os.close(of_other)
        signal.set_wakeup_fd(-1)
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)
        os.set_blocking(telling, False)
        self.listening.close()
        return connection, telling

    def _collect(self) -> None:
        """Send the exit statuses of ended commands, and load the modules that they needed."""
        for number in tuple(self.running):
            ended, status = os.waitpid(number, os.WNOHANG)
            if not ended:
                continue
            connection, names = self.running.pop(number)
            code = os.waitstatus_to_exitcode(status)
            with connection, suppress(OSError):
                connection.sendall(bytes([code if code >= 0 else 128 - code]))
            with os.fdopen(names, encoding="utf-8") as told:
                for name in told.read().split():
                    with suppress(Exception):
                        import_module(name)
        self._sources.have_changed()  # notes the files


def wait_for_a_command(address: str) -> None:
    """Return in the process of each command that comes to a socket; end if another process waits there."""
    path = Path(address)
    path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    path.parent.chmod(0o700)
    taken = None
    with suppress(OSError), alone(path.with_suffix(".lock")):
        path.unlink(missing_ok=True)
        with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as listening:
            listening.bind(address)
            listening.listen()
            taken = Server(listening).wait()
        if taken is None:
            path.unlink()
    if taken is None:
        sys.exit()
    _become(*taken)


def _become(connection: socket.socket, telling: int) -> None:
    """Take over the arguments, variables, folder and standard files of a command."""
    connection.sendall(ACCEPTED)
    head, files, _, _ = socket.recv_fds(connection, 8, 3)
    with connection.makefile("rb") as content:
        given = json.loads(content.read(int.from_bytes(head, "little")))
    sys.argv[:], sys.orig_argv[:], folder, sys.path[:], variables = given
    sys.modules["__main__"].__package__ = "stiffmbs" if sys.orig_argv[1] == "-m" else None  # the help names the program
    for number, file in enumerate(files):
        os.dup2(file, number)
        os.close(file)
    os.chdir(folder)
    os.environ.clear()
    os.environ.update(variables)
    for number, name in enumerate(("stdin", "stdout", "stderr")):
        before = getattr(sys, name)
        by_lines = number == 2 or os.isatty(number) or before.write_through
        stream = open(  # noqa: SIM115 as long as the process
            number, "w" if number else "r", 1 if by_lines else -1, before.encoding, before.errors, closefd=False
        )
        setattr(sys, name, stream)
        setattr(sys, f"__{name}__", stream)
    threading.Thread(target=_heed, args=(connection,), daemon=True).start()
    before_it = frozenset(sys.modules)
    atexit.register(lambda: _tell(telling, before_it))


def _heed(connection: socket.socket) -> None:
    """Pass signals on to this process; ask it to end when the process in the terminal has ended."""
    with suppress(OSError):
        while numbers := connection.recv(1):
            os.kill(os.getpid(), numbers[0])
    os.kill(os.getpid(), signal.SIGTERM)


def _tell(telling: int, before: frozenset[str]) -> None:
    """Tell which modules were loaded."""
    new = [name for name in sys.modules if name not in before and name.partition(".")[0] in OWN]
    with suppress(OSError):
        os.write(telling, "\n".join(new).encode())
