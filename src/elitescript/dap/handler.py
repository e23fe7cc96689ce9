"""What a request of the protocol is: when it may come, and what answers it."""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum
from typing import TYPE_CHECKING, Final

from elitescript.dap.messages import Arguments, Body
from elitescript.records import NamedTuple

if TYPE_CHECKING:
    from elitescript.dap.adapter import Adapter


class State(Enum):
    """What a debug session is doing; the values are for error texts."""

    NEW = "before initialize"
    INITIALIZED = "before launch"
    CONFIGURING = "before configurationDone"
    STOPPED = "while the program is stopped"
    RUNNING = "while the program runs"
    ENDED = "after the end of the program"


WITH_PROGRAM: Final = frozenset((State.CONFIGURING, State.STOPPED, State.RUNNING, State.ENDED))
BEGUN: Final = frozenset((State.STOPPED, State.RUNNING, State.ENDED))
STANDING: Final = frozenset((State.STOPPED,))


class WhileRunning(Enum):
    """What is done with a request that comes while the program runs."""

    REFUSE = "answered with an error"
    ANSWER = "answered at once, without the run"
    INTERRUPT = "answered between two statements"


class Handler(NamedTuple):
    """One request.

    Attributes:
        answer: checks the arguments, carries it out, returns the body of the response; `LATER` if that comes later.
        states: in which it may come.
        while_running: what is done with it then, if `states` has that.
    """

    answer: Callable[[Adapter, Arguments], Body | None]
    states: frozenset[State]
    while_running: WhileRunning = WhileRunning.REFUSE


LATER: Final[Body] = {}
"""Result of a handler whose response is sent later."""
