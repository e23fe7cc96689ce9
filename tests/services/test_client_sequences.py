"""What common clients do, in their order: a real robot behind real sockets, small clients of our own."""

from __future__ import annotations

import asyncio
import struct
from typing import Any

from elitescript.controller.modes import AT_ONCE
from elitescript.environment.memory import MemoryEnvironment
from elitescript.kernel import Kernel, RobotOptions
from tests.protocol import primary_client, rtsi_client
from tests.services.served import Peer, Scene, run, serving

FILES = {
    "wait_program.task": b"<task/>",
    "wait_program.script": b"def wait_program():\n  while True:\n    sleep(0.1)\n  end\nend\n",
    "default.configuration": b"",
}
CONTROL = """
def control():
  def listen():
    while True:
      words = socket_read_binary_integer(3, "commands", 0)
      if words[0] == 3:
        textmsg("command ", words[1], " ", words[2])
      end
    end
  end
  socket_open("127.0.0.1", PORT, "reverse")
  socket_open("127.0.0.1", PORT, "trajectory")
  socket_open("127.0.0.1", PORT, "commands")
  handle = start_thread(listen, ())
  while True:
    words = socket_read_binary_integer(8, "reverse", 0)
    if words[0] > 0 and words[8] == -2:
      break
    end
  end
  stop_thread(handle)
  socket_close("commands")
  socket_close("trajectory")
  socket_close("reverse")
end
"""


def robot(**changes: Any) -> Any:
    return Kernel(RobotOptions(power_times=AT_ONCE, **changes), MemoryEnvironment(FILES))


async def shell(scene: Scene) -> Peer:
    peer = await scene.connect("dashboard")
    await peer.reader.readuntil(b"NAME.\r\n")
    return peer


async def ask(peer: Peer, command: str) -> str:
    peer.send(command.encode() + b"\n")
    return (await peer.line()).removesuffix("\r\n")


async def until(peer: Peer, command: str, reply: str) -> None:
    while await ask(peer, command) != reply:
        await asyncio.sleep(0)


def parameters(state: bytes) -> dict[str, Any]:
    return primary_client.configuration(dict(primary_client.sub_messages(state))[6])


def test_primary_clients_connect_again_and_again_without_a_goodbye() -> None:
    async def test() -> None:
        async with serving(robot()) as scene:
            first = None
            for number in range(10):
                peer = await scene.connect("primary")
                found = parameters(await peer.primary(16))
                first = first or found
                assert (found["a"], found["d"], found["alpha"]) == (first["a"], first["d"], first["alpha"])
                if number % 2:
                    peer.reset()

    run(test())


def test_a_bad_program_is_answered_by_an_exception_of_the_script() -> None:
    async def test() -> None:
        async with serving(robot(power_on=True)) as scene:
            peer = await scene.connect("primary")
            await peer.primary(16)
            peer.send(b'def hello():\n\ttextmsg("hello world")\nend\n')
            peer.send(b"def exFunc():\n\t1abcd\nend\n")
            while (message := primary_client.robot_message(await peer.primary(20)))["kind"] != 10:
                pass
            assert message["line"] == 2
            assert "SyntaxError" in message["text"]

    run(test())


def test_an_rtsi_client_sets_an_output_and_sees_it() -> None:
    async def test() -> None:
        async with serving(robot()) as scene:
            for _ in range(3):
                peer = await scene.connect("rtsi")
                peer.send(rtsi_client.message("V", b"\0\1"))
                assert await peer.rtsi() == ("V", b"\1")
                peer.send(rtsi_client.message("v"))
                assert len((await peer.rtsi("v"))[1]) == 16
                peer.send(rtsi_client.input_recipe(rtsi_client.STANDARD_INPUTS))
                ident, types = rtsi_client.set_up((await peer.rtsi("I"))[1])
                assert ident == 1
                peer.send(rtsi_client.output_recipe(250.0, rtsi_client.STANDARD_OUTPUTS))
                _, kinds = rtsi_client.set_up((await peer.rtsi("O"))[1])
                peer.send(rtsi_client.message("S"))
                assert await peer.rtsi("S") == ("S", b"\1")
                where = rtsi_client.STANDARD_OUTPUTS.index("actual_digital_output_bits")
                for level in (0, 1, 0):
                    values = dict.fromkeys(rtsi_client.STANDARD_INPUTS, 0)
                    values |= {"standard_digital_output_mask": 1, "standard_digital_output": level}
                    values["external_force_torque"] = (0.0,) * 6
                    peer.send(rtsi_client.package(ident, types, values.values()))
                    for _ in range(4):
                        _, body = await peer.rtsi("U")
                    assert rtsi_client.values(body, kinds)[where] & 1 == level
                # The next one wants the same inputs while the ashes of this one are warm.
                peer.reset()

    run(test())


def test_a_dashboard_client_runs_a_task() -> None:
    async def test() -> None:
        async with serving(robot(power_on=True)) as scene:
            peer = await shell(scene)
            assert await ask(peer, "closeSafetyDialog") == "closing safety dialog"
            assert await ask(peer, "task -p wait_program.task") == "Loaded task: wait_program.task"
            await until(peer, "task", "Relative path:wait_program.task")
            assert await ask(peer, "robotControl -off") == "Powering off"
            await until(peer, "robotMode", "robotMode: POWER_OFF")
            assert await ask(peer, "robotControl -on") == "Powering on"
            await until(peer, "robotMode", "robotMode: IDLE")
            assert (await ask(peer, "brakeRelease")).startswith("Brake ")
            await until(peer, "robotMode", "robotMode: RUNNING")
            for _ in range(2):
                assert await ask(peer, "play") == "Starting task"
                await until(peer, "task -s", "Task is running")
                assert await ask(peer, "pause") == "Pausing task"
                await until(peer, "task -s", "Task is paused")
            assert await ask(peer, "stop") == "Stopping task"
            await until(peer, "task -s", "Task is stopped")
            assert await ask(peer, "robotControl -off") == "Powering off"
            assert await ask(peer, "stop") == "Stopping task"
            assert await ask(peer, "log -a Testing Log:") == "Log has been added."
            assert (await ask(peer, "configuration -p default.configuration")).startswith("Loading Configuration :")
            await until(peer, "configuration", "configuration: Relative path:default.configuration")

    run(test())


def test_a_driver_takes_control_and_gives_it_back_again_and_again() -> None:
    """Upload, three connections of the program, a command, the stop; the next upload comes while the last one ends."""

    async def test() -> None:
        met: asyncio.Queue[tuple[asyncio.StreamReader, asyncio.StreamWriter]] = asyncio.Queue()
        writers = []

        async def meet(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
            writers.append(writer)
            await met.put((reader, writer))

        server = await asyncio.start_server(meet, "127.0.0.1", 0)
        port = server.sockets[0].getsockname()[1]
        async with serving(robot(power_on=True)) as scene:
            for number in range(5):
                peer = await scene.connect("primary")
                peer.send(CONTROL.replace("PORT", str(port)).lstrip().encode())
                reverse, trajectory, commands = [await met.get() for _ in range(3)]
                commands[1].write(struct.pack(">3i", 7, number, 0))
                await scene.until(
                    lambda number=number: any(_is_text(what, f"command 7 {number}") for what in scene.said)
                )
                reverse[1].write(struct.pack(">8i", 100, *range(6), -2))
                for reader, _ in (reverse, trajectory, commands):
                    assert await reader.read() == b""
                await peer.close()
                scene.said.clear()
            for writer in writers:
                writer.transport.abort()
            server.close()

    run(test())


def _is_text(what: Any, text: str) -> bool:
    return getattr(what, "text", "").startswith(text)
