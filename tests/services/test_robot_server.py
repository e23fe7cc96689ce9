"""One robot on the network: real sockets on loopback, a fake robot behind them."""

from __future__ import annotations

import asyncio
import itertools
from collections.abc import Callable

import pytest

from elitescript.errors import UsageError
from elitescript.messages.events import TextMessage
from elitescript.messages.inputs import ClosePopup, Do, RunUnit
from elitescript.messages.machine import WriteSignal
from elitescript.messages.outputs import Output
from elitescript.services.clients.binding import bind
from elitescript.services.clients.tcp import Client
from elitescript.services.port_numbers import NAMES
from elitescript.services.time import overload
from elitescript.services.time.cycle import PERIOD_NS
from tests.protocol import primary_client, rtsi_client
from tests.services.fake_robot import FakeRobot
from tests.services.made_up_time import WallClock, timed
from tests.services.served import Scene, run, serving


def test_every_port_answers() -> None:
    async def test() -> None:
        async with serving() as scene:
            dashboard = await scene.connect("dashboard")
            assert (await dashboard.line()).startswith("EliRobot dashboard shell")
            for name in ("primary", "secondary", "realtime", "readonly"):
                peer = await scene.connect(name)
                message = await peer.primary(16)
                assert 6 in dict(primary_client.sub_messages(message))
            rtsi = await scene.connect("rtsi")
            rtsi.send(rtsi_client.message("V", b"\0\1"))
            assert await rtsi.rtsi() == ("V", b"\1")
            interpreter = await scene.connect("interpreter")
            interpreter.send(b"x = 1\n")
            assert await interpreter.line() == "ack: 1: x = 1\n"
            query = await scene.connect("query")
            query.send(b"req 7 get_x()\n")
            assert await query.line() == "[7] [success] : [get_x()]\n"

    run(test())


def test_clients_are_told_apart() -> None:
    async def test() -> None:
        async with serving() as scene:
            first, second = await scene.connect("query"), await scene.connect("query")
            second.send(b"req 2 b()\n")
            assert await second.line() == "[2] [success] : [b()]\n"
            first.send(b"req 1 a()\n")
            assert await first.line() == "[1] [success] : [a()]\n"

    run(test())


def test_an_rtsi_client_streams_and_writes() -> None:
    async def test() -> None:
        async with serving() as scene:
            peer = await scene.connect("rtsi")
            peer.send(rtsi_client.input_recipe(["standard_digital_output_mask", "standard_digital_output"]))
            _, reply = await peer.rtsi("I")
            ident, types = rtsi_client.set_up(reply)
            peer.send(rtsi_client.output_recipe(250.0, ["timestamp", "actual_digital_output_bits"]))
            _, reply = await peer.rtsi("O")
            _, kinds = rtsi_client.set_up(reply)
            peer.send(rtsi_client.message("S"))
            times = []
            for _ in range(5):
                _, body = await peer.rtsi("U")
                times.append(rtsi_client.values(body, kinds)[0])
            assert [round(250 * (b - a)) for a, b in itertools.pairwise(times)] == [1, 1, 1, 1]
            peer.send(rtsi_client.package(ident, types, [1, 1]))
            while not rtsi_client.values((await peer.rtsi("U"))[1], kinds)[1] & 1:
                pass
            assert Do("rtsi#1", WriteSignal("standard_digital_out", 0, True)) in [item for _, item in scene.robot.heard]

    run(test())


def test_reconnecting_clients_get_their_inputs_back() -> None:
    """A client that connects anew right after it has closed, or was cut off, must find its inputs free."""

    async def test() -> None:
        async with serving() as scene:
            for number in range(20):
                peer = await scene.connect("rtsi")
                peer.send(rtsi_client.message("V", b"\0\1"))
                await peer.rtsi("V")
                peer.send(rtsi_client.input_recipe(rtsi_client.STANDARD_INPUTS))
                _, reply = await peer.rtsi("I")
                assert rtsi_client.set_up(reply)[0] == 1
                peer.send(rtsi_client.output_recipe(250.0, rtsi_client.STANDARD_OUTPUTS) + rtsi_client.message("S"))
                await peer.rtsi("U")
                if number % 2:
                    peer.reset()
                else:
                    await peer.close()

    run(test())


def test_inputs_of_a_client_that_was_cut_off_are_free_whatever_its_share(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing is left to be read of it, so it does not wait for its turn."""

    async def test() -> None:
        async with serving() as scene:
            for number in range(2):
                peer = await scene.connect("rtsi")
                peer.send(rtsi_client.message("V", b"\0\1"))
                await peer.rtsi("V")
                peer.send(rtsi_client.input_recipe(rtsi_client.STANDARD_INPUTS))
                _, reply = await peer.rtsi("I")
                assert rtsi_client.set_up(reply)[0] == 1
                with monkeypatch.context() as patch:
                    patch.setattr(Client, "_may_be_read", lambda self: False)
                    clients = scene.server.listeners["rtsi"].clients
                    peer.reset()
                    while clients and number == 0:
                        await asyncio.sleep(0)

    run(test())


def test_a_program_that_is_cut_off_by_the_end_of_its_client_counts_as_sent() -> None:
    async def test() -> None:
        async with serving() as scene:
            peer = await scene.connect("primary")
            await peer.primary(16)
            peer.send(b"def hello():\n  textmsg(1)\nend")
            peer.half_close()
            await scene.until(scene.robot.units)
            assert scene.robot.units()[0].startswith("def hello()")
            # Its sender still listens: the state goes on.
            await peer.primary(16)

    run(test())


def test_a_question_is_answered_after_its_client_has_ended_its_half() -> None:
    async def test() -> None:
        async with serving() as scene:
            peer = await scene.connect("dashboard")
            await peer.reader.readuntil(b"NAME.\r\n")
            peer.send(b"robotMode\nvariable -get x\n")
            peer.half_close()
            assert await peer.line() == "robotMode: RUNNING\r\n"
            assert "no such variable" in await peer.line()

    run(test())


def test_garbage_closes_one_connection_and_no_other() -> None:
    async def test() -> None:
        async with serving() as scene:
            good, bad = await scene.connect("rtsi"), await scene.connect("rtsi")
            bad.send(b"\0\0\0")
            assert (await bad.rtsi())[1].endswith(b"a message has at least 3 bytes, not 0")
            assert await bad.reader.read() == b""
            good.send(rtsi_client.message("V", b"\0\1"))
            assert await good.rtsi() == ("V", b"\1")
            assert next(note.text for note in scene.notes("offence")).startswith("rtsi#2: closed: ")

    run(test())


def test_events_are_heard_in_order() -> None:
    async def test() -> None:
        async with serving() as scene:
            events = tuple(TextMessage(0, text, "main", 1) for text in "abc")
            scene.robot.say(events=events)
            await scene.ticks(2)
            assert [what for what in scene.said if isinstance(what, TextMessage)] == list(events)

    run(test())


def test_a_port_in_use_is_named_and_leaves_nothing_open() -> None:
    async def test() -> None:
        taken = bind("127.0.0.1", 0)
        try:
            scene = Scene()
            await scene.server.boot()
            number = taken.getsockname()[1]
            numbers = {**dict.fromkeys(NAMES, 0), "query": number}
            with pytest.raises(UsageError, match=rf"port {number} \(query\) is in use.*--instance.*--port query="):
                scene.server.bind("127.0.0.1", numbers)
            assert scene.server.ports == {}
            await scene.server.close()
        finally:
            taken.close()

    run(test())


def late_at(wall: WallClock, tick: int, late_s: float) -> Callable[[int], None]:
    """What a robot does whose tick of that number takes so long."""

    def on_tick(now: int) -> None:
        if now == tick:
            wall.now_ns += round(late_s * 1e9)

    return on_tick


def test_late_ticks_are_made_up_for_and_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    async def test() -> None:
        async with timed(monkeypatch, FakeRobot()) as (scene, wall, _):
            before, begin_ns = scene.server.output.tick, wall.now_ns
            scene.robot.on_tick = late_at(wall, before + 5, 0.03)
            await wall.go_to(begin_ns + 30 * PERIOD_NS)
            assert scene.server.output.tick == before + 30
            # Those due 4, 8, … and 24 ms after it.
            assert scene.server.overruns == 6

    run(test())


def test_the_log_is_told_of_late_ticks(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(overload, "FIRST_TICKS", 20)

    async def test() -> None:
        async with timed(monkeypatch, FakeRobot()) as (scene, wall, _):
            begin = scene.server.output.tick
            scene.robot.on_tick = late_at(wall, begin + 3, 0.02)
            await wall.go_to(wall.now_ns + 40 * PERIOD_NS)
            note = scene.notes("late")[0]
            assert note.is_problem
            assert note.details["worst_ms"] == 16.0
            assert "of 20 ticks began late" in note.text

    run(test())


def test_programs_of_one_client_arrive_in_order() -> None:
    async def test() -> None:
        async with serving() as scene:
            peer = await scene.connect("primary")
            for number in range(50):
                peer.send(f"def p{number}():\n  pass\nend\n".encode())
            await scene.until(lambda: len(scene.robot.units()) == 50)
            assert [item.text.split("(")[0] for _, item in scene.robot.heard if isinstance(item, RunUnit)] == [
                f"def p{number}" for number in range(50)
            ]

    run(test())


def test_a_follower_gets_every_output_of_a_row_until_it_has_enough() -> None:
    async def test() -> None:
        async with serving() as scene:
            seen: list[int] = []

            def take(output: Output) -> bool:
                seen.append(output.tick)
                return len(seen) < 4

            scene.server.follow(take)
            for _ in range(6):
                # No turn for anybody else in between.
                await scene.server.step()
            assert seen == list(range(seen[0], seen[0] + 4))

    run(test())


def test_who_asks_while_a_tick_is_under_way_hears_of_the_next_one() -> None:
    """What was posted meanwhile is not in the output of that tick, which leaves only later."""

    async def test() -> None:
        async with serving() as scene:
            heard: list[int] = []
            scene.robot.on_tick = lambda tick: asked.set() if not asked.is_set() else None
            asked = asyncio.Event()
            await asked.wait()
            scene.robot.on_tick = lambda tick: None
            scene.server.post([ClosePopup("test")])
            scene.server.follow(lambda output: heard.append(output.tick) or False)
            output = await scene.server.next_output()
            tick = next(tick for tick, item in scene.robot.heard if isinstance(item, ClosePopup))
            assert output.tick == tick
            assert heard == [tick]

    run(test())
