"""One session with a controller: what its ports show, handed to sinks. It reads, and sends nothing else.

RTSI gets output recipes alone, the primary port nothing at all, the dashboard the questions of `ONCE` and `AGAIN`. Each
port is connected for itself, and again when it was lost.
"""

from __future__ import annotations

import asyncio
import time
from collections.abc import Awaitable, Callable, Mapping, Sequence
from typing import Any, Final

from elitescript.client.connecting import BACKOFF_S, keep_connected
from elitescript.client.dashboard import dashboard_client
from elitescript.client.primary import primary_client
from elitescript.client.primary_messages import RobotState, RobotText
from elitescript.client.rtsi import RtsiClient, rtsi_client
from elitescript.client.rtsi_messages import OutputLayout
from elitescript.errors import PeerError, UsageError
from elitescript.protocol.binary import WireValue
from elitescript.protocol.primary.packets import CARTESIAN, CONFIGURATION, ROBOT_MODE, SAFETY, SubMessage
from elitescript.recorder import facts
from elitescript.recorder.channels import CHANGES, DASHBOARD, EVENTS, GROUPS, PRIMARY, SLOW, TIME, Group
from elitescript.recorder.pace import Gap, Pace, Restart
from elitescript.recorder.sinks import Sink
from elitescript.records import field, record

PORTS: Final = ("rtsi", "primary", "dashboard")
"""Services that are listened to."""
ONCE: Final = ("version", "robot -t", "robot -s", "robot -id")
"""Questions to the dashboard after it was connected."""
AGAIN: Final = ("task", "task -s", "robotMode", "safety -m", "speed", "remoteControl -s")
"""Questions to the dashboard once a second; answers are passed on where they differ from the ones before."""
ASK_S: Final = 1.0
TICK_S: Final = 1.0
_ENDS_MAX: Final = 2
"""So often a recipe may seem to be why a controller ends the connection; then it is asked for no more."""
RATE_HZ: Final = 250.0
TIME_MAX_S: Final = 1e9
"""Time of a controller, s, that none has: 30 years."""

_PARTS: Final[tuple[tuple[SubMessage, str, tuple[str, ...]], ...]] = (
    (CONFIGURATION, facts.CONFIGURATION, ()),
    (CARTESIAN, facts.CARTESIAN, ("TCP pose",)),
    (ROBOT_MODE, facts.ROBOT_MODE, ("timestamp",)),
    (SAFETY, facts.SAFETY, ("elbow position",)),
)
"""Parts of the state of the primary port that are passed on where they change: with the type of their message, and the
fields that are left out, since RTSI has them."""


@record
class Target:
    """Which controller."""

    host: str
    ports: Mapping[str, int]
    """Numbers by the name of the service, those of `PORTS` at least."""
    rate_hz: float = RATE_HZ
    backoff_s: tuple[float, ...] = BACKOFF_S
    wanted: tuple[Group, ...] = field(default=GROUPS)


class Session:
    """Listens to a controller.

    Args:
        target: which one.
        sinks: take what is heard.
        say: takes what people should know, a line each.

    Attributes:
        pace: counts of rows.
        task: name of the loaded program; empty while it is not known.
        up: services that are connected now.
        heard: set when the first service was connected.
    """

    def __init__(self, target: Target, sinks: Sequence[Sink], say: Callable[[str], None]) -> None:
        self.target = target
        self.pace = Pace(target.rate_hz)
        self.task = ""
        self.up: set[str] = set()
        self.heard = asyncio.Event()
        self._missed: dict[str, str] = {}
        """Why each service was not there, as long as none was."""
        self._sinks = tuple(sinks)
        self._say = say
        self._lost_at_ns: dict[str, int] = {}
        """When each service that is not there went, or was first missed."""
        self._wanted = target.wanted
        self._asked_for: Group | None = None
        """What was asked for when the connection ended; None if all was set up."""
        self._ends = 0
        """How often it ended like that, one time after the other."""
        self._said: dict[str, Any] = {}
        self._slow_s: WireValue | None = None
        """Time of the last package of what is slow."""
        self._robot = ""
        """As it was named last."""
        self._gaps: list[Gap] = []
        """Since the last tick."""
        self._offset_ns = time.time_ns() - time.monotonic_ns()

    def now_ns(self) -> int:
        """Return the time, UTC, ns since 1970; it does not jump when the clock of the computer is set."""
        return time.monotonic_ns() + self._offset_ns

    async def run(self, until: Awaitable[object]) -> None:
        """Listen until something has come to pass.

        Raises:
            UsageError: nothing answers at the address.
            StorageError: a sink cannot keep what it got.
        """
        sessions = {"rtsi": self._hear_rtsi, "primary": self._hear_primary, "dashboard": self._hear_dashboard}
        unanswered = asyncio.Event()

        def lost(name: str) -> Callable[[str], None]:
            def take(why: str) -> None:
                if self.heard.is_set():
                    self._lose(name, why)
                    return
                self._missed[name] = why
                if len(self._missed) == len(sessions):
                    unanswered.set()

            return take

        tasks: list[asyncio.Future[Any]] = [
            asyncio.create_task(keep_connected(session, lost(name), self.target.backoff_s), name=name)
            for name, session in sessions.items()
        ]
        tasks.append(asyncio.create_task(self._tick()))
        tasks += [asyncio.ensure_future(until), asyncio.create_task(unanswered.wait())]
        try:
            done, _ = await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
            for task in done:
                task.result()
            if unanswered.is_set():
                raise UsageError(f"nothing answers at {self.target.host}: {'; '.join(self._missed.values())}")
        finally:
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)
        for shown in self.pace.settle(at_once=True):
            self._note(shown)
        self._tell_gaps()

    # ---------------------------------------------------------------- connections

    def _is_back(self, name: str, **more: Any) -> None:
        """Note that a service is connected."""
        self.heard.set()
        missed, self._missed = self._missed, {}
        for other, why in missed.items():
            self._lose(other, why)
        away_ns = self._lost_at_ns.pop(name, None)
        self.up.add(name)
        event = {"type": facts.CONNECTED, "port": name, **more}
        if away_ns is not None:
            event["away_s"] = round((self.now_ns() - away_ns) * 1e-9, 3)
            self._say(f"{name}: connected, after {event['away_s']:.1f} s")
        self._message(EVENTS, event)

    def _lose(self, name: str, why: str) -> None:
        """Note that a service is not connected; the same again and again is one time."""
        self.up.discard(name)
        if name in self._lost_at_ns:
            return
        self._lost_at_ns[name] = self.now_ns()
        self._message(EVENTS, {"type": "lost", "port": name, "why": why})
        self._say(f"{name}: lost, trying again ({why})")

    async def _tick(self) -> None:
        while True:
            await asyncio.sleep(TICK_S)
            self._tell_gaps()
            now_ns = self.now_ns()
            for sink in self._sinks:
                sink.tick(now_ns)

    # ---------------------------------------------------------------- RTSI

    async def _hear_rtsi(self) -> None:
        target = self.target
        async with rtsi_client(target.host, target.ports["rtsi"]) as client:
            version = await client.negotiate()
            takers: dict[int, Callable[[OutputLayout, bytes, int], None]] = {}
            recipes: dict[str, list[str]] = {}
            rows: OutputLayout | None = None
            for group in self._groups():
                layout = await self._set_up(client, group)
                if layout is None:
                    continue
                recipes[group.channel] = list(layout.names)
                if group.is_needed:
                    rows = layout
                    takers[layout.ident] = self._take_row
                else:
                    takers[layout.ident] = _Changes(self, group).take if group.only_changes else self._take_slow
            assert rows is not None
            self._asked_for, self._ends = None, 0
            missing = sorted(
                {name for group in target.wanted for name in group.variables}.difference(*recipes.values())
            )
            await client.start()
            self._is_back("rtsi", version=".".join(map(str, version)), recipes=recipes, missing=missing)
            for sink in self._sinks:
                sink.begin_rows(rows)
            self._is_clock_new = True
            while True:
                found = await client.packages()
                arrived_ns = self.now_ns()
                for layout, payload in found:
                    take = takers.get(layout.ident)
                    if take is not None:
                        take(layout, payload, arrived_ns)
                while client.texts:
                    level, text = client.texts.popleft()
                    self._message(EVENTS, {"type": "text", "port": "rtsi", "level": level, "text": text})

    def _groups(self) -> tuple[Group, ...]:
        """Return what to ask for: one recipe less where the connection ends again and again as they are set up."""
        if self._asked_for is not None:
            self._ends += 1
        if self._ends >= _ENDS_MAX:
            self._ends = 0
            there = [group for group in self._wanted if not group.is_needed]
            culprit = self._asked_for if self._asked_for in there else next(reversed(there), None)
            if culprit is not None:
                self._wanted = tuple(group for group in self._wanted if group is not culprit)
                self._say(f"rtsi: going on without {culprit.channel}: the controller ends the connection at so much")
        return self._wanted

    async def _set_up(self, client: RtsiClient, group: Group) -> OutputLayout | None:
        """Return the layout of a group; None if the controller has nothing of it that can be recorded."""
        self._asked_for = group
        try:
            layout = await client.set_up_outputs(group.variables, group.hz or self.target.rate_hz)
        except PeerError:
            if group.is_needed:
                raise
            return None
        if layout.names[0] != TIME:
            raise PeerError(f"RTSI: the controller has no {TIME}")
        return None if len(layout.names) == 1 else layout

    def _take_row(self, layout: OutputLayout, payload: bytes, arrived_ns: int) -> None:
        flat = layout.flat(payload)
        t = float(flat[1])
        if not abs(t) < TIME_MAX_S:
            raise PeerError(f"RTSI: a row has the {TIME} {t:g}")
        if times := self.pace.repeats(t):
            if times == 1:
                self._message(EVENTS, {"type": "repeated", "t": t}, arrived_ns)
            return
        if self._is_clock_new:
            self._is_clock_new = False
            self._message(EVENTS, {"type": facts.CLOCK, "offset_s": arrived_ns * 1e-9 - t, "t": t}, arrived_ns)
        shown = self.pace.take(t)
        if shown is not None:
            self._note(shown, arrived_ns)
        for sink in self._sinks:
            sink.row(t, flat, arrived_ns)

    def _take_slow(self, layout: OutputLayout, payload: bytes, arrived_ns: int) -> None:
        values = layout.values(layout.flat(payload))
        if values[TIME] == self._slow_s:
            # A repeated package.
            return
        self._slow_s = values[TIME]
        for sink in self._sinks:
            sink.message(SLOW, values, arrived_ns)

    def _note(self, shown: Gap | Restart, at_ns: int | None = None) -> None:
        if isinstance(shown, Gap):
            self._gaps.append(shown)
            self._message(EVENTS, {"type": "gap", **shown._asdict()}, at_ns)
        else:
            self._message(EVENTS, {"type": "restart", **shown._asdict()}, at_ns)
            self._say(f"the controller's time began anew: {shown.after_s:.3f} s after {shown.before_s:.3f} s")

    def _tell_gaps(self) -> None:
        """Say what gaps there were, in one line."""
        for shown in self.pace.settle():
            self._note(shown)
        gaps, self._gaps = self._gaps, []
        if gaps:
            missing = sum(gap.missing for gap in gaps)
            rows = f"{missing:,} row{'s are' if missing > 1 else ' is'} missing"
            self._say(f"{rows} between {gaps[0].begin_s:.3f} s and {gaps[-1].end_s:.3f} s of the controller")

    # ---------------------------------------------------------------- primary port and dashboard

    async def _hear_primary(self) -> None:
        target = self.target
        async with primary_client(target.host, target.ports["primary"]) as client:
            self._is_back("primary")
            while True:
                for message in await client.messages():
                    if isinstance(message, RobotState):
                        self._take_state(message)
                    else:
                        self._message(PRIMARY, _text_record(message))

    def _take_state(self, state: RobotState) -> None:
        for part, kind, left_out in _PARTS:
            values = state.part(part)
            if values is not None:
                kept = {name: value for name, value in values.items() if name not in left_out}
                self._pass_on(PRIMARY, kind, {"type": kind, **kept})

    async def _hear_dashboard(self) -> None:
        target = self.target
        async with dashboard_client(target.host, target.ports["dashboard"]) as client:
            self._is_back("dashboard")
            questions: tuple[str, ...] = (*ONCE, *AGAIN)
            answers: dict[str, str] = {}
            while True:
                for question in questions:
                    answer = answers[question] = await client.ask(question)
                    if question == "task":
                        self.task = facts.task_of(answer)
                        self._name_robot(answers)
                    data = {"type": facts.ANSWER, "question": question, "answer": answer}
                    self._pass_on(DASHBOARD, question, data)
                questions = AGAIN
                await asyncio.sleep(ASK_S)

    def _name_robot(self, answers: Mapping[str, str]) -> None:
        """Say once which robot this is, so that a wrong address or instance is noticed at the begin."""
        where = f"{self.target.host}, dashboard {self.target.ports['dashboard']}"
        robot = f"{answers['robot -t']}, serial {answers['robot -s']}, id {answers['robot -id']}"
        if robot != self._robot:
            self._robot = robot
            self._say(f"{robot}, at {where}; task: {self.task or 'none'}")

    # ---------------------------------------------------------------- sinks

    def _pass_on(self, channel: str, key: str, data: dict[str, Any]) -> None:
        """Pass a record on if it differs from the last one of its kind."""
        if self._said.get(key) != data:
            self._said[key] = data
            self._message(channel, data)

    def _message(self, channel: str, data: Mapping[str, Any], at_ns: int | None = None) -> None:
        arrived_ns = self.now_ns() if at_ns is None else at_ns
        for sink in self._sinks:
            sink.message(channel, data, arrived_ns)


class _Changes:
    """Packages of which only what differs from the one before is passed on."""

    __slots__ = ("_before", "_bytes", "_session")

    def __init__(self, session: Session, group: Group) -> None:
        self._session = session
        self._bytes = b""
        self._before: dict[str, WireValue] = {}

    def take(self, layout: OutputLayout, payload: bytes, arrived_ns: int) -> None:
        """Take a package."""
        # Behind the number of the recipe and the time, a DOUBLE.
        if payload[9:] == self._bytes:
            return
        self._bytes = payload[9:]
        values = layout.values(layout.flat(payload))
        before, self._before = self._before, values
        changed = {name: value for name, value in values.items() if name == TIME or before.get(name) != value}
        for sink in self._session._sinks:
            sink.message(CHANGES, changed, arrived_ns)


def _text_record(message: RobotText) -> dict[str, Any]:
    """Return a robot message as JSON has it."""
    fields = {name: value for name, value in message.values.items() if name not in ("length", "type", "kind", "source")}
    return {"type": message.kind, "source": message.source, **fields, **message.texts}
