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
        frame: in which a pose is given: `base`, or the parameter in whose frame it is; empty if it says nothing.
        special: values with a meaning of their own, such as `{-1: "not found"}`.
        counted_by: parameter that says how many values follow the first element, which is how many arrived.
        may_be_late: there may be no value yet.
        kinds: types that it can have, where the quantity does not say it: of `bool`, `int`, `float`, `list`, `bytes`.
    """

    __slots__ = ("counted_by", "frame", "kinds", "may_be_late", "origin", "special")

    def __init__(
        self,
        origin: str,
        special: Mapping[Any, str] | None = None,
        *,
        counted_by: str = "",
        frame: str = "",
        may_be_late: bool = False,
        kinds: tuple[type, ...] = (),
    ) -> None:
        self.origin = origin
        self.special = special or {}
        self.counted_by = counted_by
        self.frame = frame
        self.may_be_late = may_be_late
        self.kinds = kinds

    @property
    def special_text(self) -> str:
        """What values with a meaning of their own mean, and whether there may be none yet; empty for nothing."""
        parts = [f"{value!r}: {meaning}." for value, meaning in self.special.items()]
        return " ".join([*parts, *(["There may be no value yet."] if self.may_be_late else [])])

    @property
    def text(self) -> str:
        """What a description of the command adds; empty for nothing."""
        words = ORIGINS[self.origin]
        return " ".join(part for part in (f"Origin: {words}." if words else "", self.special_text) if part)


MEASURED: Final = Result("measured")
COMMANDED: Final = Result("commanded")
MEASURED_IN_BASE: Final = Result("measured", frame="base")
COMMANDED_IN_BASE: Final = Result("commanded", frame="base")
COMPUTED_IN_BASE: Final = Result("computed", frame="base")
RECEIVED: Final = Result("channel")
SIGNAL: Final = Result("signal")
HANDLE: Final = Result("handle")
STATE: Final = Result("state")
COMPUTED: Final = Result("computed")
DONE: Final = Result("state", {False: "failed"})
WRITTEN: Final = Result("state", {0: "failed"})
