"""Answers to the ticks that a child is sent: what each gives, and rows of the ticks after it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from elitescript.codec.json_text import from_text, to_text
from elitescript.codec.messages import shape_of
from elitescript.codec.values import with_parts
from elitescript.kernel import Kernel
from elitescript.messages.inputs import Input
from elitescript.messages.outputs import TickResult
from elitescript.messages.snapshot_parts import ALL_PARTS
from elitescript.services.child import frames
from elitescript.services.child.output_changes import OutputWriter
from elitescript.services.output_text import without_points


class TickAnswers:
    """Runs the ticks of one robot, and writes what they give.

    Args:
        kernel: the robot.
    """

    __slots__ = ("_input_shape", "_is_whole", "_kernel", "_result_shape", "_shown", "_whole_tick", "_writer")

    def __init__(self, kernel: Kernel) -> None:
        self._kernel: Final = kernel
        self._input_shape = shape_of(Input)
        self._result_shape = shape_of(TickResult)
        self._writer = OutputWriter()
        self._shown: tuple[object, ...] = ()
        """Discrete state of the last snapshot that was sent."""
        self._whole_tick, self._is_whole = 0, False
        """Tick of the last one with all parts, and whether the arm has rested since."""

    def answers(self, content: bytes) -> Iterator[bytes]:
        """Run the tick of a message `TICK`; yield the frame of its answer, then those of its rows in one piece.

        Args:
            content: of the message.

        Raises:
            CodecError: an input is none.
        """
        kernel = self._kernel
        tick, parts, asks_due, ahead, ahead_parts, text = frames.read_tick(content)
        result = kernel.tick([self._input_shape.decode(item) for item in from_text(text)] if text else (), tick)
        letter, given = self._given(result, parts)
        due = kernel.due_tick() if asks_due or ahead else tick + 1
        if due is None:
            due = frames.NEVER
        rows = kernel.ticks_ahead(due, ahead) if ahead else range(0)
        if not self._is_whole:
            due = min(due, max(self._whole_tick + frames.REFRESH_TICKS, tick + 1))
        yield frames.frame(letter, frames.answer_content(due, given, kernel.cut, len(rows)), frames.UP_MAX)
        if rows:
            changes = self._writer.changes
            shown = kernel.rows(rows, ahead_parts)
            yield b"".join([frames.frame(frames.ROW, changes(row), frames.UP_MAX) for row in shown])

    def _given(self, result: TickResult, parts: int) -> tuple[str, str | bytes]:
        """Return letter and content for what the tick that has run has given."""
        kernel = self._kernel
        state, rests = kernel.discrete_state(), kernel.controller.is_resting
        if parts == ALL_PARTS:
            self._whole_tick, self._is_whole = result.tick, rests
        elif not rests:
            self._is_whole = False
        if not parts and state == self._shown:
            written = with_parts(self._result_shape.encode(without_points(result)))
            return frames.RESULT, to_text([kernel.line, written])
        self._shown = state
        return self._writer.message(result.with_snapshot(kernel.snapshot(parts)))
