"""Says of the result of a command what its type does not: where it comes from, and which values stand for a failure.

A command's return annotation carries one, `-> Annotated[JointPositions, MEASURED]`; the checker, `elitescript
commands`, hover and the reference read it.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

ORIGINS: Final = {
    "measured": "measured",
    "commanded": "commanded",
    "channel": "sent by a peer",
    "signal": "a signal or register",
    "handle": "",
    "state": "",
    "computed": "",
}
"""Origins of results, and their words; empty for what no text has to say: a handle, a state, a computation."""


class Result:
    """Describes where the result of a command comes from.

    Attributes:
        origin: one of `ORIGINS`.
        special: values with a meaning of their own, such as `{-1: "not found"}`.
        counted_by: parameter that says how many values follow the first element, which is how many arrived.
        may_be_late: there may be no value yet.
        kinds: types that it can have, where the quantity does not say it: of `bool`, `int`, `float`, `list`, `bytes`.
    """

    __slots__ = ("counted_by", "kinds", "may_be_late", "origin", "special")

    def __init__(
        self,
        origin: str,
        special: Mapping[Any, str] | None = None,
        *,
        counted_by: str = "",
        may_be_late: bool = False,
        kinds: tuple[type, ...] = (),
    ) -> None:
        self.origin = origin
        self.special = special or {}
        self.counted_by = counted_by
        self.may_be_late = may_be_late
        self.kinds = kinds

    @property
    def text(self) -> str:
        """What a description of the command adds; empty for nothing."""
        words = ORIGINS[self.origin]
        parts = [f"Origin: {words}."] if words else []
        parts += [f"{value!r}: {meaning}." for value, meaning in self.special.items()]
        if self.may_be_late:
            parts.append("There may be no value yet.")
        return " ".join(parts)


MEASURED: Final = Result("measured")
COMMANDED: Final = Result("commanded")
RECEIVED: Final = Result("channel")
SIGNAL: Final = Result("signal")
HANDLE: Final = Result("handle")
STATE: Final = Result("state")
COMPUTED: Final = Result("computed")
DONE: Final = Result("state", {False: "failed"})
