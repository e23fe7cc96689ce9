"""What a client can do, as it says in `initialize`."""

from __future__ import annotations

from collections.abc import Iterable

from lsprotocol import types
from pygls.capabilities import get_capability

from elitescript.lsp.positions import UTF16, chosen_encoding


class Client:
    """Holds the capabilities of the client.

    Attributes:
        capabilities: all of them.
        encoding: what it counts in.
    """

    __slots__ = ("capabilities", "encoding")

    def __init__(self, capabilities: types.ClientCapabilities | None = None) -> None:
        self.capabilities = capabilities or types.ClientCapabilities()
        general = self.capabilities.general
        offered: Iterable[str] | None = None if general is None else general.position_encodings
        self.encoding = UTF16 if offered is None else chosen_encoding(map(_text, offered))

    def has(self, name: str) -> bool:
        """Return whether it has a capability, such as `workspace.configuration`; a table counts as one."""
        value = get_capability(self.capabilities, name)
        return value is not None and value is not False


def _text(encoding: types.PositionEncodingKind | str) -> str:
    return encoding.value if isinstance(encoding, types.PositionEncodingKind) else encoding
