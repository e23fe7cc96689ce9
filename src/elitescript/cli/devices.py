"""`elitescript devices`: serves virtual devices on real ports and serial lines."""

from __future__ import annotations

import asyncio
import sys
import time
from typing import Final

from elitescript.cli.stopping import stop_by_signals
from elitescript.devices.surroundings import VIRTUAL
from elitescript.environment.line_bindings import parse_bindings
from elitescript.errors import UsageError
from elitescript.json_records import jsonlines
from elitescript.services.device_server import DeviceServer
from elitescript.shown import shown, shown_word
from elitescript.world_file import load_world_file

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse

PORT_MAX: Final = 65_535


def devices(options: argparse.Namespace) -> int:
    """Serve devices until a signal comes; return the exit code."""
    found = load_world_file(options.file, network=VIRTUAL)
    if found.world is None or not (found.world.network.servers or found.world.network.lines):
        raise UsageError(
            f"{options.file} declares nothing to connect to: no [[tcp]], [[rpc]], [[modbus]] or [[serial]]"
        )
    numbers = dict(map(_number, options.port))
    for port in numbers:
        if port not in [place if isinstance(place, int) else place[1] for place in found.world.network.servers]:
            raise UsageError(f"--port {port}={numbers[port]}: no device of {options.file} has the port {port}")
    start_s = time.monotonic()

    def say(text: str, is_problem: bool) -> None:
        passed_s = time.monotonic() - start_s
        stream = sys.stderr if is_problem and not options.json else sys.stdout
        if options.json:
            level = "warning" if is_problem else "info"
            line = jsonlines.line({"type": "device", "t": round(passed_s, 3), "level": level, "text": text})
        else:
            line = f"{passed_s:10.3f} s  {shown(text)}"
        print(line, file=stream, flush=True)

    asyncio.run(_serve(DeviceServer(found.world, options.host, numbers, parse_bindings(options.serial), say), options))
    return 0


async def _serve(server: DeviceServer, options: argparse.Namespace) -> None:
    stop = stop_by_signals()
    await server.open()
    if options.json:
        print(jsonlines.line({"type": "ready", "host": options.host, "devices": server.places}), flush=True)
    else:
        print(f"ready on {options.host}: {shown_word(', '.join(server.places))}", flush=True)
    running = asyncio.create_task(server.run())
    waiting = asyncio.create_task(stop.wait())
    try:
        await asyncio.wait([running, waiting], return_when=asyncio.FIRST_COMPLETED)
        if running.done():
            running.result()
    finally:
        running.cancel()
        waiting.cancel()
        server.close()


def _number(text: str) -> tuple[int, int]:
    port, equals, number = text.partition("=")
    if not equals or not port.isdecimal() or not number.isdecimal() or int(number) > PORT_MAX:
        raise UsageError(f"--port {text}: write PORT=NUMBER, such as 502=5020 (0: any free one)")
    return int(port), int(number)
