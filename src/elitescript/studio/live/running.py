"""One run as a page sees it, in a worker process: the text is checked, then run, and told of while it runs.

Everything goes out every `FLUSH_S` of wall time: rows every `STEP_S` of robot time and at each change of line, lines of
the threads, moves, events, and how far the run has come. At its limit the run waits for `go_on`.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from hashlib import blake2b
from time import perf_counter
from typing import Any, Final

from elitescript.controller.controller import Controller
from elitescript.controller.views.trace import TraceSpan
from elitescript.conversation import describe
from elitescript.conversation.describe import Moment
from elitescript.conversation.limits import LONG_LINES, PLACES_MAX, EventBudget, MarkBudget
from elitescript.conversation.messages import RunOptions
from elitescript.conversation.rows import RowWriter
from elitescript.errors import ElitescriptError
from elitescript.language.compiler import CompiledUnit
from elitescript.language.diagnostics import Diagnostic
from elitescript.language.idle import holds_nothing
from elitescript.language.options import Options
from elitescript.lint.engine import compile_checked
from elitescript.messages.events import ChannelActivity, Event, LineMarked, MotionEnded, MotionStarted
from elitescript.messages.profile import DEFAULT_FIRMWARE, PROFILES
from elitescript.messages.timing import seconds, ticks_for
from elitescript.plotting.events import timed_moves
from elitescript.plotting.line_times import ThreadLines, line_times
from elitescript.plotting.moments import alarm_of, contacts_of, moment_now, moment_of_run, scene_of
from elitescript.plotting.sampling import Sampling
from elitescript.robot import VirtualRobot
from elitescript.run import Run
from elitescript.studio.live.code import digest_of, lines_of, moved_lines
from elitescript.studio.live.jobs import Job, PreparedJob, files_of, job_data, job_of
from elitescript.studio.live.link import Board, Link
from elitescript.untrusted.files import WORLD, read_bytes

STEP_S: Final = 0.04
"""Robot time from one row to the next."""
FLUSH_S: Final = 0.05
"""Wall time from one report to the next."""
FIRST_FLUSH_S: Final = 0.02
WALL_S: Final = 10.0
"""Most wall time of a run before it waits for `go_on`."""
WALL_IS_UP: Final = "the run is held after {wall:g} s of computing, at {t:.3f} s of robot time; it can go on"
NO_CONNECTIONS: Final = "live runs do not connect: let this run connect, or declare the other side in a world file"

_LINE_IN_WORDS: Final = re.compile(r"\bline \d")


def run_program(link: Link, request: Mapping[str, Any], jail: Callable[[], None]) -> None:
    """Check a text, and run it if it starts.

    Args:
        link: to the engine.
        request: `job`, `run`, `version`, `options` as the page is shown them, `until_s`, `wall_s`; `known`: digest and
            lines of the last complete run, or None.
        jail: called before the text is compiled.
    """
    version = request["version"]
    job = job_of(request["job"])
    source = job.source
    try:
        prepared = PreparedJob(job)
        robot = prepared.robot()
        contents = _contents(prepared)
    except ElitescriptError as error:
        jail()
        checked = compile_checked(source, PROFILES[DEFAULT_FIRMWARE], Options())
        link.send(describe.problems(version, checked.problems, compiles=not checked.is_refused))
        link.send(describe.notice("error", str(error)))
        return
    jail()
    link.send(scene_of(robot))
    if holds_nothing(source):
        # The begin of a text: nothing is wrong with it, and nothing runs.
        link.send(describe.problems(version, (), compiles=True, start=moment_now(robot)))
        return
    options = Options(strict=robot.options.strict, ignored=robot.options.ignored)

    def report_first(found: tuple[Diagnostic, ...]) -> None:
        if found:
            starts = not any(problem.keeps_from_starting for problem in found)
            link.send(describe.problems(version, found, compiles=starts))

    checked = compile_checked(
        source,
        robot.profile,
        options,
        presets=job.presets,
        arm=robot.model,
        report_first=report_first if len(source.lines) > LONG_LINES else None,
    )
    link.send(describe.problems(version, checked.problems, compiles=not checked.is_refused))
    if checked.unit is None or checked.is_refused:
        return
    if prepared.left_out and request["known"] is None:
        # Once, not with every edit.
        link.send(describe.notice("warning", prepared.left_out))
    if not _is_same(link, checked.unit, job, contents, request):
        RunReport(link, robot, checked.unit, request).run(job.presets)


def _contents(prepared: PreparedJob) -> dict[str, str] | None:
    """Return digests of all files that a run depends on; None if it depends on more than files."""
    job = prepared.job
    paths = files_of(job)
    if job.may_connect or any(path.suffix == ".py" for path in paths):
        return None
    read = {str(path): read_bytes(path, WORLD) for path in paths}
    return {name: blake2b(data, digest_size=16).hexdigest() for name, data in {**prepared.files, **read}.items()}


def _is_same(
    link: Link, unit: CompiledUnit, job: Job, contents: dict[str, str] | None, request: Mapping[str, Any]
) -> bool:
    """Tell the engine what the program is known by; return whether its run is that of the last complete one."""
    if contents is None:
        return False
    settings = {name: value for name, value in job_data(job).items() if name not in ("text", "name")}
    digest, lines = digest_of(unit, (settings, contents, request["until_s"])), lines_of(unit)
    known = request["known"]
    moved = moved_lines(known["lines"], lines) if known is not None and known["digest"] == digest else None
    link.send({"type": "code", "digest": digest, "lines": lines})
    if moved is None:
        return False
    link.send({"type": "same", "moved": list(moved.items())})
    return True


class CoarseRows(Sampling):
    """Takes a row every `STEP_S`, and one at each change of line; keeps them and has them written.

    Args:
        writer: receives them.
        board: gets the last tick before the one that is due next.
    """

    __slots__ = ("_board", "_writer")

    def __init__(self, writer: RowWriter, board: Board | None = None) -> None:
        super().__init__(step_s=STEP_S)
        self._writer = writer
        self._board = board

    def record(self, controller: Controller, until_tick: int) -> None:
        """See `Sampling.record`."""
        super().record(controller, until_tick)
        if self._board is not None:
            self._board.write(until_tick - 1)

    def take_now(self, controller: Controller) -> None:
        """Take a row of the present tick."""
        if not self.rows.times or self.rows.times[-1] < seconds(controller.tick):
            self._next_tick = controller.tick
            self.record(controller, controller.tick + 1)

    def _take(self, span: TraceSpan) -> None:
        self._writer.add(span)
        super()._take(span)


class RunReport:
    """Runs a program, and reports it.

    Args:
        link: to the engine.
        robot: a new one.
        unit: the program.
        request: see `run_program`.
    """

    def __init__(self, link: Link, robot: VirtualRobot, unit: CompiledUnit, request: Mapping[str, Any]) -> None:
        self._link = link
        self._robot = robot
        self._unit = unit
        self._number: int = request["run"]
        self._version: int = request["version"]
        self._options: Mapping[str, Any] = request["options"]
        self._wall_s: float = request["wall_s"]
        self._until_tick = ticks_for(request["until_s"])
        self._writer = RowWriter(self._number)
        self._rows = CoarseRows(self._writer, link.board)
        self._lines = ThreadLines()
        self._seen = 0
        self._budget = EventBudget()
        self._marks = MarkBudget()
        self._left_out = 0, 0
        """Events and bytes that the page knows to be left out."""
        self._open: MotionStarted | None = None
        self._refused: dict[str, None] = {}
        """Places to which the program has tried to connect in vain."""
        now_s = perf_counter()
        self._wall_end_s = now_s + self._wall_s
        self._flush_at_s = now_s + FIRST_FLUSH_S
        robot.next_stop = lambda tick: self._until_tick if tick < self._until_tick else None

    def run(self, presets: Mapping[str, Any]) -> None:
        """Run to the end."""
        link, robot = self._link, self._robot
        chosen = robot.options
        in_force = {"robot": robot.model.name, "firmware": chosen.firmware, "seed": chosen.seed}
        began = describe.run_began(self._number, self._version, RunOptions())
        link.send(began | {"options": dict(self._options) | in_force})
        link.send({"type": "at", "moment": describe.moment(moment_now(robot))})
        try:
            run = robot.run(self._unit, presets=presets, trace=self._rows, watch=self._watch)
        except ElitescriptError as error:
            # A device beside the robot has failed.
            link.send(describe.notice("error", str(error)))
            found = robot.current
            if found is None:
                return
            run = found
        self._flush(run)
        link.send(describe.cycle(self._number, line_times(self._rows.rows)))
        self._end(run, run.state or "stopped", moment_of_run(run))

    def _watch(self, robot: VirtualRobot) -> None:
        strands = robot.host.scheduler.strands
        self._lines.record(robot.time_s, [(strand.name, strand.line) for strand in strands])
        now_s = perf_counter()
        run = robot.current
        if run is None or run.state:
            return
        if robot.tick >= self._until_tick or now_s >= self._wall_end_s:
            self._hold(run, is_wall=robot.tick < self._until_tick)
        elif now_s >= self._flush_at_s:
            self._flush(run)
            self._flush_at_s = perf_counter() + FLUSH_S

    def _hold(self, run: Run, *, is_wall: bool) -> None:
        """Show a run that has reached its limit as one that has ended, until it is to go on."""
        robot, link = self._robot, self._link
        self._rows.take_now(robot.controller)
        self._flush(run)
        found = moment_now(robot)
        if is_wall:
            link.send(describe.notice("information", WALL_IS_UP.format(wall=self._wall_s, t=found.t)))
        link.send(describe.cycle(self._number, line_times(self._rows.rows)))
        self._end(run, "time_limit", found)
        request = link.receive()
        self._until_tick = max(robot.tick + 1, ticks_for(request["until_s"]))
        now_s = perf_counter()
        self._wall_end_s, self._flush_at_s = now_s + self._wall_s, now_s + FLUSH_S

    def _flush(self, run: Run) -> None:
        """Send what is new."""
        link, number = self._link, self._number
        for frame in self._writer.take():
            link.send_rows(frame)
        for name, entries in self._lines.news().items():
            link.send(describe.lines(number, name, entries))
        events = run.events
        self._budget.miss(max(0, run.events_dropped - self._seen))
        happened = events[max(0, self._seen - run.events_dropped) :]
        self._seen = run.events_dropped + len(events)
        if (moves := list(self._moves(happened))) != []:
            link.send(describe.moves(number, moves))
        if marks := self._marks.take((event.tick, event.number) for event in happened if isinstance(event, LineMarked)):
            link.send(describe.marks(number, marks))
        for event in happened:
            if isinstance(event, ChannelActivity) and event.what == "refused" and len(self._refused) < PLACES_MAX:
                self._refused[f"{event.channel}: {event.data}" if event.data else event.channel] = None
        self._send_events(describe.events(number, happened, self._budget))
        link.send({"type": "at", "moment": describe.moment(moment_now(self._robot))})
        link.send(describe.progress(number, self._robot.time_s))

    def _moves(self, happened: list[Event]) -> Iterator[tuple[float, float, str, int]]:
        """Yield the moves that have ended."""
        motions: list[Event] = [self._open] if self._open is not None else []
        motions += [event for event in happened if isinstance(event, MotionStarted | MotionEnded)]
        last = motions[-1] if motions else None
        self._open = last if isinstance(last, MotionStarted) else None
        # The last one, if it is under way, ends later than at 0 s, so it is left out.
        return timed_moves(motions, 0.0)

    def _send_events(self, message: describe.Message) -> None:
        """Send events, and what is left out of them."""
        if message["list"]:
            self._link.send(message)
        known = self._budget.events, self._budget.bytes
        if known != self._left_out:
            self._left_out = known
            self._link.send(describe.left_out(self._number, self._budget))

    def _end(self, run: Run, state: str, last: Moment) -> None:
        self._send_events({"type": "events", "run": self._number, "list": self._budget.last()})
        if self._open is not None and state != "time_limit":
            self._link.send(describe.moves(self._number, timed_moves([self._open], last.t)))
        if (found := contacts_of(run)) is not None:
            self._link.send(describe.contacts(self._number, found))
        alarm = alarm_of(self._robot, run)
        ended = describe.run_ended(
            self._number,
            state,
            last,
            alarm=alarm,
            refused_connections=[*self._refused],
            findings=run.findings if run.has_findings else (),
        )
        is_repeatable = state != "time_limit" and not any(map(_names_a_line, run.events))
        self._link.send(ended | {"is_repeatable": is_repeatable})


def _names_a_line(event: Event) -> bool:
    """Return whether the text of an event names a line, which a change of comments moves."""
    return _LINE_IN_WORDS.search(getattr(event, "text", "")) is not None
