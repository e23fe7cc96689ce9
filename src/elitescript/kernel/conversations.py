"""Interpreter mode and the query port: what clients say line by line, and what they hear."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from elitescript.errors import ProgramError, ScriptError
from elitescript.messages.inputs import Interpret, InterpreterWord, Query
from elitescript.protocol.interpreter import (
    CLEARED,
    CLEARED_AT_END,
    CLEARED_BEFORE,
    INVALID_STATE,
    TOO_MANY,
    acknowledged,
    discarded,
    not_compiled,
    session_state,
    state_of,
)
from elitescript.protocol.query import not_executed, not_parsed, succeeded
from elitescript.runtime import interpreter
from elitescript.runtime.host import ScriptHost

REASONS: Final[dict[str, str]] = {
    interpreter.INVALID_STATE: INVALID_STATE,
    interpreter.TOO_MANY: TOO_MANY,
    interpreter.CLEARED_BEFORE: CLEARED_BEFORE,
    interpreter.CLEARED_AT_END: CLEARED_AT_END,
    interpreter.CLEARED: CLEARED,
}
"""Why a statement is discarded, in the words of the port."""

Reply = Callable[[str, str], None]
"""Takes the origin of what was asked, and the text for it."""


class Conversations:
    """What clients of both ports hear.

    Args:
        host: runs statements and queries.
        reply: sends an answer.
    """

    __slots__ = ("_host", "_reply")

    def __init__(self, host: ScriptHost, reply: Reply) -> None:
        self._host = host
        self._reply = reply
        host.interpreter.answers = self

    def interpret(self, item: Interpret) -> None:
        """A statement of interpreter mode; the answer may come in a later tick."""
        self._host.interpreter.submit(item.origin, item.text)

    def word(self, item: InterpreterWord) -> None:
        """A word that does not wait its turn."""
        statements = self._host.interpreter
        numbers = {
            "statelastexecuted": statements.last_executed,
            "statelastinterpreted": statements.last_accepted,
            "statelastcleared": statements.last_cleared,
            "stateunexecuted": statements.unexecuted,
        }
        if item.word == "skipbuffer":
            statements.skip()
        elif item.word == "abort":
            self._host.abort_move()
        elif item.word == "state":
            self._reply(item.origin, session_state(statements.is_running))
        elif item.word in numbers:
            self._reply(item.origin, state_of(numbers[item.word], item.word))

    def accepted(self, origin: str, number: int, text: str) -> None:
        """See `runtime.interpreter.Answers`."""
        self._reply(origin, acknowledged(number, text))

    def discarded(self, origin: str, reason: str, text: str, trace: str = "") -> None:
        """See `runtime.interpreter.Answers`."""
        if reason == interpreter.COMPILE_ERROR:
            self._reply(origin, not_compiled(trace, text))
        else:
            self._reply(origin, discarded(REASONS[reason], text))

    def query(self, item: Query) -> None:
        """A query; the answer comes in this tick or a later one."""

        def answer(value: str | None) -> None:
            self._reply(item.origin, not_executed(item.ident) if value is None else succeeded(item.ident, value))

        try:
            self._host.query(item.text, answer)
        except ProgramError:
            self._reply(item.origin, not_parsed(item.ident))
        except ScriptError:
            answer(None)
