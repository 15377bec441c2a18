"""Process that solves the scene of one page: requests on standard input, answers on standard output, JSON on each line.

The newest request wins: the run of an older one is interrupted.
"""

from __future__ import annotations

import contextlib
import json
import os
import queue
import sys
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TextIO, TypeAlias

from ..errors import StiffmbsError
from ..model.model_data import ModelData
from ..reading.files.text_file import file_text
from ..show.summary import json_line
from .requests import Request, answer_to
from .solver import LiveSolver, NeedsConsent, error_of, preview, timed

BETWEEN = 0.2
"""Least time between two messages on progress, s."""
STOP = "stop"
Message: TypeAlias = dict[str, Any]
"""Request of a page, as read from JSON."""
Send = Callable[[dict[str, object]], None]


@dataclass
class Newest:
    """Numbers of the newest request, and of the newest one that the user stopped."""

    number: int = 0
    stopped: int = 0


class Worker:
    """Loop that answers the requests of a page, the newest first. `send`: function that sends an answer."""

    def __init__(self, solver: LiveSolver, send: Send) -> None:
        self._solver, self._send = solver, send
        self._newest = Newest()
        self._requests: queue.Queue[Message | None] = queue.Queue()
        self._previewed: dict[str, dict[str, str]] = {}
        self._waiting: Message | None = None
        self._lock = threading.Lock()

    def take(self, message: Message | None) -> None:
        """Accept a request from another thread; None ends the loop."""
        if message is None:
            self._newest.number = sys.maxsize
        elif message.get("what") == STOP:
            self._newest.stopped = self._newest.number
            return
        else:
            self._newest.number = int(message["number"])
            if message.get("preview"):
                with self._lock:
                    self._waiting = message
                    self._send_preview()
        self._requests.put(message)

    def _send_preview(self) -> None:
        """Send the bodies of a scene to the page that waits for its first solution, as soon as both are there."""
        if self._waiting is not None and (page := self._previewed.get(str(self._waiting.get("text")))) is not None:
            self._send({"number": int(self._waiting["number"]), "status": "progress", "page": page})
            self._waiting = None

    def solve_ahead(self, file: Path) -> None:
        """Draw and solve a file before a page asks for it, and end with the first request; errors are left to that request."""

        def watch(t: float) -> None:
            if self._newest.number:
                raise KeyboardInterrupt

        with contextlib.suppress(StiffmbsError):
            text = file_text(file)
            page = preview(self._solver.scene(text, {}))
            with self._lock:
                self._previewed[text] = page
                self._send_preview()
            self._solver.solve(text, {}, watch)

    def loop(self) -> None:
        """Answer requests until the end."""
        while (message := self._requests.get()) is not None:
            number = int(message["number"])
            if number < self._newest.number:
                self._send({"number": number, "status": "superseded"})
                continue
            begun = time.perf_counter()
            answer = self._answer(message, number)
            self._send({**answer, "number": number, "seconds": timed(begun)})

    def _answer(self, message: dict[str, object], number: int) -> dict[str, object]:
        if message.get("allow") is True:
            self._solver.allow()
        reported = time.monotonic()

        def tell(progress: dict[str, object]) -> None:
            nonlocal reported
            if time.monotonic() - reported > BETWEEN:
                reported = time.monotonic()
                self._send({"number": number, "status": "progress", **progress})

        def watch(t: float) -> None:
            if number < self._newest.number or number <= self._newest.stopped:
                raise KeyboardInterrupt
            if t == t:
                start, end = self._solver.span
                tell({"time": t, "start": start, "end": end})

        try:
            answer = answer_to(Request(message, self._solver, watch, tell))
        except KeyboardInterrupt:
            answer = {"status": "interrupted", "message": "interrupted", "text": "interrupted"}
        except NeedsConsent as error:
            answer = {"status": "consent", "message": str(error)}
        except StiffmbsError as error:
            answer = error_of(error, self._solver.source)
        except Exception as error:  # a fault of the package must not end the page
            unexpected = f"unexpected {type(error).__name__}: {error}; please report it"
            answer = {"status": "error", "line": 0, "message": unexpected}
        return answer if number == self._newest.number else {"status": "superseded"}


def _read(lines: TextIO, worker: Worker) -> None:
    for line in lines:
        worker.take(json.loads(line))
    worker.take(None)
    time.sleep(BETWEEN)
    os._exit(0)  # a long compilation must not outlive the page


def main() -> None:
    """Run the loop on standard input and output; prints of other code go to standard error."""
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    file = Path(sys.argv[1]) if len(sys.argv) > 1 and sys.argv[1] else None

    writing = threading.Lock()

    def send(message: dict[str, object]) -> None:
        with writing:
            answers.write(json_line(message) + "\n")
            answers.flush()

    worker = Worker(LiveSolver(file), send)
    threading.Thread(target=_read, args=(sys.stdin, worker), daemon=True).start()
    if file is not None and file.exists():
        worker.solve_ahead(file)
    worker.loop()


def of_model(model: ModelData, send: Send) -> Worker:
    """Return a worker in a thread of this process, for a model whose Python functions no other process has."""
    worker = Worker(LiveSolver(model=model), send)
    threading.Thread(target=worker.loop, daemon=True).start()
    return worker


if __name__ == "__main__":
    main()
