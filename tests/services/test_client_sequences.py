"""Clients that come and go without a goodbye, on real sockets; see tests/robot/test_client_sequences.py for others."""

from __future__ import annotations

import asyncio
import struct
from typing import Any

from elitescript.controller.modes import AT_ONCE
from elitescript.kernel import Kernel, RobotOptions
from tests.protocol import primary_client, rtsi_client
from tests.services.served import run, serving

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
    return Kernel(RobotOptions(power_times=AT_ONCE, **changes))


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


def test_the_next_rtsi_client_gets_the_inputs_of_one_that_was_reset() -> None:
    async def test() -> None:
        async with serving(robot()) as scene:
            for _ in range(3):
                peer = await scene.connect("rtsi")
                peer.send(rtsi_client.input_recipe(rtsi_client.STANDARD_INPUTS))
                ident, _ = rtsi_client.set_up((await peer.rtsi("I"))[1])
                assert ident == 1
                peer.reset()

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
