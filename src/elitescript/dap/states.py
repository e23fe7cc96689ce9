"""What a debug session may be doing, and what is done with requests that come meanwhile."""

from __future__ import annotations

from enum import Enum
from typing import Final


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
