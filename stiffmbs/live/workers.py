"""Workers of a server: one process for each page (tab), started ahead, ended when the page is closed."""

from __future__ import annotations

import asyncio
import contextlib
import json
import os
import queue
import subprocess
import sys
import threading
from collections.abc import AsyncIterator, Callable
from pathlib import Path
from typing import TYPE_CHECKING

from ..model.model_data import ModelData

if TYPE_CHECKING:
    from .worker import Message

MOST_PAGES = 6
"""Largest number of pages with a worker; the one that was used least recently loses its worker."""
ENDED = "the solver process ended unexpectedly; the next change starts another one"
FINAL = "progress"


class Channel:
    """Requests to a worker, and its answers by number."""

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        self._loop = loop
        self._waiting: dict[int, asyncio.Queue[dict[str, object]]] = {}
        self._number = 0
        self.ended = False

    def receive(self, message: dict[str, object]) -> None:
        """Accept an answer, from any thread."""
        self._loop.call_soon_threadsafe(self._deliver, message)

    def _deliver(self, message: Message) -> None:
        if message.get("status") == "ended":
            self.ended = True
            for waiting in self._waiting.values():
                waiting.put_nowait(_ended())
        elif (found := self._waiting.get(int(message["number"]))) is not None:
            found.put_nowait(message)

    async def answers(
        self, request: dict[str, object], put: Callable[[dict[str, object]], None]
    ) -> AsyncIterator[dict[str, object]]:
        """Yield the progress of a request, and its answer last."""
        self._number += 1
        number, answers = self._number, asyncio.Queue[dict[str, object]]()
        self._waiting[number] = answers
        if self.ended:  # since the worker was chosen
            answers.put_nowait(_ended())
        try:
            put({**request, "number": number})
            while True:
                message = await answers.get()
                yield message
                if message["status"] != FINAL:
                    return
        finally:
            del self._waiting[number]


def _ended() -> dict[str, object]:
    return {"status": "error", "message": ENDED, "line": 0}


def arguments(file: Path | None) -> list[str]:
    """Return the arguments of Python for a worker, which imports no module of the current folder."""
    return ["-P", "-m", f"{__package__}.worker", str(file or "")]


class Process:
    """Worker in a separate process. `file`: file of the scene."""

    def __init__(self, file: Path | None, loop: asyncio.AbstractEventLoop) -> None:
        self.channel = Channel(loop)
        command = [sys.executable, *arguments(file)]
        environment = {
            **os.environ,
            "PYDANTIC_DISABLE_PLUGINS": "__all__",
            "PYTHONPATH": os.pathsep.join(filter(None, sys.path)),
        }
        self._process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, encoding="utf-8", env=environment,
            start_new_session=True,
        )  # fmt: skip
        self._requests: queue.SimpleQueue[str] = queue.SimpleQueue()
        for loop_of_thread in (self._listen, self._write):
            threading.Thread(target=loop_of_thread, daemon=True).start()

    def _listen(self) -> None:
        """Pass answers on until the process ends, or until a line is no answer, as of a process killed while it wrote."""
        assert self._process.stdout is not None
        with contextlib.suppress(ValueError):
            for line in self._process.stdout:
                self.channel.receive(json.loads(line))
        self._process.kill()
        self._process.wait()
        with contextlib.suppress(RuntimeError):  # the server's loop is closed
            self.channel.receive({"status": "ended"})

    def _write(self) -> None:
        """Write requests to the process: a thread of its own, as a process that does not read would block the server."""
        assert self._process.stdin is not None
        while request := self._requests.get():
            try:
                self._process.stdin.write(request)
                self._process.stdin.flush()
            except (OSError, ValueError):
                self._process.kill()  # it has ended, or reads nothing any more; its listener reports that
                return

    def put(self, message: dict[str, object]) -> None:
        """Send a request."""
        self._requests.put(json.dumps(message) + "\n")

    def end(self) -> None:
        """End the process."""
        self._process.kill()
        self._requests.put("")


class Thread:
    """Worker in a thread of this process, for a model with Python functions."""

    def __init__(self, model: ModelData, loop: asyncio.AbstractEventLoop) -> None:
        from .worker import of_model

        self.channel = Channel(loop)
        self._worker = of_model(model, self.channel.receive)

    def put(self, message: dict[str, object]) -> None:
        """Send a request."""
        self._worker.take(message)

    def end(self) -> None:
        """End the thread when its run is over."""
        self._worker.take(None)


class Workers:
    """Workers of all pages of a server. `make`: function that starts a worker."""

    def __init__(self, make: Callable[[], Process | Thread]) -> None:
        self._make = make
        self._of_pages: dict[str, Process | Thread] = {}
        self._ahead: Process | Thread | None = None

    def start_ahead(self) -> None:
        """Start the worker of the next page."""
        if self._ahead is None or self._ahead.channel.ended:
            self._ahead = self._make()

    def of(self, page: str) -> Process | Thread:
        """Return the worker of a page; start one if there is none, or if it has ended."""
        found = self._of_pages.pop(page, None)
        if found is None or found.channel.ended:
            self.start_ahead()
            assert self._ahead is not None
            found, self._ahead = self._ahead, None
        self._of_pages[page] = found  # the last one used
        while len(self._of_pages) > MOST_PAGES:
            self.end(next(iter(self._of_pages)))
        return found

    def end(self, page: str) -> None:
        """End the worker of a page."""
        if (found := self._of_pages.pop(page, None)) is not None:
            found.end()

    def end_all(self) -> None:
        """End all workers."""
        for page in list(self._of_pages):
            self.end(page)
        if self._ahead is not None:
            self._ahead.end()
