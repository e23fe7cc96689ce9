"""`re` for scripts. Flags have a class of their own, because that of the real ones leads to every loaded module."""

from __future__ import annotations

from typing import Any, Final

from elitescript.runtime.stdlib.loader import forwarded, real
from elitescript.sealed import Sealed

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


class RegexFlag(int, metaclass=Sealed):
    """A flag, or several of them."""

    __slots__ = ()
    __module__ = "re"

    def __or__(self, other: Any) -> Any:
        return RegexFlag(int(self) | other) if isinstance(other, int) else NotImplemented

    def __and__(self, other: Any) -> Any:
        return RegexFlag(int(self) & other) if isinstance(other, int) else NotImplemented

    def __xor__(self, other: Any) -> Any:
        return RegexFlag(int(self) ^ other) if isinstance(other, int) else NotImplemented

    def __invert__(self) -> Any:
        return RegexFlag(~real("re").RegexFlag(int(self)))

    __ror__ = __or__
    __rand__ = __and__
    __rxor__ = __xor__

    def __repr__(self) -> str:
        return repr(real("re").RegexFlag(int(self)))

    __str__ = __repr__


def re_names() -> dict[str, Any]:
    """Return the public names of `re`."""
    host = real("re")
    names: dict[str, Any] = {name: forwarded(getattr(host, name)) for name in _FUNCTIONS.split()}
    flags = {name: RegexFlag(value) for name, value in _FLAGS.items()}
    return {**names, **flags, "RegexFlag": RegexFlag, "Match": host.Match, "Pattern": host.Pattern, "error": host.error}
