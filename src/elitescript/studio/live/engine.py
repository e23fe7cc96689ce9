"""`LiveEngine`: checks and runs each text of an editor in a worker process, and shows any moment of the last run.

All calls return at once; what comes of them is sent to the page. The newest text wins: the run of an older one ends
when a newer one arrives. A run is a function of its text and options, so moments and details are made by runs of their
own.
"""

from __future__ import annotations

import asyncio
import signal
from collections.abc import Awaitable, Callable, Coroutine, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, Final

from elitescript.conversation import describe
from elitescript.conversation.describe import Message
from elitescript.conversation.messages import (
    UNTIL_S_DEFAULT,
    UNTIL_S_MAX,
    Detail,
    GoOn,
    Program,
    Record,
    RunOptions,
    Seek,
    Step,
    options_data,
)
from elitescript.conversation.trees import with_task
from elitescript.environment.task_files import OpenedTask
from elitescript.errors import UsageError
from elitescript.messages.signals import Value
from elitescript.messages.timing import seconds
from elitescript.models.datafile import check_name
from elitescript.models.model import is_model_file
from elitescript.records import field, record, replace
from elitescript.studio.live.jobs import Job, job_data
from elitescript.studio.live.link import ROWS, message_of
from elitescript.studio.live.processes import Keeper, Spares, Worker, start_workers
from elitescript.studio.live.running import WALL_S

QUIET_S: Final = 0.7
"""Wall time without a report after which a run that computes does not return, s."""
QUIET_IDLE_S: Final = 5.0
"""The same of a run that does not compute: a busy computer has given it no time."""
COMPUTING: Final = 0.85
"""Share of the time without a report that a run has computed which does not return."""
BEGIN_S: Final = 20.0
"""Wall time within which a new worker says something, s."""
LOOK_S: Final = 15.0
"""Most wall time of a moment or of a part of a detail, s."""
STEPS_MAX: Final = 20
"""Steps that wait; moments by time do not: the newest counts."""

DOES_NOT_RETURN: Final = "line {line} does not return: the run was ended after {quiet:g} s in which no time went by"
HAS_ENDED: Final = "the process of the run has ended ({how}); the next text is run again"
CHECK_HAS_ENDED: Final = "the process that checks the text has ended ({how}); the next text is checked again"
KEEPER_AGAIN: Final = "the process that starts runs had ended and was started again"
NO_PROCESS: Final = "no process can be started: {why}"
NO_RUN: Final = "this run is not shown any more"
NEWER: Final = "a newer moment is asked for"
NO_REPETITION: Final = "a run with real connections cannot be repeated: its moments and details are not known"
TAKES_TOO_LONG: Final = "this moment is not found within {limit:g} s"

Send = Callable[[Message], Awaitable[None]]
SendRows = Callable[[bytes], Awaitable[None]]


@record
class Setting:
    """What the command line says of the robot.

    Attributes:
        robot: options of the robot by their names.
        world: world file; it may name Python files.
        levels: signals before a program begins.
        presets: program globals that have a value before it begins.
    """

    robot: Mapping[str, Any] = field(default_factory=dict)
    world: Path | None = None
    levels: Mapping[str, Value] = field(default_factory=dict)
    presets: Mapping[str, Any] = field(default_factory=dict)


class _Shown:
    """The run that the page shows."""

    def __init__(self, number: int, job: Job, until_s: float, task: OpenedTask | None = None) -> None:
        self.task = task
        """Of which its text is the script."""
        self.number = number
        self.job = job
        self.until_s = until_s
        self.last: Message | None = None
        """The last moment that is known, as a message holds it."""
        self.is_over = False
        self.is_held = False
        """Whether it waits at its limit."""

    @property
    def t(self) -> float:
        """How far it has come, s."""
        return 0.0 if self.last is None else float(self.last["t"])


class _Kept:
    """What was sent of the last run that is complete, to be sent again for a text that differs in its lines alone."""

    def __init__(self, digest: str, lines: list[int]) -> None:
        self.digest = digest
        self.lines = lines
        self.messages: list[Message] = []
        self.is_complete = False


class LiveEngine:
    """Runs programs for one page.

    Args:
        send: takes the messages to the page, one after the other; a run is held back while it waits.
        send_rows: takes binary frames, likewise.
        setting: what the command line says.

    Attributes:
        name: name of the text, as messages about it have it.
        folder: the opened folder, of which programs get a copy as their task folder; None for none.
        task: the graphical program of which texts are the script; None for others.
    """

    def __init__(self, send: Send, send_rows: SendRows, setting: Setting | None = None) -> None:
        self._send = send
        self._send_rows = send_rows
        self._setting = setting or Setting()
        self.name = "program.script"
        self.folder: Path | None = None
        self.task: OpenedTask | None = None
        self._starting: asyncio.Task[Keeper | Spares] | None = None
        self._number = 0
        self._options = RunOptions()
        """Of the newest text."""
        self._worker: Worker | None = None
        """Of the newest text."""
        self._task: asyncio.Task[None] | None = None
        self._shown: _Shown | None = None
        self._kept: _Kept | None = None
        self._scene: Message | None = None
        self._looker: Worker | None = None
        self._looked_at: tuple[int, float] = (0, 0.0)
        """Run and limit of the looker."""
        self._asked: list[Seek | Step] = []
        self._unanswered: dict[int, None] = {}
        """Numbers of what was asked of the shown run, the oldest first."""
        self._looking: asyncio.Task[None] | None = None
        self._details: set[asyncio.Task[None]] = set()
        self._one_detail = asyncio.Lock()

    # ---------------------------------------------------------------- life

    async def start(self) -> None:
        """Start the process that starts runs, ahead of the first text."""
        await self._workers()

    async def close(self) -> None:
        """End all processes."""
        await self._end_looking()
        await self._end_run()
        if self._starting is not None:
            with suppress(OSError):
                await (await self._starting).close()
            self._starting = None

    def forget(self) -> None:
        """Send everything from its begin again from now on: a new page has nothing yet."""
        self._kept = None
        self._scene = None

    async def _workers(self) -> Keeper | Spares:
        """Return what starts workers; a new one in place of one that has ended.

        Raises:
            OSError: it cannot be started.
        """
        while True:
            if self._starting is None:
                self._starting = asyncio.get_running_loop().create_task(start_workers())
            starting = self._starting
            try:
                workers = await asyncio.shield(starting)
            except OSError:
                self._forget_start(starting)
                raise
            if workers.is_alive:
                return workers
            if self._forget_start(starting):
                await workers.close()
                await self._send(describe.notice("warning", KEEPER_AGAIN))

    def _forget_start(self, starting: asyncio.Task[Keeper | Spares]) -> bool:
        """Let the next worker be started by a new keeper; return whether that is still to be done."""
        is_present = self._starting is starting
        if is_present:
            self._starting = None
        return is_present

    @property
    def _has_lost_workers(self) -> bool:
        """Whether what starts workers has ended by itself."""
        starting = self._starting
        return starting is not None and starting.done() and not (starting.exception() or starting.result().is_alive)

    async def _begin(self, request: dict[str, Any]) -> Worker:
        """Return a worker that carries out a request.

        Raises:
            UsageError: this computer starts no process.
        """
        try:
            try:
                worker: Worker = await (await self._workers()).begin()
            except OSError:
                # The keeper has ended just now.
                await asyncio.sleep(0)
                worker = await (await self._workers()).begin()
        except OSError as error:
            raise UsageError(NO_PROCESS.format(why=error.strerror or error)) from None
        worker.ask(request)
        return worker

    # ---------------------------------------------------------------- texts

    async def program(self, asked: Program) -> None:
        """Check a text, and run it if it compiles; what was computed for an older one ends."""
        await self._end_run()
        self._options = asked.options
        task = self._task_of(asked.text)
        # What keeps a task from running is known; the worker then shows the robot alone.
        text = "" if task is not None and task.errors else asked.text
        try:
            job = self._job(text, asked.options)
        except UsageError as error:
            await self._send(describe.notice("error", str(error)))
            job = self._job(text, RunOptions())
        self._number += 1
        until_s = asked.options.until_s or UNTIL_S_DEFAULT
        known = self._kept if self._kept is not None and self._kept.is_complete else None
        request = {
            "do": "run",
            "job": job_data(job),
            "run": self._number,
            "version": asked.version,
            "options": self._in_force(asked.options) | {"until_s": until_s},
            "until_s": until_s,
            "wall_s": UNTIL_S_MAX if job.may_connect else WALL_S,
            "known": None if known is None else {"digest": known.digest, "lines": known.lines},
        }
        new = _Shown(self._number, job, until_s, task)
        self._task = asyncio.get_running_loop().create_task(self._follow(request, new))

    def _task_of(self, text: str) -> OpenedTask | None:
        """Return the graphical program of which a text is the script, or that a text shows; None if it is none."""
        return self.task if self.task is not None and self.task.source.text == text else None

    def _job(self, text: str, options: RunOptions) -> Job:
        """Return a text with what determines its run.

        Raises:
            UsageError: a file outside of the opened folder.
        """
        setting = self._setting
        robot = dict(setting.robot)
        given = {"model": options.robot, "firmware": options.firmware, "joints": options.joints, "seed": options.seed}
        robot |= {name: value for name, value in given.items() if value is not None}
        if options.robot is not None:
            check_name(options.robot)
        if options.robot is not None and is_model_file(options.robot):
            robot["model"] = str(self._inside("robot", options.robot))
        world, is_trusted = setting.world, True
        if options.world is not None and options.world != self._world_name:
            world, is_trusted = (self._inside("world", options.world) if options.world else None), False
        return Job(
            self.name,
            text,
            "" if self.folder is None else str(self.folder),
            robot,
            "" if world is None else str(world),
            is_trusted and world is not None,
            bool(options.may_connect),
            setting.levels,
            setting.presets,
            options.inputs or (),
            **_of_task(self._task_of(text)),
        )

    @property
    def _world_name(self) -> str:
        """The world file of the command line, as the page has it."""
        return "" if self._setting.world is None else str(self._setting.world)

    def _in_force(self, options: RunOptions) -> dict[str, Any]:
        return options_data(options) | {"world": self._world_name if options.world is None else options.world}

    def _inside(self, what: str, name: str) -> Path:
        if self.folder is None:
            raise UsageError(f"{what}: no folder is open, so {name} cannot be read")
        folder = self.folder.resolve()
        path = (folder / name).resolve()
        if not path.is_relative_to(folder):
            raise UsageError(f"{what}: {name} is outside of the opened folder")
        return path

    async def _end_run(self) -> None:
        """End what is computed for the newest text."""
        task, self._task = self._task, None
        worker, self._worker = self._worker, None
        if worker is not None:
            worker.kill()
        if task is not None:
            task.cancel()
            with suppress(asyncio.CancelledError):
                await task
        if self._shown is not None:
            # One at its limit has been shown as ended.
            self._shown.is_over = self._shown.is_over or self._shown.is_held
            self._shown.is_held = False

    async def _say_stopped(self) -> None:
        """Say of the shown run that it has ended, if it was ended before it came to its end."""
        shown = self._shown
        if shown is not None and not shown.is_over and shown.last is not None:
            shown.is_over = True
            await self._send(_ended(shown, "stopped"))

    async def _follow(self, request: dict[str, Any], new: _Shown, stands_in: tuple[int, str] | None = None) -> None:
        """Pass on what a worker reports of a text.

        Args:
            request: for the worker.
            new: the run, if it begins.
            stands_in: line and text of a run that did not return, which this one is up to there; None if it is none.
        """
        has_begun = False
        worker: Worker | None = None
        compiled: _Kept | None = None
        try:
            worker = self._worker = await self._begin(request)
            wait_s = BEGIN_S
            while True:
                try:
                    frame = await self._frame(worker, wait_s, new)
                except EOFError:
                    break
                if frame is None:
                    await self._does_not_return(worker, request, new, has_begun=has_begun, stands_in=stands_in)
                    return
                kind, data = frame
                wait_s = QUIET_S if has_begun else BEGIN_S
                if kind == ROWS:
                    await self._send_rows(data)
                    continue
                try:
                    message: Message = message_of(data)
                except EOFError:
                    worker.kill()
                    break
                what = message["type"]
                if stands_in is not None and what == "problems":
                    continue
                if stands_in is not None and what == "run_ended":
                    new.last, new.is_over = message["moment"] | {"line": stands_in[0]}, True
                    await self._send(_ended(new, "killed", stands_in[1]))
                    return
                if what == "problems":
                    message = with_task(message, new.task)
                    await self._send(message)
                    if not message["compiles"]:
                        await self._say_stopped()
                elif what == "scene":
                    if message != self._scene:
                        self._scene = message
                        await self._send(message)
                elif what == "code":
                    compiled = _Kept(message["digest"], message["lines"])
                elif what == "same":
                    if compiled is None or self._kept is None:
                        worker.kill()
                        break
                    await self._repeat(new, request["version"], compiled, dict(message["moved"]))
                elif what == "at":
                    new.last = message["moment"]
                else:
                    has_begun = has_begun or what == "run_began"
                    await self._pass_on(message, new, compiled)
            if not (has_begun or new.is_over) and self._has_lost_workers:
                # The text came just as the keeper ended.
                await self._follow(request, new, stands_in)
            elif not new.is_over:
                await self._ended_by_itself(worker, new, has_begun=has_begun)
        except UsageError as error:
            await self._send(describe.notice("error", str(error)))
        finally:
            if worker is not None:
                worker.kill()

    async def _frame(self, worker: Worker, wait_s: float, new: _Shown) -> tuple[int, bytes] | None:
        """Return the next frame of a worker; None if it computes, and nothing comes.

        Raises:
            EOFError: there is none any more.
        """
        task = asyncio.ensure_future(worker.frame())
        try:
            since, cpu_s, quiet_max_s = asyncio.get_running_loop().time(), worker.processor_time_s(), wait_s
            while not (await asyncio.wait({task}, timeout=None if new.is_held else wait_s))[0]:
                quiet_s = asyncio.get_running_loop().time() - since
                now_s = worker.processor_time_s()
                is_computing = cpu_s is None or now_s is None or now_s - cpu_s > COMPUTING * quiet_max_s
                if not new.is_held and (is_computing or quiet_s > max(QUIET_IDLE_S, quiet_max_s)):
                    return None
                wait_s = min(wait_s, 0.1)
            return task.result()
        finally:
            task.cancel()
            with suppress(asyncio.CancelledError, EOFError):
                await task

    async def _pass_on(self, message: Message, new: _Shown, compiled: _Kept | None) -> None:
        what = message["type"]
        if what == "run_began":
            await self._show(new)
            self._kept = compiled
        elif what == "run_ended":
            is_repeatable = message.pop("is_repeatable")
            new.last = message["moment"]
            new.is_held = message["state"] == "time_limit"
            new.is_over = not new.is_held
            if compiled is not None and self._kept is compiled:
                if is_repeatable:
                    compiled.is_complete = True
                else:
                    self._kept = None
        if what in _REPEATED and compiled is not None and self._kept is compiled:
            compiled.messages.append(message)
        await self._send_of_run(message)

    async def _send_of_run(self, message: Message) -> None:
        await self._send(message)
        if message["type"] == "run_began":
            # What was asked of the run before is not looked for any more, and the page waits for each answer.
            for ask in list(self._unanswered):
                await self._answer(describe.refused(NO_RUN, ask))

    async def _show(self, new: _Shown) -> None:
        await self._end_looking()
        self._shown = new

    async def _repeat(self, new: _Shown, version: int, compiled: _Kept, moved: dict[int, int]) -> None:
        """Send what is known of the run of the same code again, with the lines of the new text."""
        before = self._kept
        assert before is not None
        compiled.messages = [_moved(message, new.number, moved) for message in before.messages]
        compiled.is_complete = True
        new.last, new.is_over = compiled.messages[-1]["moment"], True
        compiled.messages[0] |= {"version": version, "same_until_s": new.t}
        await self._show(new)
        self._kept = compiled
        for message in compiled.messages:
            await self._send_of_run(message)

    async def _does_not_return(
        self,
        worker: Worker,
        request: dict[str, Any],
        new: _Shown,
        *,
        has_begun: bool,
        stands_in: tuple[int, str] | None,
    ) -> None:
        """End a run that does not return, and show it up to the tick before."""
        line, tick = await worker.line(), worker.tick()
        worker.kill()
        if not has_begun or new.last is None:
            await self._send(describe.notice("error", CHECK_HAS_ENDED.format(how="it took too long")))
            return
        place = line or new.last["line"]
        text = DOES_NOT_RETURN.format(line=place, quiet=QUIET_S)
        if seconds(tick) > new.t and stands_in is None:
            # What it had not reported yet is gone with it. The same run up to there does not come to that line.
            self._number += 1
            again = request | {"run": self._number, "until_s": seconds(tick), "known": None}
            await self._follow(again, _Shown(self._number, new.job, new.until_s, new.task), (place, text))
            return
        new.is_over, new.last = True, new.last | {"line": place}
        await self._send(_ended(new, "killed", text))

    async def _ended_by_itself(self, worker: Worker, new: _Shown, *, has_begun: bool) -> None:
        """Say that a process has ended in the middle of its work, if it has."""
        try:
            code = await asyncio.wait_for(asyncio.shield(worker.ended), 1.0)
        except TimeoutError:
            code = 1
        how = _how(code)
        if has_begun:
            new.is_over = True
            await self._send(_ended(new, "killed", HAS_ENDED.format(how=how)))
        elif code != 0:
            await self._send(describe.notice("error", CHECK_HAS_ENDED.format(how=how)))

    async def go_on(self, asked: GoOn) -> None:
        """Let the run go on that waits at its limit."""
        shown = self._shown
        if shown is None or shown.number != asked.run or not shown.is_held or self._worker is None:
            await self._send(describe.refused(NO_RUN))
            return
        shown.is_held, shown.until_s = False, asked.until_s
        self._worker.ask({"do": "go_on", "until_s": asked.until_s})

    async def stop(self) -> None:
        """End what is computed."""
        await self._end_run()
        await self._say_stopped()

    # ---------------------------------------------------------------- moments

    async def seek(self, asked: Seek) -> None:
        """Send the state at a time; of those that wait the newest counts, and the others are refused."""
        if await self._may_look(asked):
            older = [other for other in self._asked if isinstance(other, Seek)]
            self._asked = [other for other in self._asked if isinstance(other, Step)]
            self._ask(asked)
            for other in older:
                await self._answer(describe.refused(NEWER, other.ask))

    async def step(self, asked: Step) -> None:
        """Send the state at the next or previous beginning of a statement of a thread."""
        if not await self._may_look(asked):
            return
        if len(self._asked) < STEPS_MAX:
            self._ask(asked)
        else:
            await self._answer(describe.refused(f"{STEPS_MAX} steps wait", asked.ask))

    async def _may_look(self, asked: Seek | Step | Detail) -> bool:
        shown = self._shown
        text = ""
        if shown is None or shown.number != asked.run:
            text = NO_RUN
        elif shown.job.may_connect:
            text = NO_REPETITION
        if text:
            await self._send(describe.refused(text, asked.ask))
        else:
            self._unanswered[asked.ask] = None
        return not text

    async def _answer(self, message: Message) -> None:
        await self._send(message)
        self._unanswered.pop(message["ask"], None)

    def _ask(self, asked: Seek | Step) -> None:
        self._asked.append(asked)
        if self._looking is None or self._looking.done():
            self._looking = asyncio.get_running_loop().create_task(self._look())

    async def _look(self) -> None:
        """Answer what is asked for, one after the other."""
        while self._asked and (shown := self._shown) is not None:
            asked = self._asked.pop(0)
            try:
                looker = await self._looker_of(shown)
            except UsageError as error:
                await self._answer(describe.refused(str(error), asked.ask))
                continue
            looker.ask(_look_request(asked, shown.t))
            try:
                _, data = await asyncio.wait_for(looker.frame(), LOOK_S)
                message = message_of(data)
            except TimeoutError:
                text = TAKES_TOO_LONG.format(limit=LOOK_S)
            except EOFError:
                text = HAS_ENDED.format(how="while it looked for a moment")
            else:
                await self._answer(message)
                continue
            self._looker = None
            looker.kill()
            await self._answer(describe.refused(text, asked.ask))

    async def _looker_of(self, shown: _Shown) -> Worker:
        if self._looker is not None and self._looked_at == (shown.number, shown.until_s):
            return self._looker
        if self._looker is not None:
            self._looker.kill()
            self._looker = None
        request = {"do": "look", "job": job_data(shown.job), "run": shown.number, "until_s": shown.until_s}
        self._looker = await self._begin(request)
        self._looked_at = shown.number, shown.until_s
        return self._looker

    async def _end_looking(self) -> None:
        """End what is looked for in the run that is shown."""
        self._asked.clear()
        tasks = [*self._details, *([self._looking] if self._looking is not None else [])]
        self._looking = None
        for task in tasks:
            task.cancel()
        for task in tasks:
            with suppress(asyncio.CancelledError):
                await task
        if self._looker is not None:
            self._looker.kill()
            self._looker = None

    # ---------------------------------------------------------------- details

    async def detail(self, asked: Detail) -> None:
        """Send rows of a stretch."""
        if await self._may_look(asked):
            assert self._shown is not None
            self._spawn(self._sample(asked, self._shown))

    async def record(self, asked: Record) -> None:
        """Send a recording of a text, or a page of one, with the options of the last program."""
        job = replace(self._job(asked.text, self._options), name=asked.name)
        until_s = self._options.until_s or UNTIL_S_DEFAULT
        request = {"do": "record", "job": job_data(job), "ask": asked.ask, "form": asked.form, "until_s": until_s}
        self._spawn(self._record(request, asked.ask))

    async def _record(self, request: dict[str, Any], ask: int) -> None:
        worker = await self._begin(request)
        try:
            _, data = await asyncio.wait_for(worker.frame(), LOOK_S)
            await self._send(message_of(data))
        except TimeoutError:
            await self._send(describe.refused(TAKES_TOO_LONG.format(limit=LOOK_S), ask))
        except EOFError:
            await self._send(describe.refused(HAS_ENDED.format(how="while it recorded a run"), ask))
        finally:
            worker.kill()

    def _spawn(self, work: Coroutine[Any, Any, None]) -> None:
        task = asyncio.get_running_loop().create_task(work)
        self._details.add(task)
        task.add_done_callback(self._details.discard)

    async def _sample(self, asked: Detail, shown: _Shown) -> None:
        async with self._one_detail:
            request = {
                "do": "detail",
                "job": job_data(shown.job),
                "run": shown.number,
                "ask": asked.ask,
                "from_s": asked.from_s,
                "to_s": min(asked.to_s, shown.t),
                "step_s": asked.step_s,
            }
            if asked.from_s > shown.t:
                await self._answer({"type": "detail_ended", "ask": asked.ask, "run": shown.number})
                return
            try:
                worker = await self._begin(request)
            except UsageError as error:
                await self._answer(describe.refused(str(error), asked.ask))
                return
            try:
                while True:
                    kind, data = await asyncio.wait_for(worker.frame(), LOOK_S)
                    if kind == ROWS:
                        await self._send_rows(data)
                        continue
                    await self._answer(message_of(data))
                    return
            except TimeoutError:
                await self._answer(describe.refused(TAKES_TOO_LONG.format(limit=LOOK_S), asked.ask))
            except EOFError:
                how = HAS_ENDED.format(how="while it computed a detail")
                await self._answer(describe.refused(how, asked.ask))
            finally:
                worker.kill()


_REPEATED: Final = frozenset(
    ("run_began", "lines", "marks", "contacts", "moves", "events", "left_out", "cycle", "run_ended")
)
"""Messages that are sent again for a text with the same code."""


def _of_task(task: OpenedTask | None) -> dict[str, Any]:
    """Return what a job takes over from a graphical program."""
    if task is None:
        return {}
    tree = task.source.tree
    return {"places": task.source.places, "arm": task.source.arm, "unset": () if tree is None else tree.unset}


def _ended(shown: _Shown, state: str, killed: str = "") -> Message:
    """Return the end of a run that has not come to its own."""
    found: Message = {"type": "run_ended", "run": shown.number, "state": state, "moment": shown.last}
    return found | {"killed": killed} if killed else found


def _look_request(asked: Seek | Step, t_max: float) -> dict[str, Any]:
    t = min(asked.t, t_max)
    if isinstance(asked, Seek):
        return {"do": "seek", "ask": asked.ask, "t": t}
    more = {"by": asked.by, "thread": asked.thread, "position": asked.position}
    return {"do": "step", "ask": asked.ask, "t": t, **more}


def _moved(message: Message, number: int, moved: Mapping[int, int]) -> Message:
    """Return a message about a run for another one, whose lines have moved."""
    return {name: _with_moved(name, value, moved) for name, value in message.items()} | {"run": number}


def _with_moved(name: str, value: Any, moved: Mapping[int, int]) -> Any:
    if name == "line":
        if isinstance(value, list):
            return [moved.get(line, line) for line in value]
        return moved.get(value, value)
    if isinstance(value, list) and value and isinstance(value[0], dict):
        return [_with_moved("", item, moved) for item in value]
    if isinstance(value, dict) and name not in ("signals", "value"):
        return {key: _with_moved(key, item, moved) for key, item in value.items()}
    return value


def _how(code: int) -> str:
    if code >= 0:
        return f"exit code {code}"
    with suppress(ValueError):
        return signal.Signals(-code).name
    return f"signal {-code}"
