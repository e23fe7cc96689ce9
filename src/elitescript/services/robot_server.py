"""One served robot: its ports, its clients, its time.

A tick takes what clients and peers have sent since the last one, gives it to the robot, and passes what the robot says
on to everybody. Nothing here depends on who asked or how the robot is reached.
"""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from math import inf
from operator import attrgetter
from typing import TYPE_CHECKING, Any, Final

from elitescript.errors import UsageError
from elitescript.messages.enums import TaskState
from elitescript.messages.events import Event
from elitescript.messages.inputs import Input, Lag
from elitescript.messages.outputs import Output
from elitescript.messages.snapshot import Snapshot
from elitescript.messages.timing import PERIOD_S, TICKS_PER_S
from elitescript.protocol.table import services_of
from elitescript.services.channels.broker import Broker
from elitescript.services.channels.connect_policy import ConnectPolicy
from elitescript.services.clients.binding import bind_one
from elitescript.services.clients.input_queue import WAITING_MAX, InputQueue
from elitescript.services.clients.listener import Listener
from elitescript.services.clients.shares import Shares
from elitescript.services.robot_link import RobotLink
from elitescript.services.state_keeper import StateKeeper
from elitescript.services.table import SSH
from elitescript.services.time.cycle import Cycle
from elitescript.services.time.lockstep import TIMEOUT_S, Lockstep

if TYPE_CHECKING:
    from elitescript.devices.world import World
    from elitescript.services.served_devices import ServedDevices
    from elitescript.services.ssh.desk import SshDesk

RTSI: Final = "rtsi"
DEVICE: Final = "device"
"""Kind of the notes that are words of virtual devices."""
PENDING_MAX: Final = 10_000
"""Inputs that may wait while time stands still."""
REPORT_TICKS: Final = 10 * TICKS_PER_S
"""After so many ticks the log is told how many of them were late."""
LATE_MANY: Final = REPORT_TICKS // 100
"""So many of them are a problem."""
BUSY_STEPS: Final = 64
"""Ticks in lockstep after which everybody else is served."""


_ALL_FIELDS: Final = attrgetter(*Snapshot.__dataclass_fields__)
_OVERRUNS_AT: Final = list(Snapshot.__dataclass_fields__).index("overruns")


@dataclass(frozen=True, slots=True)
class LogLine:
    """A line of the log of a `serve`: something about a client, a port or time."""

    robot: str
    kind: str
    text: str
    is_problem: bool
    details: Mapping[str, Any] = field(default_factory=dict)


Listen = Callable[["RobotServer", Event | LogLine], None]


class RobotServer:
    """One robot and everybody who talks to it.

    Args:
        name: tells it from the other robots of this `serve`.
        link: the way to the robot.
        is_lockstep: time waits for RTSI clients; see `services.time.lockstep`.
        lockstep_timeout_s: how long it waits for each of them, wall time, s.
        listen: hears every event of the robot and every note; must not block.
        lines: what is on the robot's serial ports; see `environment.line_bindings`.
        world: virtual devices beside the robot.
        keeper: remembers what the robot keeps; nobody does if None.
        policy: what programs may reach.
        ssh_password: that SSH clients log in with; there is no SSH port if None.
    """

    __slots__ = (
        "_answered",
        "_by_urgency",
        "_comers",
        "_cycle",
        "_failure",
        "_followers",
        "_inbox",
        "_is_lockstep",
        "_is_standing",
        "_is_under_way",
        "_keeper",
        "_lag_ticks",
        "_listen",
        "_lockstep",
        "_lockstep_timeout_s",
        "_news",
        "_overruns_before",
        "_relief",
        "_relieved_s",
        "_ssh",
        "_stepped",
        "_task",
        "_world",
        "broker",
        "link",
        "listeners",
        "name",
        "output",
        "shares",
        "waits_for",
    )

    def __init__(
        self,
        name: str,
        link: RobotLink,
        listen: Listen,
        *,
        is_lockstep: bool = False,
        lockstep_timeout_s: float = TIMEOUT_S,
        lines: Mapping[str, str] | None = None,
        world: World | None = None,
        keeper: StateKeeper | None = None,
        policy: ConnectPolicy | None = None,
        ssh_password: str | None = None,
    ) -> None:
        self.name = name
        self.link = link
        self.listeners: dict[str, Listener] = {}
        self._by_urgency: list[Listener] = []
        self._ssh: SshDesk | None = None
        if ssh_password is not None:
            from elitescript.services.ssh.desk import SshDesk

            self._ssh = SshDesk(self, ssh_password)
        self.broker = Broker(self.post if self._ssh is None else self._post_from_lines, lines, policy)
        self.output: Output
        self.shares = Shares()
        self.waits_for = ""
        """Origin of the client that time waits for in lockstep."""
        self._listen = listen
        self._is_lockstep = is_lockstep
        self._lockstep_timeout_s = lockstep_timeout_s
        self._lockstep: Lockstep
        self._is_standing = False
        self._is_under_way = False
        """Whether a tick has taken its inputs and has not given its output yet."""
        self._keeper = keeper
        if keeper is not None:
            keeper.tell = lambda text: self.note("state", text, is_problem=True)
        self._overruns_before = 0
        self._lag_ticks = 0
        """That the robot was told last."""
        self._failure: Exception | None = None
        # Time that waits for clients waits for what they ask, too.
        self._inbox = InputQueue(inf) if is_lockstep else InputQueue()
        self._relief: asyncio.TimerHandle | None = None
        self._relieved_s = 0.0
        self._news = asyncio.Event()
        self._stepped: list[asyncio.Future[Output]] = []
        """Wait for the tick that begins next."""
        self._answered: list[asyncio.Future[Output]] = []
        """Wait for the output of the tick that is under way."""
        self._comers: list[Callable[[Output], bool]] = []
        """Follow from the tick that begins next."""
        self._followers: list[Callable[[Output], bool]] = []
        self._cycle: Cycle | None = None
        self._task: asyncio.Task[None] | None = None
        self._world: ServedDevices | None = None
        if world is not None:
            from elitescript.services.served_devices import beside

            self._world = beside(self, world)

    # ---------------------------------------------------------------- what clients call

    def post(self, inputs: list[Input]) -> int:
        """Take inputs for the next tick that begins; return its number."""
        self._inbox.post(inputs)
        return self.output.tick + (2 if self._is_under_way else 1)

    def _post_from_lines(self, inputs: list[Input]) -> None:
        """Take what channels have to say; what belongs to bridges of serial ports stays with them."""
        assert self._ssh is not None
        if kept := self._ssh.taps.incoming(inputs):
            self.post(kept)

    def waiting_of(self, origin: str) -> int:
        """Inputs of a client that could not go in at the last tick."""
        return self._inbox.waiting_of(origin)

    def wake(self) -> None:
        """Something has changed that time may have waited for."""
        if not self._is_standing or self._failure is not None:
            return
        tick_now = getattr(self.link, "tick_now", None)
        found = self._lockstep.gate()
        if tick_now is None or not found.is_open or not found.has_participants:
            self._news.set()
            return
        # The shortest way from a client's answer to its next package: no turn of the event loop in between.
        try:
            self._pass_on(tick_now(self._taken()))
        except Exception as error:
            # It is not the client's: what passes time ends with it.
            self._failure = error
            self._news.set()
            return
        found = self._lockstep.gate()
        self.waits_for = found.waits_for
        if found.is_open:
            self._news.set()

    def note(self, kind: str, text: str, *, is_problem: bool = False, **details: Any) -> None:
        """A line for the log."""
        self._listen(self, LogLine(self.name, kind, text, is_problem, details))

    async def next_output(self) -> Output:
        """What the robot says at the next tick that begins: it has heard what was posted before."""
        waiter: asyncio.Future[Output] = asyncio.get_running_loop().create_future()
        self._stepped.append(waiter)
        return await waiter

    def follow(self, take: Callable[[Output], bool]) -> None:
        """Call `take` with every output from the next tick that begins on, without a gap, until it returns False."""
        self._comers.append(take)

    @property
    def world(self) -> ServedDevices | None:
        """The virtual devices beside the robot."""
        return self._world

    @property
    def overruns(self) -> int:
        """Ticks that began late."""
        return 0 if self._cycle is None else self._cycle.overruns

    @property
    def left_out(self) -> int:
        """Ticks that never were because the computer was away."""
        return 0 if self._cycle is None else self._cycle.left_out

    @property
    def ports(self) -> dict[str, int]:
        """Number of every open port by name."""
        numbers = {name: listener.number for name, listener in self.listeners.items()}
        if self._ssh is not None and self._ssh.number:
            numbers[SSH.name] = self._ssh.number
        return numbers

    @property
    def host_key(self) -> str:
        """Fingerprint of the SSH port's key; empty without such a port."""
        return "" if self._ssh is None else self._ssh.fingerprint

    # ---------------------------------------------------------------- life

    def bind(self, host: str, numbers: Mapping[str, int], spares: Mapping[str, int] | None = None) -> None:
        """Take all ports, or none; clients that connect wait until `open`.

        The robot's link must be open.

        Args:
            host: address to listen at.
            numbers: of every service.
            spares: what to take instead of a number that this user may not have.

        Raises:
            UsageError: a port cannot be had.
        """
        try:
            for service in services_of(self.link.description.firmware):
                name = service.name
                bound, spare = bind_one(name, host, numbers[name], (spares or {}).get(name))
                if spare:
                    self.note("spare_port", spare, is_problem=True, port=name, number=bound.getsockname()[1])
                connect = service.open(self.link.description)
                self.listeners[service.name] = Listener(service, self, connect, bound)
            self._by_urgency = sorted(self.listeners.values(), key=lambda listener: listener.service.name != RTSI)
            if self._ssh is not None:
                self._ssh.bind(host, numbers[SSH.name], (spares or {}).get(SSH.name))
        except BaseException:
            for listener in self.listeners.values():
                listener.release()
            self.listeners.clear()
            raise

    async def boot(self) -> None:
        """Bring the robot up, with one tick, so that there is something to show."""
        await self.link.open()
        self.output = await self.link.tick(())
        if self._world is not None:
            self._world.begin(self.output)
        self._carry_out(self.output)

    async def open(self) -> None:
        """Accept clients, and let time pass from now on."""
        for listener in self.listeners.values():
            await listener.open()
        if self._ssh is not None:
            await self._ssh.open()
        self._hear(self.output)
        self._cycle = Cycle(on_left_out=self._left_out)
        if self._is_lockstep:
            self._lockstep = Lockstep(self.listeners[RTSI].clients, self._let_go, self._lockstep_timeout_s)
        run = self._run_in_lockstep() if self._is_lockstep else self._run_paced()
        self._task = asyncio.get_running_loop().create_task(run)

    @property
    def task(self) -> asyncio.Task[None]:
        """What passes time; it ends only by a failure."""
        if self._task is None:
            raise UsageError("the robot is not served yet")
        return self._task

    async def close(self) -> None:
        """Stop time, let clients, peers and the robot go."""
        if self._task is not None:
            self._task.cancel()
            with contextlib.suppress(asyncio.CancelledError, Exception):
                await self._task
        if self._relief is not None:
            self._relief.cancel()
        for listener in self.listeners.values():
            await listener.close()
        if self._ssh is not None:
            await self._ssh.close()
        if self._world is not None:
            self._world.close_all()
        self.broker.close_all()
        for waiter in (*self._stepped, *self._answered):
            waiter.cancel()
        if self._cycle is not None:
            self._cycle.close()
        await self.link.close()
        if self._keeper is not None:
            await self._keeper.close()

    # ---------------------------------------------------------------- time

    async def _run_paced(self) -> None:
        cycle = self._cycle
        assert cycle is not None
        while True:
            before = cycle.overruns
            for _ in range(REPORT_TICKS):
                await cycle.next()
                inputs = [*self._lag(cycle.lag_ticks), *self._taken()]
                output = await self.link.tick(inputs, self._reads_snapshot())
                if cycle.overruns:
                    output = replace(output, snapshot=_counted(output.snapshot, cycle.overruns))
                await cycle.outlet()
                self._pass_on(output)
            self._tell_late(cycle, cycle.overruns - before)

    def _lag(self, ticks: int) -> tuple[Lag, ...]:
        """What tells the robot how far its time is behind, if that is new and its programs may wait for peers."""
        if ticks == self._lag_ticks or (ticks and not self.broker.count):
            return ()
        self._lag_ticks = ticks
        return (Lag(self.name, ticks),)

    def _tell_late(self, cycle: Cycle, late: int) -> None:
        """Say how many ticks began late of the last `REPORT_TICKS`."""
        worst_ms, cycle.worst_ns = cycle.worst_ns / 1e6, 0
        if late:
            text = f"{late} of {REPORT_TICKS} ticks began late, by {worst_ms:.1f} ms at most: the computer is busy"
            self.note("late", text, is_problem=late >= LATE_MANY, ticks=late, worst_ms=worst_ms)

    async def _run_in_lockstep(self) -> None:
        cycle = self._cycle
        assert cycle is not None
        steps = 0
        self._relieved_s = asyncio.get_running_loop().time()
        self._relieve()
        while True:
            found = self._lockstep.gate()
            self.waits_for = found.waits_for
            if not found.has_participants:
                await cycle.next()
                if not self._lockstep.gate().has_participants:
                    await self.step()
                continue
            cycle.restart()
            if found.is_open:
                await self.step()
                steps += 1
                if steps % BUSY_STEPS == 0:
                    await asyncio.sleep(0)
            else:
                self._news.clear()
                self._is_standing = True
                try:
                    await self._news.wait()
                finally:
                    self._is_standing = False
                if self._failure is not None:
                    raise self._failure

    def _relieve(self) -> None:
        """While no tick comes, clients are read on; if too much waits for a tick, only the one that time waits for."""
        for listener in self.listeners.values():
            for client in list(listener.clients.values()):
                if len(self._inbox) < PENDING_MAX or client.origin == self.waits_for:
                    client.relieve()
        self._begin_reading()
        loop = asyncio.get_running_loop()
        before_s, self._relieved_s = self._relieved_s, loop.time()
        if self._lockstep.watch(self.output.tick, self._relieved_s - before_s):
            self._news.set()
        self._relief = loop.call_later(PERIOD_S, self._relieve)

    def _let_go(self, text: str, origin: str) -> None:
        self.note("let_go", text, is_problem=True, origin=origin)

    async def step(self) -> None:
        """One tick, whose output leaves as soon as it is there."""
        self._pass_on(await self.link.tick(self._taken()))

    def _taken(self) -> list[Input]:
        """What the tick that begins now is given."""
        self._is_under_way = True
        self._answered += self._stepped
        self._stepped.clear()
        self._followers += self._comers
        self._comers.clear()
        if self._inbox.refused:
            self._tell_refused()
        inputs = self._inbox.take(self.link.room)
        if self._world is None:
            return inputs
        beside = self._world.inputs(self.output.tick + 1)
        return inputs + (beside if self._ssh is None else self._ssh.taps.incoming(beside))

    def _reads_snapshot(self) -> bool:
        """Whether anything reads more of the snapshot of the tick that begins now than the discrete state."""
        tick = self.output.tick + 1
        if self._answered or (self._world is not None and self._world.reads_snapshot(tick)):
            return True
        return any(listener.reads_snapshot(tick) for listener in self._by_urgency)

    def _tell_refused(self) -> None:
        count, self._inbox.refused = self._inbox.refused, 0
        text = f"{count} inputs were refused: {WAITING_MAX} wait for the robot already"
        self.note("overfull", text, is_problem=True, count=count)

    def _pass_on(self, output: Output) -> None:
        """Give everybody what the robot has said."""
        self.output = output
        self._is_under_way = False
        for listener in self._by_urgency:
            if listener.clients:
                listener.publish(output)
        self._carry_out(output)
        self._hear(output)
        if self._keeper is not None:
            self._keeper.take(output.snapshot.signals)
        if self._followers:
            self._followers = [take for take in self._followers if take(output)]
        self._begin_reading()
        for waiter in self._answered:
            if not waiter.done():
                waiter.set_result(output)
        self._answered.clear()

    def _carry_out(self, output: Output) -> None:
        """Do what programs ask of their connections; virtual devices see the tick."""
        if self._ssh is not None:
            requests = self._ssh.taps.outgoing(output.requests)
            if requests is not output.requests:
                output = replace(output, requests=tuple(requests))
        self.broker.carry_out(output.requests if self._world is None else self._world.take(output))

    def _begin_reading(self) -> None:
        """Everybody has got the tick; now there is time for what clients send."""
        for listener in self.listeners.values():
            listener.begin_tick()
        overruns = self.overruns
        self.shares.begin_tick(is_late=overruns > self._overruns_before)
        self._overruns_before = overruns

    def _hear(self, output: Output) -> None:
        for event in output.events:
            self._listen(self, event)
            if self._ssh is not None:
                self._ssh.hear(event)

    def _left_out(self, ticks: int) -> None:
        is_playing = self.output.snapshot.robot.task_state is TaskState.PLAYING
        text = (
            f"the computer was away or too slow for {ticks * PERIOD_S:.3f} s: {ticks} ticks of the robot are left out"
        )
        self.note("left_out", text, is_problem=True, ticks=ticks, is_playing=is_playing)


def _counted(snapshot: Snapshot, overruns: int) -> Snapshot:
    """A snapshot with that many overruns. `dataclasses.replace` takes some times as long."""
    fields = list(_ALL_FIELDS(snapshot))
    fields[_OVERRUNS_AT] = overruns
    return Snapshot(*fields)
