"""Application of a live page: its own files, the scene's text, and requests that a worker answers.

No file is served by its path: a page gets the text of its scene, and files of the package by fixed names.

A page of another site may send requests to the loopback interface, and a name of its own may resolve to it (DNS
rebinding).  So a request counts only with the token of this server in its path, a Host that is this server, and no other
Origin.  W3C, Content Security Policy Level 3; RFC 6454, section 7.

When the server has ended, another program may bind its port.  So a page first lets the server prove that it knows the
token, by the HMAC (RFC 2104) of a random number of the page.  Only then does the page send the token and the text.
"""

from __future__ import annotations

import asyncio
import hashlib
import hmac
import json
import re
import secrets
from collections.abc import AsyncIterator, Awaitable, Callable
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import InputError
from ..model.schema import scene_schema
from ..reading.files.text_file import file_content, file_text
from ..results.files import write_text
from .worker import STOP
from .workers import Workers

if TYPE_CHECKING:
    from starlette.applications import Starlette
    from starlette.requests import Request
    from starlette.responses import Response
    from starlette.types import ASGIApp, Message, Receive, Scope, Send


LARGEST = 4_000_000
"""Largest length of a request, bytes."""
NAMES = ("127.0.0.1", "localhost")
CHALLENGE = re.compile(r"/prove/([0-9a-f]{32})")
"""Path, without the token, by which a page asks the server to prove itself; the group is the page's number."""
POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'self' http://localhost:* http://127.0.0.1:* https://localhost:* vscode-webview:"
)
"""Content security policy: nothing is loaded from elsewhere; styles of the editor are inline; notebooks may frame it."""
HEADERS = {
    "content-security-policy": POLICY, "x-content-type-options": "nosniff", "referrer-policy": "no-referrer",
    "cache-control": "no-store", "cross-origin-resource-policy": "same-origin",
}  # fmt: skip


class Guard:
    """ASGI application that refuses requests that do not come from the server's own page.

    `app`: guarded application; its paths begin with the token.
    """

    def __init__(self, app: ASGIApp, token: str, port: int) -> None:
        self._app, self._token = app, token
        self._hosts = {f"{name}:{port}" for name in NAMES}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request, or refuse it with a reason."""
        if scope["type"] != "http":
            return
        refusal = self._of_another(scope) or self._proof(scope) or self._refusal(scope)
        if refusal:
            status, reason = refusal
            head = {
                "type": "http.response.start",
                "status": status,
                "headers": _headers([(b"content-type", b"text/plain")]),
            }
            await send(head)
            await send({"type": "http.response.body", "body": reason.encode()})
            return

        async def guarded(message: Message) -> None:
            if message["type"] == "http.response.start":
                message = {**message, "headers": _headers(message["headers"])}
            await send(message)

        await self._app(scope, receive, guarded)

    def _of_another(self, scope: Scope) -> tuple[int, str] | None:
        """Return status and reason for a request of another site."""
        heads = _heads(scope)
        if heads.get("host", "") not in self._hosts:
            return 403, "refused: the Host is not this server"
        if heads.get("origin", f"http://{heads['host']}") != f"http://{heads['host']}":
            return 403, "refused: the request comes from another site"
        if scope["method"] == "POST" and "origin" not in heads:
            return 403, "refused: a change without an Origin"
        return None

    def _proof(self, scope: Scope) -> tuple[int, str] | None:
        """Return the answer to a request for a proof: the code of its number by the token."""
        asked = CHALLENGE.fullmatch(scope["path"])
        return (200, hmac.new(self._token.encode(), asked[1].encode(), "sha256").hexdigest()) if asked else None

    def _refusal(self, scope: Scope) -> tuple[int, str] | None:
        """Return status and reason for a request that is refused."""
        heads = _heads(scope)
        given = f"{scope['path']}/".split("/")[1]
        if not secrets.compare_digest(given.encode(), self._token.encode()):
            return 403, "refused: the address needs the token that 'stiffmbs open' printed"
        length = heads.get("content-length", "0")
        if not length.isdigit() or int(length) > LARGEST or "transfer-encoding" in heads:
            return 413, f"refused: more than {LARGEST} bytes"
        return None


def _heads(scope: Scope) -> dict[str, str]:
    return {name.decode("latin-1"): value.decode("latin-1") for name, value in scope["headers"]}


def _headers(own: Any) -> list[tuple[bytes, bytes]]:
    return [*own, *((name.encode(), value.encode()) for name, value in HEADERS.items())]


OWN = {
    "live.css": ("stiffmbs.live.static", "text/css"), "live.js": ("stiffmbs.live.static", "text/javascript"),
    "completion.js": ("stiffmbs.live.static", "text/javascript"),
    "editor.min.js": ("stiffmbs.live.static", "text/javascript"),
    "three.min.js": ("stiffmbs.show.page", "text/javascript"),
    "first_scene.yaml": ("stiffmbs.commands", "text/plain"),
    "viewer.js": ("stiffmbs.show.page", "text/javascript"), "viewer.css": ("stiffmbs.show.page", "text/css"),
}  # fmt: skip
"""Files of the page: their packages and types."""


@dataclass
class Document:
    """Text of a scene and its file.

    `file`: file that is read and saved. `text`: text of a scene without a file. `editable`: false for a model that no
    text describes.
    """

    file: Path | None
    text: str
    editable: bool = True

    def read(self) -> tuple[str, str]:
        """Return the text and a digest of the file's content, which is empty if there is no file."""
        if self.file is None or not self.file.exists():
            return self.text, ""
        return file_text(self.file), _digest(self.file)

    def save(self, text: str, digest: str) -> str:
        """Write the file and return the digest of its new content.

        Raises InputError if there is no file, or if it is not that of the digest any more.
        """
        if self.file is None or not self.editable:
            raise InputError("found no file to save to, expected a page that was opened with one; use 'Download scene'")
        if _digest(self.file) != digest:
            raise InputError(f"{self.file.name} has changed since this page read it")
        write_text(self.file, text)
        return _digest(self.file)


def _digest(file: Path) -> str:
    return hashlib.sha256(file_content(file, "a scene")).hexdigest() if file.exists() else ""


def application(token: str, document: Document, workers: Workers) -> Starlette:
    """Return the application; all its paths begin with the token."""
    from starlette.applications import Starlette
    from starlette.responses import JSONResponse, Response, StreamingResponse
    from starlette.routing import Route

    schema: list[bytes] = []

    async def page(request: Request) -> Response:
        return Response(files("stiffmbs.live.static").joinpath("live.html").read_bytes(), media_type="text/html")

    async def own(request: Request) -> Response:
        found = OWN.get(request.path_params["name"])
        if found is None:
            return Response("no such file", status_code=404)
        return Response(files(found[0]).joinpath(request.path_params["name"]).read_bytes(), media_type=found[1])

    async def start(request: Request) -> Response:
        workers.start_ahead()
        text, digest = document.read()
        name = document.file.name if document.file else ""
        return JSONResponse({"text": text, "digest": digest, "name": name, "editable": document.editable})

    async def refused(request: Request, error: Exception) -> Response:
        return JSONResponse({"message": str(error)}, status_code=409)

    async def described(request: Request) -> Response:
        if not schema:
            schema.append(json.dumps(await asyncio.to_thread(scene_schema)).encode())
        return Response(schema[0], media_type="application/json")

    async def job(request: Request, content: dict[str, object]) -> Response:
        """Send a job to the worker of a page, and stream its messages as lines of JSON."""
        worker = workers.of(str(content.get("page", "")))
        if content.get("what") == STOP:
            worker.put({"what": STOP})
            return JSONResponse({})

        async def lines() -> AsyncIterator[str]:
            async for message in worker.channel.answers(content, worker.put):
                yield json.dumps(message) + "\n"

        return StreamingResponse(lines(), media_type="application/x-ndjson")

    async def save(request: Request, content: dict[str, object]) -> Response:
        """Write the document, unless its file was changed elsewhere."""
        try:
            digest = str(content.get("digest"))
            if content.get("over") is True and document.file is not None:
                digest = _digest(document.file)
            text = content.get("text")
            if not isinstance(text, str):
                raise InputError("found no text, expected that of the scene")
            return JSONResponse({"digest": document.save(text, digest)})
        except UnicodeEncodeError as error:
            return JSONResponse({"message": f"not saved: {error}"}, status_code=409)
        except OSError as error:
            return JSONResponse({"message": f"not saved: {error.strerror or error}"}, status_code=409)

    async def close(request: Request, content: dict[str, object]) -> Response:
        workers.end(str(content.get("page", "")))
        return JSONResponse({})

    return Starlette(
        routes=[
            Route(f"/{token}/", page),
            Route(f"/{token}/own/{{name}}", own),
            Route(f"/{token}/start", start),
            Route(f"/{token}/schema", described),
            Route(f"/{token}/job", _posted(job), methods=["POST"]),
            Route(f"/{token}/save", _posted(save), methods=["POST"]),
            Route(f"/{token}/close", _posted(close), methods=["POST"]),
        ],
        exception_handlers={InputError: refused},
    )


def _posted(
    answer: Callable[[Request, dict[str, object]], Awaitable[Response]],
) -> Callable[[Request], Awaitable[Response]]:
    """Return a route that reads a JSON object."""

    async def posted(request: Request) -> Response:
        """Answer a request whose body is a JSON object, and refuse others."""
        from starlette.responses import JSONResponse

        try:
            content = json.loads(await request.body())
        except (ValueError, RecursionError):
            content = None
        if not isinstance(content, dict):
            return JSONResponse({"message": "found no JSON object, expected one"}, status_code=400)
        return await answer(request, content)

    return posted
