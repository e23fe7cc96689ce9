"""`re` for scripts. Flags are plain ints, because the class of the real ones leads to every loaded module."""

from __future__ import annotations

from typing import Any, Final

from elitescript.runtime.stdlib.loader import forwarded, real

_FUNCTIONS: Final = "compile escape findall finditer fullmatch match search split sub subn"

_FLAGS: Final = {
    "A": 256,
    "ASCII": 256,
    "DOTALL": 16,
    "I": 2,
    "IGNORECASE": 2,
    "M": 8,
    "MULTILINE": 8,
    "NOFLAG": 0,
    "S": 16,
    "U": 32,
    "UNICODE": 32,
    "VERBOSE": 64,
    "X": 64,
}


def re_names() -> dict[str, Any]:
    """Return the public names of `re`."""
    host = real("re")
    names: dict[str, Any] = {name: forwarded(getattr(host, name)) for name in _FUNCTIONS.split()}
    return {**names, **_FLAGS, "Match": host.Match, "Pattern": host.Pattern, "error": host.error}
