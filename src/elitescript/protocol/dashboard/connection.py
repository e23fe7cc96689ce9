"""The dashboard shell, port 29999: one command a line, one reply each, in order.

Clients read a reply at once, so the greeting and every reply leave in one send each. A command with a result of the
robot (loading, starting, variables, unlocking) is answered when the robot has replied, others are answered at once. In
both cases later commands wait, and see the state afterwards.

Evidence: line ends, the three lines of the greeting and one reply a command are *documented* or seen in the vendor's
client; the limits, and that an empty line is not answered, are *assumed*.
"""

from __future__ import annotations

from collections import deque
from typing import Final

from elitescript.messages.inputs import Input
from elitescript.messages.outputs import Output
from elitescript.messages.profile import version_text
from elitescript.messages.snapshot import RobotDescription
from elitescript.messages.timing import TICKS_PER_S
from elitescript.protocol.connection import Connection, ProtocolError
from elitescript.protocol.dashboard.answers import Answer, Asked
from elitescript.protocol.dashboard.verbs import VERBS, DashboardCommand, unknown_text, usage_text
from elitescript.protocol.lines import PacedLines, TextLine, one_line, shown, text_bytes
from elitescript.protocol.outcomes import refusal_of, value_text

LINE_LIMIT: Final = 4096
"""Limit of a command in bytes."""
LINES_PER_TICK: Final = 100
"""Commands of one client that are read in a tick; further ones wait for the next."""
WAITING_LIMIT: Final = 64
"""Limit of commands that wait for the one before them."""
SETTLING_TICKS: Final = 4
"""Delay of the next command after one that changes the robot and is answered at once, so that it sees the change."""
ANSWER_TICKS: Final = 1000
"""Timeout of the robot's reply; the vendor's client waits 10 s."""


class DashboardConnection(Connection):
    """One client of the dashboard shell.

    Each command has its own origin, `dashboard#2/7` for the seventh line of `dashboard#2`, so that a late reply is not
    taken for that of another command.
    """

    __slots__ = ("_asked_tick", "_awaited", "_lines", "_own_origin", "_settled_tick", "_waiting")

    def __init__(self, origin: str, description: RobotDescription) -> None:
        super().__init__(origin, description)
        self._lines = PacedLines(LINE_LIMIT, LINES_PER_TICK)
        self._waiting: deque[TextLine] = deque()
        self._awaited: Answer | None = None
        self._asked_tick = 0
        self._settled_tick = 0
        self._own_origin = ""
        self._send_text(
            f"EliRobot dashboard shell, version {version_text(description.version)}.\r\n"
            "Type help to see all commands.\r\n"
            "Type help NAME to read about the command NAME."
        )

    def receive(self, data: bytes, output: Output) -> list[Input]:
        self._lines.feed(data)
        self._read(output)
        return self.due()

    def publish(self, output: Output) -> None:
        if self._awaited is not None:
            self._await(self._awaited, output)
        self._read(output)
        self._work(output)

    def _await(self, awaited: Answer, output: Output) -> None:
        outcome = next((reply.outcome for reply in output.replies if reply.origin == self._own_origin), None)
        if outcome is not None:
            why_not = refusal_of(outcome)
            if why_not is None:
                self._finish(awaited.text + one_line(value_text(outcome)))
            else:
                self._finish(f"{awaited.failure}: {one_line(why_not)}")
        elif output.tick - self._asked_tick >= ANSWER_TICKS:
            self._finish(f"{awaited.failure}: the controller has not answered for {ANSWER_TICKS // TICKS_PER_S} s")
        self._work(output)

    def _read(self, output: Output) -> None:
        for line in self._lines.take(output.tick):
            if self.is_over:
                break
            self._waiting.append(line)
            self._work(output)
            if len(self._waiting) > WAITING_LIMIT:
                raise ProtocolError(f"more than {WAITING_LIMIT} commands wait for an answer")

    def read_on(self, output: Output) -> list[Input]:
        self._lines.renew()
        self._read(output)
        return self.due()

    @property
    def is_busy(self) -> bool:
        return self._lines.is_waiting

    @property
    def is_expecting(self) -> bool:
        return self._awaited is not None or bool(self._waiting) or self._lines.is_waiting

    def _send_text(self, text: str) -> None:
        self.send(text_bytes(text) + b"\r\n")

    def _finish(self, text: str) -> None:
        self._awaited = None
        self._send_text(text)

    def _work(self, output: Output) -> None:
        while self._waiting and self._awaited is None and output.tick >= self._settled_tick:
            line = self._waiting.popleft()
            if line.problem:
                self._send_text(f"Command is not understood: {line.problem}")
            elif line.text.strip():
                self._own_origin = self.next_origin()
                self._carry_out(self._answer(line.text, output), output.tick)

    def _carry_out(self, answer: Answer, tick: int) -> None:
        self._due += answer.inputs
        if answer.failure:
            self._awaited, self._asked_tick = answer, tick
            return
        if answer.inputs:
            self._settled_tick = tick + SETTLING_TICKS
        self._send_text(answer.text)
        if answer.is_last:
            self.is_over = True
            self._waiting.clear()

    def _answer(self, text: str, output: Output) -> Answer:
        found = find_row(text)
        if isinstance(found, str):
            return Answer(found)
        row, argument = found
        if row.guard is not None and (refusal := row.guard.refusal(output.snapshot)):
            return Answer(refusal)
        return row.answer(Asked(self._own_origin, argument, output.snapshot, self.description))


def find_row(text: str) -> tuple[DashboardCommand, str] | str:
    """Return the command of a line and its argument; or the text of the error."""
    verb, _, rest = text.lstrip().replace("\t", " ").partition(" ")
    verb, rest = verb.rstrip(), rest.lstrip()
    rows = VERBS.get(verb)
    if rows is None:
        return unknown_text(verb)
    option, _, after = rest.partition(" ")
    for row in rows:
        if row.option and row.option == option:
            return _with_argument(row, after)
    for row in rows:
        if row.option and row.argument == "TEXT" and rest.startswith(row.option):
            return _with_argument(row, rest[len(row.option) :])
    bare = next((row for row in rows if not row.option), None)
    if bare is not None and not rest.startswith("-"):
        return _with_argument(bare, rest)
    return f"{verb} {f'has no option {shown(option)}' if option else 'needs an option'}; {usage_text([verb])}"


def _with_argument(row: DashboardCommand, argument: str) -> tuple[DashboardCommand, str] | str:
    given = argument if row.argument == "TEXT" else argument.strip()
    name = f"{row.verb} {row.option}".rstrip()
    if given.strip() and not row.argument:
        return f"{name} takes no argument, but {shown(given)} follows; {usage_text([row.verb])}"
    if not given.strip() and row.argument and not row.argument.startswith("["):
        return f"{name} needs {row.argument}; {usage_text([row.verb])}"
    return row, given
