"""One robot in one child process: the messages down, and those up, of which nothing is trusted.

What arrives is decoded, checked and handed on in the order of the ticks. What is no message ends the transport; nothing
more of the child is read then. See `frames` for the messages.
"""

from __future__ import annotations

import os
import sys
import time
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, Final, Protocol

from elitescript.codec.json_text import from_text, to_text
from elitescript.codec.messages import field_shapes, shape_of
from elitescript.codec.values import CodecError, check_list
from elitescript.errors import UsageError
from elitescript.kernel import RobotOptions
from elitescript.messages.cut import WHOLE, Cut
from elitescript.messages.enums import TaskState
from elitescript.messages.inputs import Compiled, Debug, Input, Interpret, LoadTask, PlayTask, Query, RunUnit
from elitescript.messages.outputs import Output, TickResult
from elitescript.messages.snapshot import RobotDescription
from elitescript.messages.snapshot_parts import ALL_PARTS, TIME
from elitescript.messages.state import RobotState
from elitescript.messages.timing import TICKS_PER_S
from elitescript.services.child import frames, output_changes
from elitescript.services.child.jail import Layer
from elitescript.services.child.output_changes import OutputReader
from elitescript.services.child.process import ChildProcess
from elitescript.services.child.remote_files import FileDesk
from elitescript.services.child.rows_ahead import RowsAhead
from elitescript.services.options_data import options_data

READING_MAX_S: Final = 0.25
READING_KEPT: Final = 0.99
"""Time that the outputs of the last hundred ticks or so may take to be read: more than half of it."""
NO_INPUTS: Final = to_text([])
READ_FREELY: Final = 4000
"""Bytes of an output that take so little time that it is not measured."""
RUNNING_TICKS: Final = 60 * TICKS_PER_S
"""How long secondary programs and queries may run that wait for each other, each for a second."""
_BEGINNING: Final = (RunUnit, Compiled, Interpret, LoadTask, PlayTask, Query, Debug)
"""Inputs with which something may begin to run."""


@dataclass(slots=True)
class SentTick:
    """A tick that has not been answered yet."""

    number: int
    inputs: Sequence[Input]
    parts: int
    """Those of its snapshot that are read, as bits."""
    text: str
    """The inputs as JSON text."""
    size: int = 0
    """Bytes of program text that came with it, or were read in it to load a task."""
    answers: list[Any] = field(default_factory=list)
    """To questions about files."""
    asking_since_s: float = 0.0
    """When the first question about files came in it."""
    cut: Cut = WHOLE
    """How far programs came in it."""
    ahead: int = 0
    """How many rows of the ticks after it are asked for, with the same parts."""


class Compilers(Protocol):
    """Has the texts of a child compiled, see `services.compiler.desk`."""

    def take_text(self, content: bytes) -> None:
        """Take a part of a text.

        Raises:
            CodecError: it is not what is expected.
        """

    def drop(self, content: bytes) -> None:
        """End what works on a text that is not wanted any more.

        Raises:
            CodecError: its number is missing.
        """


class ChildTransport:
    """The way to one child process, from its start to its end.

    Args:
        desk: answers questions about files.
        on_output: takes a tick that was sent, what it has given, and the next one that is due.
        on_question: called when a question about files was answered, with the tick that it was asked in; None if that
            was before the first one.
        on_change: called after each message, and when the child has ended.
        compilers: has texts compiled.
        is_jailed: lock the child in.
        memory_max: bytes of address space of the child.

    Attributes:
        description: of the robot, once there is one.
        end_reason: why nothing more comes; empty while the child lives.
        failure: the reason that the child itself has given for its end.
        is_begun: whether the child was asked to make a robot.
        layers: of the jail; None until the child has locked itself in.
        line: of the program, at the last tick that was answered.
        process: the process.
        unanswered: ticks that were sent and not answered yet, the oldest first.

    Raises:
        UsageError: no process can be started.
    """

    __slots__ = (
        "_compilers",
        "_desk",
        "_input_shape",
        "_is_running",
        "_line_shape",
        "_may_run_until",
        "_on_change",
        "_on_output",
        "_on_question",
        "_reader",
        "_reading_s",
        "_result_shape",
        "_rows",
        "description",
        "end_reason",
        "failure",
        "is_begun",
        "layers",
        "line",
        "process",
        "unanswered",
    )

    def __init__(
        self,
        desk: FileDesk,
        on_output: Callable[[SentTick, Output | TickResult, int], None],
        on_question: Callable[[SentTick | None], None],
        on_change: Callable[[], None],
        compilers: Compilers,
        *,
        is_jailed: bool,
        memory_max: int,
    ) -> None:
        self._desk = desk
        self._on_output = on_output
        self._on_question = on_question
        self._on_change = on_change
        self._compilers = compilers
        self._input_shape = shape_of(Input)
        self._line_shape = field_shapes(RobotState)["line"]
        self._result_shape = shape_of(TickResult)
        self._rows = RowsAhead()
        self._reader = OutputReader()
        self._reading_s = 0.0
        self._is_running = False
        """Whether a program ran at the end of the last tick whose snapshot is known."""
        self._may_run_until = -1
        """The last tick in which what was sent may run that is no program: queries, secondary programs."""
        self.description: RobotDescription | None = None
        self.end_reason = self.failure = ""
        self.is_begun = False
        self.layers: tuple[Layer, ...] | None = None
        self.line = 0
        self.unanswered: deque[SentTick] = deque()
        if os.name != "posix":
            # A descriptor cannot be handed to a child there.
            raise UsageError(f"robots have no process of their own on this system ({sys.platform}); use --in-process")
        try:
            self.process = ChildProcess(self._message, self.end)
        except (OSError, ValueError) as error:
            raise UsageError(f"no process for the robot can be started: {error}; use --in-process") from error
        self.process.send(frames.LOCK_IN, to_text([is_jailed, memory_max]))

    @property
    def is_ready(self) -> bool:
        """Whether the child can be asked to make a robot, or for a tick."""
        return self.layers is not None and not self.end_reason

    # ---------------------------------------------------------------- down

    def prepare(self, options: RobotOptions) -> None:
        """Have the child load what such a robot needs; it may be asked to make one at any time."""
        self.process.send(frames.PREPARE, to_text(options_data(options)))

    def serve_for(
        self,
        desk: FileDesk,
        on_output: Callable[[SentTick, Output | TickResult, int], None],
        on_question: Callable[[SentTick | None], None],
        on_change: Callable[[], None],
        compilers: Compilers,
    ) -> None:
        """Belong to another robot from now on: a child that has waited as a spare one."""
        self._desk, self._on_output, self._on_question, self._on_change = desk, on_output, on_question, on_change
        self._compilers = compilers

    @property
    def is_running(self) -> bool:
        """Whether a program ran at the end of the last tick whose snapshot is known."""
        return self._is_running

    def begin(self, options: RobotOptions) -> None:
        """Have the child make its robot."""
        self.is_begun = True
        self.process.send(frames.BEGIN, to_text(options_data(options)))

    def send_tick(
        self, number: int, inputs: Sequence[Input], parts: int, *, asks_due: bool, is_whole: bool, ahead: int = 0
    ) -> None:
        """Send a tick with its inputs, and ask for parts of its snapshot, the next tick that is due, and rows ahead.

        Args:
            number: of the tick.
            inputs: in order.
            parts: of its snapshot that are read, as bits; of those of the rows too.
            asks_due: whether the next tick that is due is to be found out.
            is_whole: whether its snapshot is to have all parts, whatever is read.
            ahead: how many rows of the ticks after it are asked for, `AHEAD_TICKS` at most.
        """
        self._rows.end_before(number)
        if inputs:
            text = to_text([self._input_shape.encode(item) for item in inputs])
            if any(isinstance(item, _BEGINNING) for item in inputs):
                self._may_run_until = number + RUNNING_TICKS
            size = sum(len(item.text) for item in inputs if isinstance(item, RunUnit | Interpret | Query))
            sent = SentTick(number, inputs, parts, text, size)
        else:
            text = ""
            sent = SentTick(number, inputs, parts, NO_INPUTS)
        sent.ahead = ahead
        self.unanswered.append(sent)
        content = frames.tick_content(number, ALL_PARTS if is_whole else parts, asks_due, text, ahead, parts)
        self.process.send(frames.TICK, content)

    def knows(self, number: int, parts: int) -> bool:
        """Return whether the child has given the output of a tick ahead, or will: it is not sent without inputs."""
        return self._rows.knows(number, parts) and not self.end_reason

    @property
    def gave_rows(self) -> bool:
        """Whether rows ahead followed the last answer."""
        return self._rows.count > 0

    def await_row(self, number: int, parts: int) -> None:
        """Take the row of a tick of `knows` as the tick's output: now, or when it comes."""
        sent = SentTick(number, (), parts, NO_INPUTS)
        output = self.take_row(number, parts)
        if output is None:
            self.unanswered.append(sent)
        else:
            self._on_output(sent, output, self._rows.due)

    def take_row(self, number: int, parts: int) -> Output | TickResult | None:
        """Return what a tick of `knows` gives, as if the child had been sent it; None if that has not come yet."""
        if self.unanswered:
            return None
        row = self._rows.take(number)
        if row is None:
            self.process.read()
            row = self._rows.take(number)
        return None if row is None else self._given(row, parts)

    def _given(self, row: Output, parts: int) -> Output | TickResult:
        """Return a row as the output of its tick, with what is read in it and no more."""
        self._desk.new_tick()
        if not parts:
            return TickResult(row.tick, (), (), ())
        return row if row.parts == parts | TIME else row.with_snapshot(row.snapshot, parts | TIME)

    def send_code(self, content: bytes) -> None:
        """Send a part of a program that was compiled."""
        self.process.send(frames.CODE, content)

    # ---------------------------------------------------------------- up

    def output_text(self) -> bytes:
        """Return the last output with a snapshot, whole, as JSON text."""
        return self._reader.text().encode()

    def end(self, reason: str) -> None:
        """Read nothing more of the child."""
        self.end_reason = self.end_reason or reason
        self._on_change()

    def _message(self, letter: str, text: bytes) -> None:
        if self.end_reason:
            return
        try:
            self._take(letter, text)
        except CodecError as error:
            self.end(f"what it says makes no sense: {error}")
        except Exception as error:
            # No message of a child may end this process, whatever we have not thought of.
            self.end(f"what it says makes no sense: {type(error).__name__}: {error}")
        self._on_change()

    def _take(self, letter: str, text: bytes) -> None:
        if letter in (frames.OUTPUT, frames.OUTPUT_CHANGES, frames.RESULT):
            self._take_output(letter, text)
        elif letter == frames.ROW:
            self._take_row(text)
        elif letter == frames.QUESTION:
            self._take_question(text)
        elif letter == frames.TEXT:
            self._compilers.take_text(text)
        elif letter == frames.DROP_TEXT:
            self._compilers.drop(text)
        elif letter == frames.LOCKED_IN and self.layers is None:
            output_changes.check_values(text)
            self.layers = tuple(Layer(str(name), active is True, str(why)) for name, active, why in from_text(text))
        elif letter == frames.DESCRIBED and self.is_begun and self.description is None:
            output_changes.check_values(text)
            self.description = shape_of(RobotDescription).decode(from_text(text))
        elif letter == frames.FAILED:
            output_changes.check_values(text)
            kind, why = (str(part)[: frames.FAILURE_MAX] for part in from_text(text))
            self.failure = why if kind == "usage" else f"a mistake of ours, please report it:\n{why}"
            self.end("it has ended")
        else:
            raise CodecError(f"a message {letter!r} that was not asked for")

    def _take_output(self, letter: str, text: bytes) -> None:
        if not self.unanswered:
            raise CodecError("an output that was not asked for")
        due, rows, cut, text = frames.read_answer(text)
        self._reading_s *= READING_KEPT
        output = self._measured(letter, text, self.unanswered[0].parts)
        sent = self.unanswered.popleft()
        self._desk.new_tick()
        if output.tick != sent.number:
            raise CodecError(f"the output of tick {output.tick} instead of {sent.number}")
        if isinstance(output, Output):
            self.line = output.snapshot.robot.line
        elif sent.parts:
            raise CodecError(f"the output of tick {output.tick} lacks the snapshot that was asked for")
        if cut != WHOLE:
            self._check_cut(sent)
            sent.cut = cut
        self._note_programs(output)
        if rows > sent.ahead:
            raise CodecError(f"{rows} rows after tick {sent.number}, and {sent.ahead} were asked for")
        self._rows.announce(sent.number, rows, sent.parts, due, is_newest=not self.unanswered)
        self._on_output(sent, output, due)

    def _take_row(self, text: bytes) -> None:
        row = self._measured(frames.OUTPUT_CHANGES, text, self._rows.parts)
        assert isinstance(row, Output)
        if self._rows.add(row) and self.unanswered and self.unanswered[0].number == row.tick:
            taken = self._rows.take(row.tick)
            assert taken is not None
            sent = self.unanswered.popleft()
            self._on_output(sent, self._given(taken, sent.parts), self._rows.due)

    def _measured(self, letter: str, text: bytes, parts: int) -> Output | TickResult:
        """Read an output.

        Raises:
            CodecError: it is none, or those of late have taken too long to be read.
        """
        if len(text) < READ_FREELY:
            return self._read_output(letter, text, parts)
        began_s = time.thread_time()
        output = self._read_output(letter, text, parts)
        self._reading_s += time.thread_time() - began_s
        if self._reading_s > READING_MAX_S:
            raise CodecError("it says so much that reading it takes the time of other clients")
        return output

    def _note_programs(self, output: Output | TickResult) -> None:
        if isinstance(output, Output):
            self._is_running = output.snapshot.robot.task_state is not TaskState.STOPPED

    def _check_cut(self, sent: SentTick) -> None:
        """Let the cut of a tick pass in which programs may run.

        Raises:
            CodecError: none does.
        """
        if not self._is_running and sent.number > self._may_run_until:
            raise CodecError(f"tick {sent.number} was cut, and no program runs")

    def _read_output(self, letter: str, text: bytes, parts: int) -> Output | TickResult:
        if letter == frames.RESULT:
            return self._read_result(text)
        return self._reader.read(letter, text, parts | TIME)

    def _read_result(self, text: bytes) -> TickResult:
        """Read what a tick gives without its snapshot."""
        output_changes.check_values(text)
        data = from_text(text)
        check_list(data, 2)
        line, result = data
        check_list(result, 4)
        output_changes.check_counts(result[1:])
        line = self._line_shape.decode(line)
        decoded = self._result_shape.decode(result)
        self.line = line
        return decoded

    def _take_question(self, text: bytes) -> None:
        answer = self._desk.answer(from_text(text))
        answer_text = to_text(answer)
        sent = self.unanswered[0] if self.unanswered else None
        if sent is not None:
            sent.answers.append(answer)
            if any(isinstance(item, LoadTask | PlayTask) for item in sent.inputs):
                sent.size += len(answer_text)
            sent.asking_since_s = sent.asking_since_s or time.monotonic()
        self._on_question(sent)
        self.process.send(frames.ANSWER, answer_text)
