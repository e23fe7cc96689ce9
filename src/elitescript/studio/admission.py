"""Decides which HTTP requests the studio's port answers, before anything else is read of them.

The port is reachable for every program of this computer, and through a browser for every page that the browser shows.
So a request must name this server (`Host`: a page whose name was bound to 127.0.0.1 afterwards does not), know the
token, which only the printed address has, and, for the WebSocket, come from the page of this server (`Origin`: browsers
let every page open WebSockets anywhere). The built files of the page are the same in every installation of the package
and hold nothing secret: they need no token, so that the page can load them by relative names.
"""

from __future__ import annotations

import secrets
from collections.abc import Collection, Sequence
from typing import Final

from elitescript.records import NamedTuple

PAGE: Final = "/"
SOCKET: Final = "/socket"

TOKEN_BYTES: Final = 32

_HTTP_PORT: Final = 80
"""Browsers leave it out of `Host` and `Origin`."""


class Request(NamedTuple):
    """What admission depends on.

    Attributes:
        method: such as `GET`.
        target: path and query as they were sent.
        hosts: values of all `Host` headers.
        origins: values of all `Origin` headers.
    """

    method: str
    target: str
    hosts: Sequence[str]
    origins: Sequence[str] = ()

    @property
    def path(self) -> str:
        """The target without its query; as it was sent, so that no encoding makes two names of one thing."""
        return self.target.partition("?")[0]

    @property
    def token(self) -> str:
        """The token of the query, as it was sent; empty without one, or with several."""
        rows = self.target.partition("?")[2].split("&")
        found = [value for name, _, value in (row.partition("=") for row in rows) if name == "token"]
        return found[0] if len(found) == 1 else ""


class Refusal(NamedTuple):
    """The status and the text of an answer that refuses a request."""

    status: int
    text: str


def new_token() -> str:
    """Return a token that nobody can guess, of characters that need no encoding in an address."""
    return secrets.token_urlsafe(TOKEN_BYTES)


def is_same(given: str, token: str) -> bool:
    """Return whether a token is the right one, in a time that does not depend on where it differs."""
    return secrets.compare_digest(given.encode("utf-8", "replace"), token.encode())


def hosts_of(port: int) -> tuple[str, ...]:
    """Return the values of `Host` that name a server on a port of this computer."""
    names = ("127.0.0.1", "localhost")
    return tuple(f"{name}:{port}" for name in names) + (names if port == _HTTP_PORT else ())


def refusal(request: Request, port: int, token: str, public: Collection[str]) -> Refusal | None:
    """Return why a request is not answered; None if it is.

    Args:
        request: of a client.
        port: of this server.
        token: of this server.
        public: paths that need no token.
    """
    if len(request.hosts) != 1 or request.hosts[0] not in hosts_of(port):
        return Refusal(421, f"This server is http://127.0.0.1:{port}/ and has no other name.\n")
    path = request.path
    if path not in public and not is_same(request.token, token):
        return Refusal(403, "The token is missing or wrong: open the address that `elitescript studio` has printed.\n")
    if path == SOCKET and list(request.origins) != [f"http://{request.hosts[0]}"]:
        return Refusal(403, "Only the page of this server may connect.\n")
    if request.method != "GET":
        return Refusal(405, "Only GET is answered.\n")
    if path not in (PAGE, SOCKET) and path not in public:
        return Refusal(404, "There is no such page.\n")
    return None
