"""The clients against small peers on loopback: answers, refusals, silence, and what one that reads may not send."""

from __future__ import annotations

import asyncio
import contextlib
import struct
from collections.abc import AsyncIterator

import pytest

from elitescript.client import dashboard, rtsi
from elitescript.client.connecting import CommandError, LinkError, connected, keep_connected
from elitescript.client.dashboard import READING, dashboard_client, is_reading
from elitescript.client.primary import primary_client
from elitescript.client.rtsi import rtsi_client
from elitescript.client.rtsi_messages import InputLayout
from elitescript.protocol.dashboard.verbs import VERBS
from tests.protocol.rtsi_client import message

HOST = "127.0.0.1"


def run(test) -> None:
    asyncio.run(asyncio.wait_for(test, 10.0))


@contextlib.asynccontextmanager
async def peer(*answers: bytes, greeting: bytes = b"") -> AsyncIterator[tuple[int, bytearray]]:
    """A server that gives one answer to each piece that it reads; its port, and all that it has read."""
    got = bytearray()

    async def serve(reader, writer):
        writer.write(greeting)
        for answer in answers:
            data = await reader.read(10_000)
            got.extend(data)
            if not data:
                break
            writer.write(answer)
        while data := await reader.read(10_000):
            got.extend(data)
        writer.transport.abort()

    server = await asyncio.start_server(serve, HOST, 0)
    try:
        yield server.sockets[0].getsockname()[1], got
    finally:
        server.close()


class TestRtsi:
    def test_what_the_controller_does_not_have_is_left_out(self):
        async def test():
            package = message("U", b"\x02" + struct.pack(">di", 1.5, 7))
            async with (
                peer(
                    message("V", b"\x01"),
                    message("M", b"\x03hello") + message("v", struct.pack(">4I", 2, 10, 0, 3)),
                    message("O", b"\x01DOUBLE,NOT_FOUND,INT32,SPARKLE"),
                    message("O", b"\x02DOUBLE,INT32"),
                    message("S", b"\x01") + package[:5],
                    package[5:] + message("U", b"\x07strange") + package,
                ) as (port, _),
                rtsi_client(HOST, port) as client,
            ):
                assert await client.negotiate() == (2, 10, 0, 3)
                layout = await client.set_up_outputs(["timestamp", "sparkle", "robot_mode", "glitter"], 125.0)
                assert layout.names == ("timestamp", "robot_mode")
                await client.start()
                client._writer.write(b"more")
                found = await client.packages()
                while len(found) < 2:
                    found += await client.packages()
                assert [layout.values(layout.flat(payload)) for layout, payload in found] == [
                    {"timestamp": 1.5, "robot_mode": 7}
                ] * 2
                assert client.strange == 1
                assert list(client.texts) == [("info", "hello")]

        run(test())

    @pytest.mark.parametrize(
        ("answer", "text"),
        [
            (message("O", b"\x00NOT_FOUND"), "the controller has none of timestamp"),
            (message("O", b"\x00DOUBLE"), "refuses an output recipe of timestamp"),
            (message("O", b""), "the answer to the output recipe is empty"),
        ],
    )
    def test_recipes_that_are_refused(self, answer, text):
        async def test():
            async with peer(answer, answer) as (port, _):
                with pytest.raises(LinkError, match=text):
                    async with rtsi_client(HOST, port) as client:
                        await client.set_up_outputs(["timestamp"], 125.0)

        run(test())

    def test_inputs_of_another_client(self):
        async def test():
            async with peer(message("I", b"\x00INT32,IN_USE,NOT_FOUND")) as (port, _):
                names = [f"input_int_register{index}" for index in (1, 2, 99)]
                with pytest.raises(
                    LinkError, match="input_int_register2 belongs to another client, input_int_register99 is not there"
                ):
                    async with rtsi_client(HOST, port, may_command=True) as client:
                        await client.set_up_inputs(names)

        run(test())

    def test_a_controller_that_does_not_answer(self, monkeypatch):
        monkeypatch.setattr(rtsi, "ANSWER_S", 0.05)

        async def test():
            async with peer(message("M", b"\x03patience")) as (port, _):
                with pytest.raises(LinkError, match="RTSI, answer to V: nothing came in time"):
                    async with rtsi_client(HOST, port) as client:
                        await client.negotiate()

        run(test())

    def test_reading_writes_no_inputs(self):
        async def test():
            async with peer() as (port, got):
                async with rtsi_client(HOST, port) as client:
                    with pytest.raises(CommandError, match="only reads"):
                        await client.set_up_inputs(["speed_slider_mask"])
                    with pytest.raises(CommandError, match="only reads"):
                        client.write(InputLayout(1, ["speed_slider_mask"], ["UINT32"]), {"speed_slider_mask": 1})
                await asyncio.sleep(0.01)
                assert got == b""

        run(test())


class TestPrimary:
    def test_reading_sends_nothing(self):
        async def test():
            async with peer() as (port, got):
                async with primary_client(HOST, port) as client:
                    with pytest.raises(CommandError, match="only reads"):
                        await client.send_script("stop task")
                await asyncio.sleep(0.01)
                assert got == b""

        run(test())

    def test_the_end_of_the_connection(self):
        async def test():
            server = await asyncio.start_server(lambda _, writer: writer.close(), HOST, 0)
            port = server.sockets[0].getsockname()[1]
            with pytest.raises(LinkError, match="primary port, states: the controller has closed the connection"):
                async with primary_client(HOST, port) as client:
                    await client.messages()
            server.close()

        run(test())


class TestDashboard:
    GREETING = b"EliRobot dashboard shell, version 2.5.0.0.\r\nhelp lists the commands\r\nhelp name explains one\r\n"

    def test_greetings_of_any_length_are_read_past(self):
        async def test(greeting):
            async with peer(b"Hello ELITE ROBOTS\r\n", b"Task is stopped\r\n", greeting=greeting) as (port, got):
                async with dashboard_client(HOST, port) as client:
                    assert await client.ask("task -s") == "Task is stopped"
                assert got == b"echo\ntask -s\n"

        for greeting in (self.GREETING, b"", b"Hi\r\n"):
            run(test(greeting))

    def test_one_at_a_time(self):
        async def test():
            answers = [b"Hello ELITE ROBOTS.\r\n", *(f"answer {number}\r\n".encode() for number in range(5))]
            async with peer(*answers) as (port, _), dashboard_client(HOST, port, may_command=True) as client:
                found = await asyncio.gather(*(client.ask(f"log -a {number}") for number in range(5)))
                assert found == [f"answer {number}" for number in range(5)]

        run(test())

    def test_after_silence_the_connection_is_over(self):
        """A reply that comes late must not be taken for that of the next command."""

        async def test():
            async with peer(b"Hello ELITE ROBOTS.\r\n", b"") as (port, _), dashboard_client(HOST, port) as client:
                with pytest.raises(LinkError, match="no reply to `task` within"):
                    await client.ask("task", 0.05)
                with pytest.raises(LinkError, match="out of step"):
                    await client.ask("task -s")

        run(test())

    def test_what_is_no_dashboard(self, monkeypatch):
        monkeypatch.setattr(dashboard, "REPLY_S", 0.2)

        async def test():
            async with peer(greeting=b"220 mail\r\n" * 30) as (port, _):
                with pytest.raises(LinkError, match="does not answer to `echo`"):
                    async with dashboard_client(HOST, port):
                        pass

        run(test())

    @pytest.mark.parametrize(
        "line",
        [
            *(
                "robotControl -on",
                "robotControl -off",
                "brakeRelease",
                "play",
                "pause",
                "stop",
                "popup -c",
                "log -a hello",
            ),
            *("task -p pick.task", "speed -v 50", "variable -set n 1", "remoteControl -on", "reboot", "shutdown"),
            *("task\nplay", "task -s\rplay", "", "echo play", "robotMode -x", "safety -r", "configuration -p a"),
        ],
    )
    def test_reading_sends_no_command(self, line):
        async def test():
            async with peer(b"Hello ELITE ROBOTS.\r\n") as (port, got):
                async with dashboard_client(HOST, port) as client:
                    with pytest.raises(CommandError):
                        await client.ask(line)
                assert got == b"echo\n"

        run(test())

    def test_commands_that_read_are_known_ones(self):
        rows = {" ".join((row.verb, row.option)).strip(): row for verb in VERBS.values() for row in verb}
        assert rows.keys() >= READING
        assert {row.guard for name, row in rows.items() if name in READING} == {None}
        assert is_reading("variable -get counter")


class TestConnecting:
    def test_nobody_is_there(self):
        async def test():
            server = await asyncio.start_server(lambda *_: None, HOST, 0)
            port = server.sockets[0].getsockname()[1]
            server.close()
            await server.wait_closed()
            with pytest.raises(LinkError, match=f"^RTSI port {HOST}:{port}: connection refused$"):
                async with connected(HOST, port, "RTSI"):
                    pass

        run(test())

    def test_it_is_tried_again_with_longer_pauses(self):
        async def test():
            times, said = [], []

            async def session():
                times.append(asyncio.get_running_loop().time())
                if len(times) < 5:
                    raise LinkError(f"attempt {len(times)}")

            await keep_connected(session, said.append, (0.01, 0.03))
            assert said == [f"attempt {number}" for number in (1, 2, 3, 4)]
            assert times[4] - times[1] > 0.08

        run(test())
