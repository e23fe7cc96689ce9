"""Time waits for the clients of the RTSI port."""

from __future__ import annotations

import asyncio
import struct
from collections.abc import Coroutine, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any, cast

import pytest

from elitescript.environment.memory import MemoryFiles
from elitescript.environment.request_channels import RequestEnvironment
from elitescript.kernel import Kernel, RobotOptions
from elitescript.messages.enums import TaskState
from elitescript.messages.inputs import Input
from elitescript.protocol.rtsi.connection import RtsiConnection
from elitescript.protocol.rtsi.recipes import RtsiPort
from elitescript.services.clients.direct import watchable_loop
from elitescript.services.clients.tcp import Client
from elitescript.services.journal.replay import RecordedRobot
from elitescript.services.journal.writer import Journal
from elitescript.services.output_text import output_text
from elitescript.services.time import lockstep
from elitescript.services.time.cycle import Cycle
from elitescript.services.time.lockstep import Lockstep
from tests.protocol import rtsi_client
from tests.services import fake_robot, served
from tests.services.served import Peer, Scene, run, serving


@pytest.fixture(autouse=True, params=["plain", "watchable"])
def loops(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Both kinds of event loops. The clients of these tests are in the loop themselves: a wait for one is in vain."""
    if request.param == "watchable":
        monkeypatch.setattr(served, "loop_factory", watchable_loop)
        monkeypatch.setattr(lockstep, "DIRECT_MS", 0)


class Partner:
    """A client that gets packages and can answer them."""

    def __init__(self, scene: Scene, peer: Peer, origin: str, ident: int, types: list[str]) -> None:
        self.scene = scene
        self.peer = peer
        self.origin = origin
        self.ident = ident
        self.types = types
        self.values = b""
        """What the last package held behind its timestamp."""

    @classmethod
    async def connect(
        cls, scene: Scene, name: str = "input_int_register0", frequency_hz: float = 250.0, outputs: tuple[str, ...] = ()
    ) -> Partner:
        """A client that has started, and has not sent any input."""
        peer = await scene.connect("rtsi")
        peer.send(rtsi_client.input_recipe([name]))
        ident, types = rtsi_client.set_up((await peer.rtsi("I"))[1])
        peer.send(rtsi_client.output_recipe(frequency_hz, ["timestamp", *outputs]) + rtsi_client.message("S"))
        await peer.rtsi("S")
        return cls(scene, peer, list(scene.server.listeners["rtsi"].clients)[-1], ident, types)

    @classmethod
    async def join(
        cls, scene: Scene, name: str = "input_int_register0", frequency_hz: float = 250.0
    ) -> tuple[Partner, int]:
        """A client that takes part, and the tick of the package that it owes the first answer to."""
        partner = await cls.connect(scene, name, frequency_hz)
        return partner, await partner.begin()

    async def begin(self) -> int:
        """Send the first input; return the tick at which time stands for this client, whose package is read then."""
        self.answer()
        server = self.scene.server
        await self.scene.stands()
        assert server.waits_for == self.origin
        while await self.take() < server.output.tick:
            pass
        return server.output.tick

    async def take(self) -> int:
        """The tick of the next package."""
        _, package = await self.peer.rtsi("U")
        self.values = package[9:]
        return round(rtsi_client.values(package[:9], ["DOUBLE"])[0] * 250)

    def answer(self, value: int = 0) -> None:
        self.peer.send(rtsi_client.package(self.ident, self.types, [value]))


async def wall_time() -> None:
    """So long that a paced robot would have gone on."""
    await asyncio.sleep(0.02)


def test_time_stands_still_until_the_client_has_answered() -> None:
    async def test() -> None:
        async with serving(is_lockstep=True) as scene:
            partner, begin = await Partner.join(scene)
            await wall_time()
            assert scene.server.output.tick == begin
            assert scene.server.waits_for == "rtsi#1"
            for number in range(1, 100):
                partner.answer(number)
                assert await partner.take() == begin + number
            await wall_time()
            assert scene.server.output.tick == begin + 99

    run(test())


def test_a_slower_recipe_makes_longer_steps() -> None:
    async def test() -> None:
        async with serving(is_lockstep=True) as scene:
            partner, begin = await Partner.join(scene, frequency_hz=50.0)
            for number in range(1, 10):
                partner.answer()
                assert await partner.take() == begin + 5 * number

    run(test())


def test_time_waits_for_all_who_take_part() -> None:
    async def test() -> None:
        async with serving(is_lockstep=True) as scene:
            one, begin = await Partner.join(scene)
            two = await Partner.connect(scene, "input_int_register1")
            assert await two.take() == begin
            two.answer()
            await wall_time()
            assert scene.server.output.tick == begin
            one.answer()
            assert await one.take() == await two.take() == begin + 1
            one.answer()
            await wall_time()
            assert scene.server.output.tick == begin + 1
            assert scene.server.waits_for == two.origin
            two.answer()
            assert await one.take() == await two.take() == begin + 2

    run(test())


def test_who_only_listens_is_not_asked_and_misses_nothing() -> None:
    async def test() -> None:
        async with serving(is_lockstep=True) as scene:
            listener = await scene.connect("rtsi")
            listener.send(rtsi_client.output_recipe(250.0, ["timestamp"]) + rtsi_client.message("S"))
            await listener.rtsi("U")
            partner, begin = await Partner.join(scene)
            for _ in range(200):
                partner.answer()
                end = await partner.take()
            assert end == begin + 200
            ticks = []
            while not ticks or ticks[-1] < end:
                ticks.append(round(rtsi_client.values((await listener.rtsi("U"))[1], ["DOUBLE"])[0] * 250))
            assert ticks == list(range(ticks[0], end + 1))

    run(test())


def test_time_goes_on_by_itself_before_and_after() -> None:
    async def test() -> None:
        async with serving(is_lockstep=True) as scene:
            await scene.ticks(3)
            partner, _ = await Partner.join(scene)
            partner.peer.send(rtsi_client.message("P"))
            await partner.peer.rtsi("P")
            # The pause is an answer as good as any: no client takes part any more.
            await scene.ticks(3)
            partner.peer.send(rtsi_client.message("S"))
            await partner.take()
            # Nor does one that has started again and has not sent an input since.
            await scene.ticks(3)
            await partner.begin()
            partner.peer.reset()
            await scene.ticks(3)

    run(test())


def test_a_client_takes_part_from_its_first_input_on() -> None:
    async def test() -> None:
        async with serving(is_lockstep=True) as scene:
            partner = await Partner.connect(scene)
            ticks = [await partner.take() for _ in range(5)]
            assert ticks == list(range(ticks[0], ticks[0] + 5))
            begin = await partner.begin()
            await wall_time()
            assert scene.server.output.tick == begin

    run(test())


def test_an_input_sent_while_paused_does_not_hold_time_after_the_start() -> None:
    async def test() -> None:
        async with serving(is_lockstep=True) as scene:
            partner, _ = await Partner.join(scene)
            partner.peer.send(rtsi_client.message("P"))
            await partner.peer.rtsi("P")
            partner.answer()
            partner.peer.send(rtsi_client.message("S"))
            await partner.peer.rtsi("S")
            await scene.ticks(3)

    run(test())


def test_a_client_without_packages_cannot_hold_or_hurry_time() -> None:
    async def test() -> None:
        async with serving(is_lockstep=True) as scene:
            peer = await scene.connect("rtsi")
            peer.send(rtsi_client.input_recipe(["input_int_register0"]))
            ident, types = rtsi_client.set_up((await peer.rtsi("I"))[1])
            peer.send(rtsi_client.message("S") + rtsi_client.package(ident, types, [1]))
            await peer.rtsi("S")
            await scene.ticks(3)
            assert not scene.server._time._gate.gate().has_participants

    run(test())


def test_a_client_that_falls_silent_is_let_go_and_takes_part_again_with_its_next_input() -> None:
    async def test() -> None:
        async with serving(is_lockstep=True, lockstep_timeout_s=0.05) as scene:
            partner, begin = await Partner.join(scene)
            while await partner.take() < begin + 5:
                pass
            (note,) = scene.notes("let_go")
            assert note.text == (
                "rtsi#1 has not answered a package for 0.05 s: time goes on without it until its next input package; "
                "after that it is waited for a quarter as long"
            )
            assert note.is_problem and note.details == {"origin": "rtsi#1"}
            again = await partner.begin()
            partner.answer()
            assert await partner.take() == again + 1

    run(test())


def test_a_client_that_does_not_read_is_let_go() -> None:
    async def test() -> None:
        async with serving(is_lockstep=True, lockstep_timeout_s=0.3) as scene:
            listener = await scene.connect("rtsi")
            names = ["actual_joint_positions"] * 100
            listener.send(rtsi_client.output_recipe(250.0, names) + rtsi_client.message("S"))
            await listener.rtsi("S")
            listener.writer.transport.pause_reading()
            partner, _ = await Partner.join(scene)
            while not scene.notes("let_go"):
                partner.answer()
                await partner.take()
            assert scene.notes("let_go")[0].text.startswith("rtsi#1 has not read its packages for 0.3 s")
            for _ in range(100):
                partner.answer()
                await partner.take()

    run(test())


class Permits:
    """In the place of the wall clock: time passes as many ticks as the test permits."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self._permits = asyncio.Semaphore(0)

        async def next_tick(cycle: Cycle, ticks: int | None = 1, *, has_outlet: bool = False) -> int:
            await self._permits.acquire()
            return 1

        monkeypatch.setattr(Cycle, "next", next_tick)

    async def ticks(self, scene: Scene, count: int) -> None:
        for _ in range(count):
            output = asyncio.ensure_future(scene.server.next_output())
            await asyncio.sleep(0)
            self._permits.release()
            await output

    def one(self) -> None:
        self._permits.release()


class CountedKernel(Kernel):
    """A robot that notes the ticks that run, and what they are given."""

    def __init__(self, options: RobotOptions) -> None:
        super().__init__(options, RequestEnvironment(MemoryFiles({})))
        self.ran: list[int] = []
        self.heard: list[tuple[int, Input]] = []

    def run_tick(self, inputs: Sequence[Input] = ()) -> None:
        self.ran.append(self.controller.tick)
        self.heard += [(self.controller.tick, item) for item in inputs]
        super().run_tick(inputs)


class EveryTick(CountedKernel):
    """A robot of which no tick is leapt over."""

    def due_tick(self) -> int:
        return self.controller.tick + 1


MOVING = b"""def follow():
  while read_input_integer_register(0) < 2:
    sync()
  end
  movej(get_target_joint_positions()[:5] + [0.4], a=1.4, v=1.05)
  sleep(0.05)
  write_output_integer_register(1, read_input_integer_register(0))
  i = 0
  while i < 5:
    servoj(get_target_joint_positions()[:5] + [0.4 + 0.001 * read_input_integer_register(0) * i], t=0.02)
    i = i + 1
  end
  movej(get_target_joint_positions()[:5] + [0.0], a=1.4, v=1.05)
end
"""
NAMES = (
    "runtime_state",
    "script_control_line",
    "target_joint_positions",
    "actual_joint_positions",
    "actual_joint_current",
    "actual_TCP_pose",
    "actual_TCP_force",
    "joint_temperatures",
    "output_int_register1",
)


async def session(
    robot: Kernel, monkeypatch: pytest.MonkeyPatch, frequency_hz: float, count: int, **options: Any
) -> list[bytes]:
    """Packages of a client whose session begins at the same tick each time, with their timestamps."""
    async with serving(robot, is_lockstep=True, **options) as scene:
        permits = Permits(monkeypatch)
        primary = await scene.connect("primary")
        primary.send(MOVING)
        while scene.server._inputs.is_settled:
            await asyncio.sleep(0)
        await permits.ticks(scene, 5)
        assert scene.server.output.snapshot.robot.task_state is TaskState.PLAYING
        primary.reset()
        while scene.server.listeners["primary"].clients:
            await asyncio.sleep(0)
        partner = await Partner.connect(scene, frequency_hz=frequency_hz, outputs=NAMES)
        first = asyncio.ensure_future(partner.peer.rtsi("U"))
        await permits.ticks(scene, 2)
        packages = [(await first)[1]]
        partner.answer()
        while not scene.server._time._gate.gate().has_participants:
            await asyncio.sleep(0)
        permits.one()
        packages.append((await partner.peer.rtsi("U"))[1])
        for number in range(count):
            partner.answer(min(number, 9))
            packages.append((await partner.peer.rtsi("U"))[1])
        await scene.stands()
        return packages


@pytest.mark.parametrize("loops", ["plain"], indirect=True)
@pytest.mark.parametrize("frequency_hz", [250.0, 25.0, 7.3])
def test_what_the_client_gets_is_the_same_to_the_byte_in_every_run_and_whether_ticks_run_or_not(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, frequency_hz: float
) -> None:
    options = RobotOptions(power_on=True, remote=True)
    count = round(1.3 * frequency_hz)
    robots = [CountedKernel(options), CountedKernel(options), EveryTick(options)]
    found, digests = list[list[bytes]](), list[str]()

    async def test() -> None:
        for robot in robots:
            found.append(await session(robot, monkeypatch, frequency_hz, count))

    run(test())
    for name in ("a", "b"):
        journal = Journal(tmp_path / name, options)
        recorded = RecordedRobot(options, MemoryFiles({}), journal)
        run(collected(session(recorded, monkeypatch, frequency_hz, count), found))
        journal.close()
        digests.append((tmp_path / name).read_text())
    assert digests[0] == digests[1] and '"digest"' in digests[0]
    assert len(set(found[0])) > count / 2
    assert found[1:] == found[:1] * 4
    leaping, _, every = robots
    assert every.next_tick == leaping.next_tick
    last = [output_text(robot.tick_and_snapshot()) for robot in robots]
    assert last[1:] == last[:1] * 2
    assert every.ran == list(range(every.next_tick))
    assert every.heard == leaping.heard
    # In a planned move two ticks run for a package; while the program polls, and in `servoj`, all of them.
    assert frequency_hz > 100.0 or len(leaping.ran) < 0.75 * len(every.ran)


async def collected(packages: Coroutine[Any, Any, list[bytes]], found: list[list[bytes]]) -> None:
    found.append(await packages)


def test_between_an_answer_and_the_next_package_at_rest_two_ticks_run() -> None:
    async def test() -> None:
        robot = CountedKernel(RobotOptions(power_on=True, remote=True))
        async with serving(robot, is_lockstep=True) as scene:
            partner, _ = await Partner.join(scene, frequency_hz=25.0)
            await wall_time()
            # While a connection is being opened every tick runs, on a busy computer up to the next package.
            partner.answer()
            begin = await partner.take()
            robot.ran.clear()
            for number in range(1, 51):
                partner.answer()
                assert await partner.take() == begin + 10 * number
            assert robot.ran == [begin + 10 * number + more for number in range(50) for more in (1, 10)]

    run(test())


def test_what_another_client_asks_while_time_stands_is_done_in_the_next_tick() -> None:
    async def test() -> None:
        robot = CountedKernel(RobotOptions(power_on=True, remote=True))
        async with serving(robot, is_lockstep=True) as scene:
            partner, begin = await Partner.join(scene, frequency_hz=5.0)
            dashboard = await scene.connect("dashboard")
            await dashboard.reader.readuntil(b"NAME.\r\n")
            dashboard.send(b"speed -v 50\n")
            while scene.server._inputs.is_settled:
                await asyncio.sleep(0)
            partner.answer()
            assert await partner.take() == begin + 50
            asked = {tick for tick, item in robot.heard if item.origin.startswith("dashboard")}
            assert asked == {begin + 1}

    run(test())


def test_who_comes_while_time_stands_gets_all_of_the_last_tick_at_once() -> None:
    async def test() -> None:
        async with serving(CountedKernel(RobotOptions(power_on=True)), is_lockstep=True) as scene:
            _, begin = await Partner.join(scene)
            assert not scene.server.listeners["primary"].clients
            newcomer = await Partner.connect(scene, "input_int_register1", outputs=("actual_TCP_pose", "timestamp"))
            assert await newcomer.take() == begin
            assert newcomer.values[-8:] == struct.pack(">d", begin * 0.004)
            assert scene.server.output.tick == begin

    run(test())


def test_no_tick_is_leapt_over_while_a_program_has_a_connection() -> None:
    async def test() -> None:
        has_ended = asyncio.Event()

        async def keep(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
            await reader.read()
            writer.close()
            has_ended.set()

        peer = await asyncio.start_server(keep, "127.0.0.1", 0)
        port = peer.sockets[0].getsockname()[1]
        robot = CountedKernel(RobotOptions(power_on=True, remote=True))
        async with serving(robot, is_lockstep=True) as scene:
            primary = await scene.connect("primary")
            primary.send(f'def talk():\n  socket_open("127.0.0.1", {port})\n  sleep(1000)\nend\n'.encode())
            await scene.until(lambda: scene.server.broker.count)
            primary.reset()
            partner, begin = await Partner.join(scene, frequency_hz=25.0)
            robot.ran.clear()
            for _ in range(5):
                partner.answer()
                await partner.take()
            assert robot.ran == list(range(begin + 1, begin + 51))
        await has_ended.wait()
        peer.close()

    run(test())


@pytest.mark.parametrize("rates", [(25.0, 250.0), (25.0, 50.0), (10.0, 25.0)])
def test_time_leaps_to_the_next_package_of_any_client(rates: tuple[float, float]) -> None:
    async def test() -> None:
        async with serving(CountedKernel(RobotOptions(power_on=True)), is_lockstep=True) as scene:
            slow, _ = await Partner.join(scene, frequency_hz=rates[0])
            quick = await Partner.connect(scene, "input_int_register1", rates[1])
            ticks: dict[str, list[int]] = {slow.origin: [], quick.origin: []}
            ends = asyncio.get_running_loop().time() + 5.0

            async def answer(partner: Partner) -> None:
                while len(ticks[slow.origin]) < 8:
                    assert asyncio.get_running_loop().time() < ends
                    ticks[partner.origin].append(await partner.take())
                    partner.answer()

            slow.answer()
            tasks = [asyncio.ensure_future(answer(partner)) for partner in (slow, quick)]
            await tasks[0]
            tasks[1].cancel()
            for partner, rate in ((slow, rates[0]), (quick, rates[1])):
                steps = {later - tick for tick, later in pairwise(ticks[partner.origin])}
                assert steps == {round(250 / rate)}

    run(test())


class Answerer:
    """What `Lockstep` sees of a client."""

    def __init__(self, origin: str) -> None:
        port = RtsiPort()
        connection = RtsiConnection(origin, fake_robot.FakeRobot().description, port)
        self.origin = origin
        self.connection = connection
        self.owes_input = self.is_behind = self.is_leaving = False


def test_the_time_of_a_stopped_computer_is_not_held_against_a_client() -> None:
    client, lines = taking_part("rtsi#1"), list[str]()
    client.owes_input = True
    lockstep = Lockstep({client.origin: cast(Client, client)}, lambda text, origin: lines.append(text), 0.5)
    assert not lockstep.watch(7, 60.0)
    assert not lockstep.gate().is_open
    assert not any(lockstep.watch(tick, 0.02) for tick in range(8, 100)), "it answers each in time"
    assert sum(lockstep.watch(7, 0.004) for _ in range(130)) == 1
    assert lockstep.gate().is_open


def test_a_client_that_answers_only_some_packages_holds_time_up_for_long_only_once() -> None:
    client = taking_part("rtsi#1")
    connection = client.connection
    client.owes_input = True
    lockstep = Lockstep({client.origin: cast(Client, client)}, lambda text, origin: None, 0.5)

    def looks_until_let_go(tick: int, answers: int) -> int:
        connection._answers = answers
        lockstep.watch(tick, 0.004)
        return next(count for count in range(1, 1000) if lockstep.watch(tick, 0.004))

    assert [looks_until_let_go(tick, answers=tick % 3 + 1) for tick in range(1, 8)] == [125, 32, 8, 2, 1, 1, 1]
    assert looks_until_let_go(8, answers=250) == 1
    assert [looks_until_let_go(9, answers=251), looks_until_let_go(10, answers=1)] == [125, 32]


def test_the_log_names_a_client_that_is_let_go_again_and_again_once_in_ten_seconds() -> None:
    client, lines = taking_part("rtsi#1"), list[str]()
    lockstep = Lockstep({client.origin: cast(Client, client)}, lambda text, origin: lines.append(text), 0.1)
    for tick in range(20):
        client.connection._answers = 2
        client.owes_input = True
        while not lockstep.watch(tick, 0.02):
            pass
    assert len(lines) == 1
    for _ in range(20):
        client.owes_input = False
        lockstep.watch(20, 1.0)
    assert lines[1:] == ["rtsi#1 was let go 19 times more within 10 s"]


def taking_part(origin: str) -> Answerer:
    client = Answerer(origin)
    connection = client.connection
    robot = fake_robot.FakeRobot()
    output = robot.tick(()).with_snapshot(robot.snapshot())
    connection.receive(rtsi_client.output_recipe(250.0, ["timestamp"]), output)
    connection.receive(rtsi_client.input_recipe(["input_int_register0"]) + rtsi_client.message("S"), output)
    connection.receive(rtsi_client.package(1, ["INT32"], [1]), output)
    assert connection.answers == 1
    return client


@pytest.mark.parametrize("farewell", [b"", rtsi_client.message("U", b"\x01")[:1], b"\x00\x00\x00"])
def test_time_does_not_wait_for_who_has_ended_its_half_or_is_closed(farewell: bytes) -> None:
    async def test() -> None:
        async with serving(is_lockstep=True) as scene:
            partner, _ = await Partner.join(scene)
            partner.peer.send(farewell)
            partner.peer.half_close()
            await scene.ticks(3)

    run(test())


def test_others_are_read_while_time_stands_still() -> None:
    async def test() -> None:
        async with serving(is_lockstep=True) as scene:
            await Partner.join(scene)
            dashboard = await scene.connect("dashboard")
            await dashboard.reader.readuntil(b"NAME.\r\n")
            for _ in range(300):
                dashboard.send(b"robotMode\n" * 10)
                for _ in range(10):
                    assert await dashboard.line() == "robotMode: RUNNING\r\n"

    run(test())


def test_a_robot_that_fails_ends_its_time_and_not_the_client() -> None:
    async def test() -> None:
        async with serving(is_lockstep=True) as scene:
            partner, begin = await Partner.join(scene)

            def fail(tick: int) -> None:
                raise RuntimeError("a mistake of ours")

            scene.robot.on_tick = fail
            partner.answer()
            with pytest.raises(RuntimeError, match="a mistake of ours"):
                await scene.server.task
            assert scene.server.output.tick == begin
            assert not scene.notes("gone")

    run(test())
