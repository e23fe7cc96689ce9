"""One served robot: its ports, its clients, its time.

A tick takes what clients and peers have sent since the last one, gives it to the robot, and publishes its output.
Ticks in which nothing is due are leapt over: to all that is outside it looks as if they had run.
Nothing here depends on the protocol of a client or on how the robot is reached.
"""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Callable, Mapping
from math import inf
from typing import TYPE_CHECKING, Any, Final

from elitescript.errors import UsageError
from elitescript.messages.enums import TaskState
from elitescript.messages.inputs import Input, Lag
from elitescript.messages.outputs import Output
from elitescript.messages.snapshot_parts import ALL_PARTS
from elitescript.messages.timing import PERIOD_S
from elitescript.protocol.connection import Connection
from elitescript.protocol.ports import services_of
from elitescript.records import replace
from elitescript.services.channels.broker import Broker
from elitescript.services.channels.connect_policy import ConnectPolicy
from elitescript.services.clients.binding import bind_one
from elitescript.services.clients.input_queue import WAITING_MAX, InputQueue
from elitescript.services.clients.listener import Listener
from elitescript.services.clients.shares import Shares
from elitescript.services.log import ServerLog
from elitescript.services.port_numbers import SSH
from elitescript.services.robot_link import InProcessLink, RobotLink
from elitescript.services.state_keeper import StateKeeper
from elitescript.services.time.lockstep import TIMEOUT_S, LockstepTime
from elitescript.services.time.paced import PacedTime

if TYPE_CHECKING:
    from elitescript.services.served_devices import ServedDevices
    from elitescript.services.ssh.desk import SshDesk

RTSI: Final = "rtsi"
PENDING_MAX: Final = 10_000
"""Inputs that may wait while time stands still."""


class RobotServer:
    """One robot with its ports and clients.

    Args:
        link: the way to the robot.
        log: takes every event of the robot, and lines about clients, ports and time.
        is_lockstep: time waits for RTSI clients; see `services.time.lockstep`.
        lockstep_timeout_s: how long it waits for each of them, wall time, s.
        lines: what is on the robot's serial ports; see `environment.line_bindings`.
        devices: virtual devices beside the robot.
        keeper: writes down what the robot keeps; nothing is written if None.
        policy: what programs may reach.
        ssh: the SSH port; there is none if None.

    Attributes:
        name: unique among the robots of this `serve`.
        observers: called with the output of each tick that runs; none runs for their sake.
    """

    __slots__ = (
        "_answered",
        "_asks_due",
        "_by_urgency",
        "_followers",
        "_from_tick",
        "_inputs",
        "_is_lockstep",
        "_is_under_way",
        "_keeper",
        "_known_parts",
        "_lag_ticks",
        "_lockstep_timeout_s",
        "_log",
        "_next_followers",
        "_output",
        "_overruns_before",
        "_ssh",
        "_stepped",
        "_task",
        "_time",
        "broker",
        "devices",
        "link",
        "listeners",
        "name",
        "observers",
        "shares",
    )

    def __init__(
        self,
        link: RobotLink,
        log: ServerLog,
        *,
        is_lockstep: bool = False,
        lockstep_timeout_s: float = TIMEOUT_S,
        lines: Mapping[str, str] | None = None,
        devices: ServedDevices | None = None,
        keeper: StateKeeper | None = None,
        policy: ConnectPolicy | None = None,
        ssh: SshDesk | None = None,
    ) -> None:
        self.name = log.robot
        self.link = link
        self.devices = devices
        self.listeners: dict[str, Listener] = {}
        self._output: Output
        self._asks_due = True
        self._from_tick = 0
        """The last tick that has run, or that was leapt over before the one that runs."""
        self.shares = Shares()
        self._log = log
        log.clock = lambda: self.output.tick
        link.watch(self.make_due)
        self._by_urgency: list[Listener] = []
        self._ssh = ssh
        if ssh is not None:
            ssh.taps.on_join = self.make_due
        self.broker = Broker(self.post if ssh is None else self._post_from_lines, lines, policy)
        self._is_lockstep = is_lockstep
        self._lockstep_timeout_s = lockstep_timeout_s
        self._time: PacedTime | None = None
        self._is_under_way = False
        """Whether a tick has taken its inputs and has not given its output yet."""
        self._keeper = keeper
        self._known_parts = 0
        """Of the snapshot of the next tick that are read, if that is known already."""
        self._overruns_before = 0
        self._lag_ticks = 0
        """The last that was an input of the robot."""
        # Time that waits for clients waits for what they ask, too.
        self._inputs = InputQueue(inf) if is_lockstep else InputQueue()
        self._stepped: list[asyncio.Future[Output]] = []
        """Futures that wait for the tick that begins next."""
        self._answered: list[asyncio.Future[Output]] = []
        """Futures that wait for the output of the tick that is under way."""
        self._next_followers: list[Callable[[Output], bool]] = []
        """Calls that follow from the tick that begins next."""
        self._followers: list[Callable[[Output], bool]] = []
        self.observers: list[Callable[[Output], None]] = []
        self._task: asyncio.Task[None] | None = None

    @property
    def output(self) -> Output:
        """Of the last tick; one that was leapt over has given nothing."""
        tick = self._from_tick if self._time is None else self._from_tick + self._time.passed
        if tick != self._output.tick:
            self._output = Output(tick, (), (), (), self._output.snapshot, self._output.parts)
        return self._output

    # ---------------------------------------------------------------- called by clients

    def post(self, inputs: list[Input]) -> int:
        """Take inputs for the next tick that begins; return its number."""
        self._inputs.post(inputs)
        self.link.hurry(inputs)
        return self._from_tick + self.make_due() + self._is_under_way

    def _post_from_lines(self, inputs: list[Input]) -> None:
        """Take inputs from channels; what belongs to bridges of serial ports stays with them."""
        assert self._ssh is not None
        if kept := self._ssh.taps.incoming(inputs):
            self.post(kept)

    def waiting_of(self, origin: str) -> int:
        """Return how many inputs of a client could not go in at the last tick."""
        return self._inputs.waiting_of(origin)

    def wake(self) -> None:
        """Look again whether time may go on, if it waits for a client."""
        if self._time is not None:
            self._time.wake()

    def make_due(self) -> int:
        """Let the next tick run, whether anything is due in it or not; see `Cycle.make_due`."""
        return 1 if self._time is None else self._time.make_due()

    def note(self, kind: str, text: str, *, is_problem: bool = False, **details: Any) -> None:
        """Write a line of the log."""
        self._log.note(kind, text, is_problem=is_problem, **details)

    async def next_output(self) -> Output:
        """Return the output of the next tick that begins, with its snapshot; it has taken what was posted before."""
        waiter: asyncio.Future[Output] = asyncio.get_running_loop().create_future()
        self._stepped.append(waiter)
        self.make_due()
        return await waiter

    def follow(self, take: Callable[[Output], bool]) -> None:
        """Call `take` with every output from the next tick that begins on, without a gap, until it returns False."""
        self._next_followers.append(take)
        self.make_due()

    def connect(self, service: str, origin: str) -> Connection:
        """Make a connection to a port, for a device in this process.

        Raises:
            UsageError: there is no such port.
        """
        listener = self.listeners.get(service)
        if listener is None:
            raise UsageError(f"the robot has the ports {', '.join(self.listeners)}, not {service!r}")
        return listener.connect(origin)

    @property
    def waits_for(self) -> str:
        """Origin of the client that time waits for in lockstep; empty if there is none."""
        return "" if self._time is None else self._time.waits_for

    @property
    def overruns(self) -> int:
        """Ticks that began late."""
        return 0 if self._time is None else self._time.overruns

    @property
    def left_out(self) -> int:
        """Ticks that never were because the computer was away."""
        return 0 if self._time is None else self._time.left_out

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
                number, spare_number = numbers[SSH.name], (spares or {}).get(SSH.name)
                self._ssh.bind(host, number, spare_number, self, self.link.description)
                assert self._ssh.listener is not None
                self._by_urgency.append(self._ssh.listener)
        except BaseException:
            for listener in self.listeners.values():
                listener.release()
            self.listeners.clear()
            raise

    async def boot(self) -> None:
        """Bring the robot up, with one tick, so that there is an output."""
        await self.link.open()
        self._output = await self.link.tick(())
        self._from_tick = self._output.tick
        if self.devices is not None:
            self.devices.begin(self.output, self.connect)
        self._carry_out(self.output)

    async def open(self) -> None:
        """Accept clients, and let time pass from now on."""
        for listener in self.listeners.values():
            await listener.open()
        if self._ssh is not None:
            await self._ssh.open()
        self._write_events(self.output)
        if self._is_lockstep:
            clients, timeout_s = self.listeners[RTSI].clients, self._lockstep_timeout_s
            self._time = LockstepTime(
                self._log, self._note_left_out, clients, self._complete_output, self._relieve, timeout_s
            )
        else:
            self._time = PacedTime(self._log, self._note_left_out)
        self._task = asyncio.get_running_loop().create_task(self._run(self._time))

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
        if self._time is not None:
            self._time.close()
        for listener in self.listeners.values():
            await listener.close()
        if self._ssh is not None:
            await self._ssh.close()
        if self.devices is not None:
            self.devices.close_all()
        self.broker.close_all()
        for waiter in (*self._stepped, *self._answered):
            waiter.cancel()
        await self.link.close()
        if self._keeper is not None:
            await self._keeper.close()

    # ---------------------------------------------------------------- time

    async def _run(self, time: PacedTime) -> None:
        """Let time pass; never returns."""
        while True:
            has_readers = self._has_readers
            if (ticks := await time.next(self._ticks_on, has_outlet=has_readers, is_known=self._is_next_known)) > 1:
                self._pass_over(ticks - 1)
            if time.is_at_outlet:
                # What has come in since it began is for the next one.
                self._is_under_way = True
                number, parts = self._from_tick + 1, self._known_parts
                if (output := self.link.known(number, parts)) is None:
                    output = await self.link.tick((), parts, number, asks_due=False, outlet=time.outlet)
                self._end_tick(output)
                continue
            lag = self._lag(time.lag_ticks)
            inputs = self._begin_tick()
            if lag:
                inputs = [*lag, *inputs]
            # In lockstep an output leaves as soon as it is there.
            outlet = time.outlet if self._has_readers and not self._is_lockstep else None
            number, parts = self._from_tick + 1, self._reads()
            self._end_tick(await self.link.tick(inputs, parts, number, asks_due=self._asks_due, outlet=outlet))

    def _ticks_on(self) -> int | None:
        """Return how many ticks on the next one is that is due; None if there is none."""
        tick = self._from_tick
        nearest = self._next_outside(tick)
        # While others need every tick, the robot is not asked for its next one.
        self._asks_due = nearest is None or nearest > tick + 1
        if self._asks_due:
            due = self.link.due_tick
            if due is not None and (nearest is None or due < nearest):
                nearest = due
        return None if nearest is None else nearest - tick

    def _is_next_known(self) -> bool:
        """Return whether the next tick has nothing to begin with, and the robot has given its output ahead."""
        if self._asks_due or self.devices is not None or self.broker.count or self._answered:
            return False
        if self._lag_ticks or self._stepped or self._followers or self._next_followers or not self._inputs.is_settled:
            return False
        self._known_parts = self._reads()
        return self.link.knows(self._from_tick + 1, self._known_parts)

    def _next_outside(self, tick: int) -> int | None:
        """Return the next tick after `tick` that must run for devices, clients or this server; None if none must."""
        if self._lag_ticks or self._stepped or self._followers or self._next_followers or not self._inputs.is_settled:
            return tick + 1
        # In lockstep shares are counted by the wall clock; the peers of programs have to be looked at in between.
        if self.broker.count if self._is_lockstep else not self.shares.is_settled:
            return tick + 1
        if self._ssh is not None and self._ssh.taps.is_active:
            return tick + 1
        nearest = None if self.devices is None else self.devices.next_tick(tick)
        for listener in self._by_urgency:
            if listener.clients or listener.is_restless:
                due = listener.next_tick(tick)
                if due is not None and (nearest is None or due < nearest):
                    nearest = due
        return nearest

    def _pass_over(self, ticks: int) -> None:
        """Leap over ticks in which nothing is due."""
        tick = self._from_tick = self._from_tick + ticks
        self._output = Output(tick, (), (), (), self._output.snapshot, self._output.parts)
        if self.devices is not None:
            self.devices.pass_over(self._output)

    async def step(self) -> None:
        """Run one tick, whose output leaves as soon as it is there."""
        self._end_tick(await self.link.tick(self._begin_tick(), self._reads()))

    def _lag(self, ticks: int) -> tuple[Lag, ...]:
        """Return the input for how far robot time is behind, if that is new and programs may wait for peers."""
        if ticks == self._lag_ticks or (ticks and not self.broker.count):
            return ()
        self._lag_ticks = ticks
        return (Lag(self.name, ticks),)

    def _note_left_out(self, ticks: int) -> None:
        is_playing = self.output.snapshot.robot.task_state is TaskState.PLAYING
        line = self.link.busy_line
        why = f"the program in line {line} kept the robot" if line else "the computer was away or too slow"
        text = f"{why} for {ticks * PERIOD_S:.3f} s: {ticks} ticks of the robot are left out"
        self.note("left_out", text, is_problem=True, ticks=ticks, is_playing=is_playing)

    def _relieve(self, waits_for: str) -> None:
        """Read clients on, once in a period in lockstep; if too much waits for a tick, only whom time waits for."""
        for listener in self._by_urgency:
            for client in list(listener.clients.values()):
                if len(self._inputs) < PENDING_MAX or client.origin == waits_for:
                    client.relieve()
        self._begin_reading()

    @property
    def _has_readers(self) -> bool:
        """Whether an output leaves this process: clients, or connections of programs, are open."""
        if self.broker.count:
            return True
        for listener in self._by_urgency:  # noqa: SIM110 (`any` takes some times as long)
            if listener.clients:
                return True
        return False

    def _begin_tick(self) -> list[Input]:
        """Take what the tick that begins now is given."""
        self._is_under_way = True
        self._answered += self._stepped
        self._stepped.clear()
        self._followers += self._next_followers
        self._next_followers.clear()
        if self._inputs.refused:
            self._note_refused()
        inputs = self._inputs.take(self.link.room)
        if self.devices is None:
            return inputs
        beside = self.devices.inputs(self.output.tick + 1)
        return inputs + (beside if self._ssh is None else self._ssh.taps.incoming(beside))

    def _end_tick(self, output: Output) -> None:
        """Publish the output of the tick."""
        self._output, self._from_tick = output, output.tick
        self._is_under_way = False
        for listener in self._by_urgency:
            if listener.clients:
                listener.publish(output)
        self._carry_out(output)
        self._write_events(output)
        if self._keeper is not None:
            self._keeper.take(output.snapshot.signals)
        if self._followers:
            self._followers = [take for take in self._followers if take(output)]
        for observe in tuple(self.observers):
            observe(output)
        if not self._is_lockstep:
            self._begin_reading()
        for waiter in self._answered:
            if not waiter.done():
                waiter.set_result(output)
        self._answered.clear()

    def _begin_reading(self) -> None:
        """Let clients be read on: the output of a tick has left; in lockstep, a period of the wall clock has passed."""
        for listener in self._by_urgency:
            if listener.is_restless:
                listener.begin_tick()
        overruns = self.overruns
        self.shares.begin_tick(is_late=overruns > self._overruns_before)
        self._overruns_before = overruns

    def _reads(self) -> int:
        """Return the parts of the snapshot of the tick that begins now that anything reads, as bits."""
        if self._answered:
            return ALL_PARTS
        tick = self._from_tick + 1
        parts = 0 if self.devices is None else self.devices.reads(tick)
        for listener in self._by_urgency:
            if listener.clients:
                parts |= listener.reads(tick)
        return parts

    def _complete_output(self) -> None:
        """Make the snapshot of the last tick whole: while time stands still, no later tick shows it to newcomers."""
        if isinstance(self.link, InProcessLink):
            self._output = self.link.completed(self.output)

    def _note_refused(self) -> None:
        count, self._inputs.refused = self._inputs.refused, 0
        text = f"{count} inputs were refused: {WAITING_MAX} wait for the robot already"
        self.note("overfull", text, is_problem=True, count=count)

    def _carry_out(self, output: Output) -> None:
        """Do what programs ask of their connections; let virtual devices see the tick."""
        if self._ssh is not None:
            requests = self._ssh.taps.outgoing(output.requests)
            if requests is not output.requests:
                output = replace(output, requests=tuple(requests))
        self.broker.carry_out(output.requests if self.devices is None else self.devices.take(output))

    def _write_events(self, output: Output) -> None:
        for event in output.events:
            self._log.event(event)
            if self._ssh is not None:
                self._ssh.take_event(event)
