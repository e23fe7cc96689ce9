"""The studio's port on this computer: the page and its files as plain answers, one WebSocket for each open page.

One library listens for both (docs/explanation/decisions/0018-websockets.md): what comes in is admitted by
`admission.refusal`, and a page's conversation is a `Session`.
"""

from __future__ import annotations

import asyncio
import logging
import traceback
from base64 import b64encode
from collections.abc import Awaitable, Callable
from hashlib import sha256
from http import HTTPStatus
from pathlib import PurePosixPath
from typing import Final, Protocol

from websockets.asyncio.server import Server, ServerConnection, serve
from websockets.datastructures import Headers
from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request as HttpRequest
from websockets.http11 import Response

from elitescript import page
from elitescript.conversation.messages import MESSAGE_BYTES_MAX
from elitescript.studio.admission import PAGE, SOCKET, Request, is_same, new_token, refusal
from elitescript.studio.outbox import BUFFERED_BYTES, Outbox

HOST: Final = "127.0.0.1"

CONNECTIONS_MAX: Final = 64
"""Open connections; one more aborts the oldest that is not the conversation of a page."""

PAGES_MAX: Final = 16
"""Open pages; further ones are refused: each has processes of its own."""

OPENING_S: Final = 10.0
"""Time that a request may take to arrive, s."""

CLOSING_S: Final = 1.0
"""Time that a page has to say goodbye, s."""

POLICY: Final = (
    "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; img-src data: blob:; connect-src 'self'; "
    "worker-src 'self' blob:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)

POLICY_HEADER: Final = "Content-Security-Policy"

HEADERS: Final = (
    (POLICY_HEADER, POLICY),
    ("X-Content-Type-Options", "nosniff"),
    ("Referrer-Policy", "no-referrer"),
    ("Cross-Origin-Opener-Policy", "same-origin"),
    ("Cache-Control", "no-store"),
)
"""Of every answer, unless it has another policy."""

_AGAIN: Final = """
const token = sessionStorage.getItem("elitescript-token");
sessionStorage.removeItem("elitescript-token");
if (token !== null) location.replace("/?token=" + encodeURIComponent(token));
"""
"""Of the page that refuses: a tab that was the page before, and is loaded again, knows its token still."""

_REFUSED: Final = f"<!doctype html><meta charset=utf-8><title>elitescript</title><p>@@why@@<script>{_AGAIN}</script>"

_POLICY_OF_REFUSED: Final = (
    f"default-src 'none'; script-src 'sha256-{b64encode(sha256(_AGAIN.encode()).digest()).decode()}'; base-uri 'none'; "
    "form-action 'none'; frame-ancestors 'none'"
)

_TYPES: Final = {
    ".css": "text/css; charset=utf-8",
    ".html": "text/html; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".txt": "text/plain; charset=utf-8",
}


class Conversation(Protocol):
    """What a page talks to."""

    async def take(self, text: str | bytes) -> None:
        """Take one message of the page; the next one comes when this returns."""

    async def close(self) -> None:
        """End everything that goes on for the page."""


class Door:
    """The port.

    Args:
        begin: begins the conversation with a page that has connected; what it puts into the outbox is sent.

    Attributes:
        heard: called for each message of a page.
        port: number of the port, once it is open.
    """

    def __init__(self, begin: Callable[[Outbox], Awaitable[Conversation]]) -> None:
        self.heard: Callable[[], None] = lambda: None
        self._begin = begin
        self._token = new_token()
        self._ticket: str | None = None
        self._server: Server | None = None
        self._pages: set[ServerConnection] = set()
        self._connections: dict[ServerConnection, None] = {}
        """All of them, the oldest first."""
        self.port = 0

    @property
    def address(self) -> str:
        """The address of the page, with the token."""
        return self._address(self._token)

    def ticket_address(self) -> str:
        """Return an address that leads to the page once.

        Every user of this computer can read the arguments of a browser that is started, so the token is not in them.
        """
        self._ticket = new_token()
        return self._address(self._ticket)

    def _address(self, token: str) -> str:
        return f"http://{HOST}:{self.port}{PAGE}?token={token}"

    async def open(self, port: int) -> None:
        """Listen on a port of this computer; 0 is any free one.

        Raises:
            OSError: the port cannot be had.
        """
        silent = logging.getLogger(f"{__name__}.library")
        # It would print a traceback for everything that is no request.
        silent.disabled = True
        self._server = await serve(
            self._talk,
            HOST,
            port,
            process_request=self._answer,
            process_response=_with_headers,
            server_header=None,
            compression=None,
            open_timeout=OPENING_S,
            close_timeout=CLOSING_S,
            max_size=MESSAGE_BYTES_MAX,
            write_limit=BUFFERED_BYTES,
            logger=silent,
            create_connection=self._connection_class(),
        )
        self.port = self._server.sockets[0].getsockname()[1]

    async def close(self) -> None:
        """Close the port and all connections; returns when every conversation has ended."""
        if self._server is not None:
            self._server.close()
            for connection in list(self._connections):
                if connection not in self._pages:
                    # What has asked for nothing yet is not waited for.
                    connection.transport.abort()
            await self._server.wait_closed()

    def _connection_class(self) -> type[ServerConnection]:
        """Return a class of connections that are counted before a byte of them has been read."""
        everyone, pages = self._connections, self._pages

        class Connection(ServerConnection):
            def connection_made(self, transport: asyncio.BaseTransport) -> None:
                super().connection_made(transport)
                everyone[self] = None
                if len(everyone) > CONNECTIONS_MAX:
                    # Clients that hang, or that come in floods, must not keep the page out.
                    next(other for other in everyone if other not in pages).transport.abort()

            def connection_lost(self, exc: Exception | None) -> None:
                everyone.pop(self, None)
                super().connection_lost(exc)

        return Connection

    # ---------------------------------------------------------------- plain requests

    def _answer(self, connection: ServerConnection, given: HttpRequest) -> Response | None:
        """Return the answer to a request; None for the WebSocket of a page."""
        hosts, origins = given.headers.get_all("Host"), given.headers.get_all("Origin")
        # Older versions of the library let only GET through and do not name it.
        request = Request(getattr(given, "method", "GET"), given.path, hosts, origins)
        public = {f"/{name}" for name in page.names() if not name.endswith(".html")}
        if refused := refusal(request, self.port, self._token, public):
            if refused.status == HTTPStatus.FORBIDDEN and self._takes_ticket(request):
                return _response(HTTPStatus.SEE_OTHER, "text/plain", b"", ("Location", f"{PAGE}?token={self._token}"))
            if refused.status == HTTPStatus.FORBIDDEN and request.path == PAGE:
                body = _REFUSED.replace("@@why@@", refused.text).encode(errors="backslashreplace")
                return _response(HTTPStatus.FORBIDDEN, _TYPES[".html"], body, (POLICY_HEADER, _POLICY_OF_REFUSED))
            return _response(HTTPStatus(refused.status), _TYPES[".txt"], refused.text.encode(errors="backslashreplace"))
        if request.path == SOCKET:
            if len(self._pages) >= PAGES_MAX:
                return _response(HTTPStatus.SERVICE_UNAVAILABLE, _TYPES[".txt"], b"Too many pages are open.\n")
            return None
        name = page.STUDIO if request.path == PAGE else request.path.removeprefix("/")
        kind = _TYPES.get(PurePosixPath(name).suffix, "application/octet-stream")
        return _response(HTTPStatus.OK, kind, page.built(name))

    def _takes_ticket(self, request: Request) -> bool:
        """Return whether a request for the page has the ticket, which is then used up."""
        if self._ticket is None or request.path != PAGE or not is_same(request.token, self._ticket):
            return False
        self._ticket = None
        return True

    # ---------------------------------------------------------------- pages

    async def _talk(self, connection: ServerConnection) -> None:
        self._pages.add(connection)
        outbox = Outbox(connection.send, connection.transport.abort)
        sending = asyncio.create_task(_send(outbox))
        conversation: Conversation | None = None
        try:
            conversation = await self._begin(outbox)
            async for message in connection:
                self.heard()
                await conversation.take(message)
        except ConnectionClosed:
            # The page is gone without a goodbye, or has sent too much.
            pass
        except Exception:
            traceback.print_exc()
            # The library ends the connection: the page begins anew.
            raise
        finally:
            self._pages.discard(connection)
            sending.cancel()
            if conversation is not None:
                await conversation.close()


async def _send(outbox: Outbox) -> None:
    try:
        await outbox.run()
    except ConnectionClosed:
        # The reader of the connection ends the conversation.
        return


def _response(status: HTTPStatus, kind: str, body: bytes, *more: tuple[str, str]) -> Response:
    headers = Headers([("Content-Type", kind), ("Content-Length", str(len(body))), ("Connection", "close"), *more])
    return Response(status.value, status.phrase, headers, body)


def _with_headers(connection: ServerConnection, request: HttpRequest, response: Response) -> None:
    for name, value in HEADERS:
        if name not in response.headers:
            response.headers[name] = value
