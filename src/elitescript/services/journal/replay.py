"""Robots with a journal: one that writes its session to it, and one that plays a session again."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

from elitescript.environment.request_channels import RequestEnvironment
from elitescript.errors import UsageError
from elitescript.kernel import Kernel, RobotOptions
from elitescript.kernel.restart import restored_options
from elitescript.messages.cut import WHOLE
from elitescript.messages.inputs import Input
from elitescript.messages.outputs import Output, TickResult
from elitescript.messages.snapshot import Snapshot
from elitescript.messages.snapshot_parts import ALL_PARTS
from elitescript.records import NamedTuple, replace
from elitescript.runtime.environment import Files
from elitescript.runtime.threads.meter import Meter, RepeatingMeter
from elitescript.services.child.remote_files import FileDesk, RemoteFiles
from elitescript.services.debugging import debugging
from elitescript.services.journal.records import RecordError, check_answer
from elitescript.services.journal.writer import Digest, Journal, JournalReader
from elitescript.services.output_text import output_text


class RecordedRobot(Kernel):
    """Runs a robot in this process whose session goes into a journal.

    Args:
        options: of the robot.
        files: its task folder; what was read from it goes into the journal too.
        journal: where to write.
        meter: ends its ticks; work alone counts if None.
    """

    __slots__ = ("_answers", "_desk", "_journal", "_snapshot")

    def __init__(self, options: RobotOptions, files: Files, journal: Journal, meter: Meter | None = None) -> None:
        self._journal = journal
        self._desk = FileDesk(files)
        self._answers: list[Any] = []
        self._snapshot: Snapshot
        super().__init__(options, RequestEnvironment(RemoteFiles(self._ask)), debugging=debugging(), meter=meter)

    def tick(self, inputs: Sequence[Input] = (), number: int | None = None) -> TickResult:
        """Run one tick; the digests of the journal cover every snapshot."""
        result = super().tick(inputs, number)
        self._snapshot = super().snapshot()
        self._journal.tick(result.tick, inputs, self._answers, result.with_snapshot(self._snapshot), self.cut)
        self._answers.clear()
        self._desk.new_tick()
        return result

    def due_tick(self) -> int:
        """Return the next tick: the digests cover every one."""
        return self.next_tick

    def snapshot(self, parts: int = ALL_PARTS) -> Snapshot:
        """Return the machine as its ports show it after the last tick; always the whole of it."""
        return self._snapshot

    def _ask(self, question: list[Any]) -> list[Any]:
        answer = self._desk.answer(question)
        self._answers.append(answer)
        return answer


class Difference(NamedTuple):
    """Where a replay and its journal differ."""

    tick: int
    text: str


class Replay:
    """Plays a journal again.

    Args:
        reader: the journal.
        until_tick: the last tick to play; all if None.

    Attributes:
        difference: where the replay differs from the journal; None while it does not.
        checked_ticks: ticks that came out the same.
        last_tick: the last one that was played; -1 before the first.
    """

    __slots__ = (
        "_answers",
        "_digest",
        "_kernel",
        "_last",
        "_meter",
        "_reader",
        "_text",
        "_until",
        "checked_ticks",
        "difference",
        "last_tick",
    )

    def __init__(self, reader: JournalReader, until_tick: int | None = None) -> None:
        self._reader = reader
        self._until = until_tick
        self._answers: list[Any] = []
        self._text = output_text if reader.old is None else reader.old.output_text
        self._digest = Digest()
        self._meter: RepeatingMeter | None = None
        self._kernel = self._fresh(reader.options)
        self._last: Output | None = None
        self.difference: Difference | None = None
        self.checked_ticks = 0
        self.last_tick = reader.options.first_tick - 1

    def outputs(self, on_restart: Callable[[int, str], None] | None = None) -> Iterator[Output]:
        """Return what clients got, tick by tick; ends early where it differs.

        Events that came while there was no robot have its last snapshot.

        Args:
            on_restart: called with the tick and the reason when a new robot goes on.

        Raises:
            UsageError: a line of the journal that makes no sense.
        """
        for record in self._reader.records():
            if "tick" in record:
                yield from self._run(record["tick"] - 1)
                self._answers = list(record.get("asked", ()))
                if self._meter is not None:
                    self._meter.expect(record.get("cut", WHOLE))
                yield from self._run(record["tick"], record["in"])
            elif "digest" in record:
                yield from self._run(record["digest"])
                self._compare(record)
            elif "told" in record:
                if self._until is not None and record["told"] > self._until:
                    return
                if self._last is not None:
                    tick, events = record["told"], tuple(record["events"])
                    yield replace(self._last, tick=tick, events=events, requests=(), replies=())
            elif "restart" in record:
                if self._until is not None and record["restart"] > self._until:
                    return
                if on_restart is not None:
                    on_restart(record["restart"], str(record["reason"]))
                options, description = self._reader.options, self._kernel.description
                self._kernel = self._fresh(restored_options(options, description, record["state"], record["restart"]))
            elif "end" in record:
                yield from self._run(record["end"] - 1)
            if self.difference is not None or (self._until is not None and self.last_tick >= self._until):
                return

    def _fresh(self, options: RobotOptions) -> Kernel:
        self._meter = RepeatingMeter() if self._reader.is_metered else None
        environment = RequestEnvironment(RemoteFiles(self._ask))
        try:
            return Kernel(options, environment, debugging=debugging(), meter=self._meter)
        except UsageError as error:
            raise UsageError(f"{self._reader.place}: {error}") from None

    def _ask(self, question: list[Any]) -> list[Any]:
        place = f"{self._reader.place}: tick {self._kernel.next_tick}"
        if not self._answers:
            raise UsageError(f"{place}: the journal has no answer to {question[0]!r} about files")
        answer = self._answers.pop(0)
        try:
            check_answer(question, answer)
        except RecordError as error:
            raise UsageError(f"{place}: {error}") from None
        return list(answer)

    def _run(self, last: int, inputs: Sequence[Input] = ()) -> Iterator[Output]:
        """Run up to and including a tick; the inputs are for that one."""
        if self._until is not None:
            last = min(last, self._until)
        while self._kernel.next_tick <= last:
            output = self._kernel.tick_and_snapshot(inputs if self._kernel.next_tick == last else ())
            self._digest.add(self._text(output).encode())
            self.last_tick, self._last = output.tick, output
            yield output

    def _compare(self, record: dict[str, Any]) -> None:
        if self.last_tick < record["digest"]:
            # Cut off by `until_tick`.
            return
        ours = self._digest.sums
        total, _ = self._digest.mark()
        sums = [record["ticks"][at : at + 8] for at in range(0, len(record["ticks"]), 8)]
        first = record["digest"] - len(sums) + 1
        for place, expected in enumerate(sums):
            if place >= len(ours) or ours[place] != expected:
                self.difference = Difference(first + place, "the robot did or said something else than in the session")
                return
        if total != record["hash"] or len(ours) != len(sums):
            self.difference = Difference(first, "the check sums agree, the hash does not")
            return
        self.checked_ticks += len(sums)
