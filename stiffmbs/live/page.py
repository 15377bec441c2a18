"""Opening of a live page: a server on the loopback interface, and the browser."""

from __future__ import annotations

import secrets
import socket
import threading
import webbrowser
from html import escape
from pathlib import Path
from typing import Any

from ..analyses.job import Runnable, data_of, settings_of
from ..errors import InputError, refuse_missing
from ..model.model_data import ModelData
from ..model.model_text import model_text
from ..reading.files.yaml_text import scene_text

PACKAGES = ("starlette", "uvicorn")
LOOPBACK = "127.0.0.1"
SCENES = (".yaml", ".yml")
"""File suffixes of scenes that can be edited."""
FRAME_HEIGHT = 760
"""Height of the page in a notebook, pixels."""


class LivePage:
    """Live page that is served until it is closed.

    Attributes
    ----------
    url : str
        Address, with the token; whoever knows it can read and change the scene.
    """

    def __init__(self, url: str, server: Any, thread: threading.Thread) -> None:
        self.url, self._server, self._thread = url, server, thread

    def wait(self) -> None:
        """Wait until the server ends, by `close` or Ctrl-C."""
        try:
            while self._thread.is_alive():
                self._thread.join(0.5)
        except KeyboardInterrupt:
            self.close()

    def close(self) -> None:
        """End the server and its workers."""
        self._server.should_exit = True
        self._thread.join(5.0)

    def __repr__(self) -> str:
        return f"LivePage({self.url})"

    def _repr_html_(self) -> str:
        return f'<iframe src="{escape(self.url)}" width="100%" height="{FRAME_HEIGHT}" style="border: 0"></iframe>'


def open(model: Runnable, port: int = 0, browser: bool = True, **changes: object) -> LivePage:  # the public name
    """Open a page in the browser that solves a scene again after every change.

    Parameters
    ----------
    model : Model, Scene, str or Path
        A model, a scene, or the file of a scene, which need not exist yet.  A model becomes the text of a scene; one
        with Python functions, or with flexible bodies, is shown and solved without an editor.
    port : int
        Port on the loopback interface; 0 for any free one.
    browser : bool
        False to open no browser; a notebook shows the page in a frame.
    **changes
        Fields of the run's settings to change, for a model.

    Returns
    -------
    LivePage
        Its `wait` returns when the page is closed by Ctrl-C.

    Raises
    ------
    InputError
        If the model is invalid, the file is not a scene, the port is taken, or a package of the extra ``live`` is
        missing.

    Examples
    --------
    >>> page = stiffmbs.open("examples/cart_pendulum.yaml")
    >>> page.close()
    """
    for package in PACKAGES:
        refuse_missing(package, "'stiffmbs[live]'", "open: ")
    from .app import Document

    document, data = Document(None, ""), None
    if isinstance(model, str | Path):
        document = Document(_file(Path(model)), "")
        document.read()
    else:
        data = data_of(model)
        text = _text(data, changes)
        document = Document(None, text or _described(data), editable=text is not None)
        data = None if text is not None else data
    return _served(document, data, port, browser)


def _file(path: Path) -> Path:
    """Return the file of a scene, which may be a new one.

    Raises InputError if it has another suffix, or there is no such folder.
    """
    if path.suffix.lower() not in SCENES:
        raise InputError(f"{path}: found '{path.suffix}', expected a scene in .yaml; stiffmbs convert makes one")
    if not path.parent.is_dir():
        raise InputError(f"{path}: found no folder '{path.parent}', expected one that exists")
    if path.is_dir():
        raise InputError(f"{path}: found a folder, expected a scene in .yaml")
    return path.resolve()


def _text(data: ModelData, changes: dict[str, object]) -> str | None:
    """Return a model as the text of a scene; None if it cannot be written."""
    settings = settings_of(data, None, changes)
    chosen = {name: getattr(settings, name) for name in settings.model_fields_set}
    try:
        text = model_text(data)
    except InputError:
        return None
    return text + (scene_text({"run": chosen}) if chosen else "")


def _described(data: ModelData) -> str:
    lines = [f"# {data.name or 'model'}: it has Python functions or flexible bodies, so that it cannot be edited here"]
    for section in ("bodies", "joints", "forces"):
        lines += [f"# {section}: {', '.join(getattr(data, section)) or 'none'}"]
    return "\n".join(lines) + "\n"


def _served(document: Any, data: ModelData | None, port: int, browser: bool) -> LivePage:
    """Start a server for a document, or a model, in a thread."""
    import asyncio

    import uvicorn

    from .app import Guard, application
    from .workers import Process, Thread, Workers

    token = secrets.token_urlsafe(24)  # another one for each start: whoever gets the port later learns nothing of use
    try:
        listening = _listening(port)
    except (OSError, OverflowError, TypeError) as error:
        raise InputError(f"--port {port}: found a port that cannot be used ({error}), expected a free one") from None
    number = listening.getsockname()[1]
    loop = asyncio.new_event_loop()
    workers = Workers(lambda: Thread(data, loop) if data is not None else Process(document.file, loop))
    app = Guard(application(token, document, workers), token, number)
    server = uvicorn.Server(
        uvicorn.Config(app, log_level="warning", lifespan="off", ws="none", timeout_graceful_shutdown=1)
    )

    def serve() -> None:
        """Serve until shutdown, then end all workers."""
        asyncio.set_event_loop(loop)
        try:
            loop.run_until_complete(server.serve(sockets=[listening]))
        finally:
            workers.end_all()
            listening.close()

    workers.start_ahead()
    thread = threading.Thread(target=serve, daemon=True)
    thread.start()
    url = f"http://{LOOPBACK}:{number}/{token}/"
    if browser and not _in_notebook():
        webbrowser.open(url)
    return LivePage(url, server, thread)


def _listening(port: int) -> socket.socket:
    """Return a socket that listens on a port, so that a browser may ask before the server runs."""
    found = socket.socket()
    try:
        found.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        found.bind((LOOPBACK, port))
        found.listen()
    except (OSError, OverflowError, TypeError):
        found.close()
        raise
    return found


def _in_notebook() -> bool:
    import sys

    kernel = sys.modules.get("ipykernel")
    return kernel is not None and getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)() is not None
