"""Messages of the Debug Adapter Protocol: their form, the reading of requests, and errors.

Source: the protocol's JSON schema, <https://microsoft.github.io/debug-adapter-protocol/specification>.
"""

from __future__ import annotations

from math import isfinite
from typing import Any, Final, NoReturn

from elitescript.shown import visible

Message = dict[str, Any]
Body = dict[str, Any]

MALFORMED: Final = 1000
UNKNOWN_REQUEST: Final = 1001
WRONG_ARGUMENTS: Final = 1002
OUT_OF_ORDER: Final = 1003
IS_RUNNING: Final = 1004
REFUSED: Final = 1005
CANCELLED: Final = 1006
DOES_NOT_COMPILE: Final = 1007
FAULT: Final = 1008
"""A mistake of the adapter's own."""
ENDED: Final = 1009
"""The process that debugs has ended, or does not answer."""

WORDS: Final = {CANCELLED: "cancelled", IS_RUNNING: "notStopped"}
"""`message` of a response for errors that the protocol has a word for; the text for all others."""


class RequestError(Exception):
    """A request that is answered with an error.

    Args:
        number: one of the numbers above: `body.error.id` of the response.
        text: what is wrong, for the user.
        is_shown: whether the editor should show it in a window of its own.
    """

    def __init__(self, number: int, text: str, *, is_shown: bool = False) -> None:
        super().__init__(text)
        self.number = number
        self.is_shown = is_shown


def response(request_seq: int, command: str, body: Body | None = None) -> Message:
    """Return the response to a request that was carried out; `seq` is set where it is sent."""
    message: Message = {"type": "response", "request_seq": request_seq, "success": True, "command": command}
    if body is not None:
        message["body"] = body
    return message


def error_response(request_seq: int, command: str, error: RequestError) -> Message:
    """Return the response to a request that was not carried out."""
    text = visible(str(error))
    details = {"id": error.number, "format": text.replace("{", "(").replace("}", ")"), "showUser": error.is_shown}
    return {
        "type": "response",
        "request_seq": request_seq,
        "success": False,
        "command": command,
        "message": WORDS.get(error.number, text),
        "body": {"error": details},
    }


def event(name: str, body: Body | None = None) -> Message:
    """Return an event."""
    message: Message = {"type": "event", "event": name}
    if body is not None:
        message["body"] = body
    return message


_KINDS: Final = {str: "a text", int: "a whole number", float: "a number", bool: "true or false", list: "a list"}


class Arguments:
    """The arguments of a request, each checked when it is read.

    Args:
        data: the JSON object; anything else is refused when it is read.
        place: what it is, for error texts.
    """

    __slots__ = ("_data", "_place")

    def __init__(self, data: Any, place: str) -> None:
        self._place = place
        if data is None:
            data = {}
        if not isinstance(data, dict):
            raise RequestError(WRONG_ARGUMENTS, f"{place}: not an object")
        self._data: dict[str, Any] = data

    @property
    def data(self) -> dict[str, Any]:
        """The object itself."""
        return self._data

    def has(self, name: str) -> bool:
        """Return whether an argument is given; null counts as not given."""
        return self._data.get(name) is not None

    def text(self, name: str, default: str | None = None) -> str:
        """Return a text; required without a default."""
        return str(self._read(name, str, default))

    def number(self, name: str, default: int | None = None, *, least: int = 0) -> int:
        """Return a whole number, `least` or more; required without a default."""
        value = self._read(name, int, default)
        if not least <= value < 1 << 53:
            self.refuse(name, f"{least} or more", value)
        return int(value)

    def real(self, name: str) -> float:
        """Return a required finite number."""
        value = self._data.get(name)
        if isinstance(value, bool) or not isinstance(value, int | float):
            self.refuse(name, _KINDS[float], value)
        if abs(value) > 1e300 or not isfinite(value):
            self.refuse(name, "a finite number", value)
        return float(value)

    def flag(self, name: str, default: bool = False) -> bool:
        """Return true or false."""
        return bool(self._read(name, bool, default))

    def texts(self, name: str) -> list[str]:
        """Return a list of texts; empty if it is not given."""
        values: list[Any] = self._read(name, list, [])
        for value in values:
            if not isinstance(value, str):
                self.refuse(name, "a list of texts", value)
        return values

    def items(self, name: str) -> list[Arguments]:
        """Return a list of objects; empty if it is not given."""
        values: list[Any] = self._read(name, list, [])
        return [Arguments(value, f"{self._place}: {name}[{at}]") for at, value in enumerate(values)]

    def inner(self, name: str) -> Arguments:
        """Return an object; an empty one if it is not given."""
        return Arguments(self._data.get(name), f"{self._place}: {name}")

    def refuse(self, name: str, wanted: str, value: Any) -> NoReturn:
        """Raise the error for an argument that is not what it must be."""
        if value is None:
            raise RequestError(WRONG_ARGUMENTS, f"{self._place}: {name} is missing; it must be {wanted}")
        raise RequestError(WRONG_ARGUMENTS, f"{self._place}: {name} must be {wanted}, got {shown(value)}")

    def _read(self, name: str, kind: type, default: Any) -> Any:
        value = self._data.get(name)
        if value is None:
            value = default
        if not isinstance(value, kind) or (kind is int and isinstance(value, bool)):
            self.refuse(name, _KINDS[kind], value)
        return value


def shown(value: Any) -> str:
    """Return a value of JSON for an error text, cut to 60 characters."""
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."
