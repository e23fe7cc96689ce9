"""What recording costs: a package written down beside one that is only read, a row read again, megabytes of an hour.

A robot in memory moves for 20 s, and what its RTSI port sends for the recipes of the recorder is kept. A server on
loopback then gives these bytes to the product's own session as fast as it reads them: with no sink, and with the one
that writes MCAP. CPU is that of one process, so the server's part is in both. At 250 Hz a session wakes for each
package instead: `elitescript record` beside a `serve` shows that.
"""

from __future__ import annotations

import asyncio
import struct
import tempfile
from pathlib import Path

from benchmarks.measure import best_in_turn, least, time_of
from benchmarks.table import Row, Time, print_rows, timed_row

SECONDS = 20
ROUNDS = 3
MOVING = """def moving():
  while True:
    movej([0.2, -1.5, 1.2, -1.2, -1.5, 0.1], a=1.4, v=1.0)
    set_standard_digital_out(1, True)
    movej([0.6, -1.2, 1.0, -1.2, -1.5, 0.1], a=1.4, v=1.0)
    set_standard_digital_out(1, False)
  end
end
"""


def rows() -> list[Row]:
    """A package, a row, an hour."""
    from elitescript.recorder.mcap_file import read_recording

    answers, stream, count = _captured()
    with tempfile.TemporaryDirectory() as name:
        paths = (Path(name) / f"{number}.mcap" for number in range(10_000))
        last: list[Path] = []

        def write() -> None:
            last[:] = [next(paths)]
            asyncio.run(_session(answers, stream, count, last[0]))

        def read() -> None:
            asyncio.run(_session(answers, stream, count, None))

        written, heard = best_in_turn([write, read], ROUNDS)
        size = last[0].stat().st_size
        whole = least([time_of(lambda: read_recording(last[0])) for _ in range(ROUNDS)])
        chosen = least([time_of(lambda: read_recording(last[0], ["actual_joint_positions"])) for _ in range(ROUNDS)])
    return [
        timed_row("a package recorded", _each(written, count), "us", other=heard.cpu_s / count, beside="only read"),
        Row("an hour of a moving arm, recorded", "MB", value=size / count * 900_000 / 1e6),
        timed_row("a row read from a recording", _each(whole, count), "us"),
        timed_row("a row read from a recording, six columns", _each(chosen, count), "us"),
    ]


def _each(whole: Time, count: int) -> Time:
    return Time(whole.wall_s / count, whole.cpu_s / count)


def _captured() -> tuple[bytes, bytes, int]:
    """Return an RTSI port's answers to the set-up of the recorder, the packages after it, and how many have rows."""
    from elitescript import VirtualRobot
    from elitescript.client.rtsi_messages import message, output_request, version_request
    from elitescript.recorder.channels import GROUPS

    robot = VirtualRobot("CS66")
    client = robot.connect("rtsi")
    client.send(version_request() + message("v"))
    for group in GROUPS:
        client.send(output_request(group.variables, group.hz or 250.0))
    robot.advance(0.1)
    answers = client.receive()
    client.send(message("S"))
    robot.run(MOVING, until_s=SECONDS)
    stream = client.receive()
    return answers, stream, sum(ident == len(GROUPS) for ident in _idents(stream))


def _idents(stream: bytes) -> list[int]:
    """Return the recipe of each data package."""
    found = []
    at = 0
    while at < len(stream):
        size, letter = struct.unpack_from(">HB", stream, at)
        if letter == ord("U"):
            found.append(stream[at + 3])
        at += size
    return found


async def _session(answers: bytes, stream: bytes, count: int, path: Path | None) -> None:
    """Give a session the packages; write them to a file, if there is one."""
    from elitescript.recorder.session import Session, Target
    from elitescript.recorder.storing import McapSink

    handlers = set()

    async def serve(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        handlers.add(asyncio.current_task())
        left = answers
        while left:
            await reader.readexactly(struct.unpack(">H", await reader.readexactly(2))[0] - 2)
            size = struct.unpack_from(">H", left)[0]
            writer.write(left[:size])
            left = left[size:]
        await reader.readexactly(3)
        writer.write(stream)
        await reader.read()
        writer.transport.abort()

    server = await asyncio.start_server(serve, "127.0.0.1", 0)
    sink = None if path is None else McapSink(path, {})
    port = server.sockets[0].getsockname()[1]
    # Nobody is at the other ports.
    target = Target("127.0.0.1", {"rtsi": port, "primary": 1, "dashboard": 1})
    session = Session(target, [] if sink is None else [sink], lambda _text: None)

    async def all_rows() -> None:
        flushed = 0
        while session.pace.rows < count:
            await asyncio.sleep(0.001)
            if sink is not None and session.pace.rows - flushed >= 250:
                flushed = session.pace.rows
                sink.tick(session.now_ns())

    await session.run(all_rows())
    if sink is not None:
        sink.close()
    server.close()


if __name__ == "__main__":
    print_rows(rows())
