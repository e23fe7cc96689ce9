"""The dashboard shell, port 29999: one command a line, one reply each, in order.

Clients take one read for a reply, so the greeting and every reply leave in one send each. A command whose result the
robot alone knows (loading, starting, variables, unlocking) is answered when the robot has. Others are answered at
once. In both cases the commands behind wait, and see the state that it has left.

Evidence: line ends, the three lines of the greeting and one reply a command are *documented* or seen in the vendor's
client; the limits, and that an empty line is not answered, are *assumed*.
"""

from __future__ import annotations

from collections import deque
from typing import Final

from elitescript.messages.inputs import Input
from elitescript.messages.outputs import Output
from elitescript.messages.snapshot import RobotDescription
from elitescript.messages.timing import TICKS_PER_S
from elitescript.protocol.connection import Connection, ProtocolError
from elitescript.protocol.dashboard.answers import Answer, Asked, version_text
from elitescript.protocol.dashboard.verbs import VERBS, DashboardCommand, unknown_text, usage_text
from elitescript.protocol.lines import PacedLines, TextLine, one_line, shown
from elitescript.protocol.outcomes import read_outcome

LINE_LIMIT: Final = 4096
"""Bytes of a command."""
LINES_PER_TICK: Final = 100
"""Commands of one client that are read in a tick; the rest waits for the next."""
WAITING_LIMIT: Final = 64
"""Commands that may wait for the one before them."""
SETTLING_TICKS: Final = 4
"""After a command that changes the robot and is answered at once, the next one waits so long: it sees the change."""
ANSWER_TICKS: Final = 1000
"""How long the robot may take to answer; the vendor's client waits 10 s for a reply."""


class DashboardConnection(Connection):
    """One client of the dashboard shell.

    Each command goes to the robot under an origin of its own, `dashboard#2/7` for the seventh line of `dashboard#2`:
    an answer that comes too late finds nobody, and is not taken for that of another command.
    """

    __slots__ = ("_asked_tick", "_awaited", "_count", "_inputs", "_lines", "_settled_tick", "_waiting")

    def __init__(self, origin: str, description: RobotDescription) -> None:
        super().__init__(origin, description)
        self._lines = PacedLines(LINE_LIMIT, LINES_PER_TICK)
        self._waiting: deque[TextLine] = deque()
        self._awaited: Answer | None = None
        self._asked_tick = 0
        self._settled_tick = 0
        self._inputs: list[Input] = []
        self._count = 0
        self._say(
            f"EliRobot dashboard shell, version {version_text(description)}.\r\n"
            "Type help to see all commands.\r\n"
            "Type help NAME to read about the command NAME."
        )

    def receive(self, data: bytes, output: Output) -> list[Input]:
        """See `Connection.receive`."""
        self._lines.feed(data)
        self._read(output)
        return self.due()

    def publish(self, output: Output) -> None:
        """See `Connection.publish`."""
        if self._awaited is not None:
            self._await(self._awaited, output)
        self._read(output)
        self._work(output)

    def _await(self, awaited: Answer, output: Output) -> None:
        own = self._own_origin
        text = next((reply.text for reply in output.replies if reply.origin == own), None)
        if text is not None:
            outcome = read_outcome(one_line(text))
            self._finish(awaited.text + outcome.detail if outcome.is_done else f"{awaited.failure}: {outcome.detail}")
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
        """See `Connection.read_on`."""
        self._lines.renew()
        self._read(output)
        return self.due()

    @property
    def is_busy(self) -> bool:
        """See `Connection.is_busy`."""
        return self._lines.is_waiting

    @property
    def is_expecting(self) -> bool:
        """See `Connection.is_expecting`."""
        return self._awaited is not None or bool(self._waiting) or self._lines.is_waiting

    def due(self) -> list[Input]:
        """See `Connection.due`."""
        inputs, self._inputs = self._inputs, []
        return inputs

    @property
    def _own_origin(self) -> str:
        return f"{self.origin}/{self._count}"

    def _say(self, text: str) -> None:
        self.send(text.encode() + b"\r\n")

    def _finish(self, text: str) -> None:
        self._awaited = None
        self._say(text)

    def _work(self, output: Output) -> None:
        while self._waiting and self._awaited is None and output.tick >= self._settled_tick:
            line = self._waiting.popleft()
            if line.problem:
                self._say(f"Command is not understood: {line.problem}")
            elif line.text.strip():
                self._count += 1
                self._carry_out(self._answer(line.text, output), output.tick)

    def _carry_out(self, answer: Answer, tick: int) -> None:
        self._inputs += answer.inputs
        if answer.failure:
            self._awaited, self._asked_tick = answer, tick
            return
        if answer.inputs:
            self._settled_tick = tick + SETTLING_TICKS
        self._say(answer.text)
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
    """Find the command that a line asks for, and its argument; or the text that says why there is none."""
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
