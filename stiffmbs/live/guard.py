"""Guard of a server on the loopback interface: token, Host and Origin of each request, and headers of each answer.

A page of another site may send requests to the loopback interface, and a name of its own may resolve to it (DNS
rebinding).  So a request counts only with the token of this server in its path, a Host that is this server, and no other
Origin.  W3C, Content Security Policy Level 3; RFC 6454, section 7.
"""

from __future__ import annotations

import secrets
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from starlette.types import ASGIApp, Message, Receive, Scope, Send

LARGEST = 4_000_000
"""Largest length of a request, bytes."""
NAMES = ("127.0.0.1", "localhost")
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

    Parameters
    ----------
    app : ASGI application
        Guarded application; its paths begin with the token.
    """

    def __init__(self, app: ASGIApp, token: str, port: int) -> None:
        self._app, self._token = app, token
        self._hosts = {f"{name}:{port}" for name in NAMES}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request, or refuse it with a reason."""
        if scope["type"] != "http":
            return
        refusal = self._refusal(scope)
        if refusal:
            status, reason = refusal
            await send(
                {
                    "type": "http.response.start",
                    "status": status,
                    "headers": _headers([(b"content-type", b"text/plain")]),
                }
            )
            await send({"type": "http.response.body", "body": reason.encode()})
            return

        async def guarded(message: Message) -> None:
            if message["type"] == "http.response.start":
                message = {**message, "headers": _headers(message["headers"])}
            await send(message)

        await self._app(scope, receive, guarded)

    def _refusal(self, scope: Scope) -> tuple[int, str] | None:
        """Return status and reason for a request that is refused."""
        heads = {name.decode("latin-1"): value.decode("latin-1") for name, value in scope["headers"]}
        if heads.get("host", "") not in self._hosts:
            return 403, "refused: the Host is not this server"
        if heads.get("origin", f"http://{heads['host']}") != f"http://{heads['host']}":
            return 403, "refused: the request comes from another site"
        if scope["method"] == "POST" and "origin" not in heads:
            return 403, "refused: a change without an Origin"
        given = scope["path"].split("/")[1]
        if not secrets.compare_digest(given.encode(), self._token.encode()):
            return 403, "refused: the address needs the token that 'stiffmbs open' printed"
        length = heads.get("content-length", "0")
        if not length.isdigit() or int(length) > LARGEST or "transfer-encoding" in heads:
            return 413, f"refused: more than {LARGEST} bytes"
        return None


def _headers(own: Any) -> list[tuple[bytes, bytes]]:
    return [*own, *((name.encode(), value.encode()) for name, value in HEADERS.items())]
