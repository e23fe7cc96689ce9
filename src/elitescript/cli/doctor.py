"""`elitescript doctor`: checks whether this computer has what serving needs."""

from __future__ import annotations

import asyncio
import platform
import socket
import sys
import time
from typing import Any

from elitescript import __version__, page
from elitescript.extras import EXTRAS, INSTALLED, state_of
from elitescript.json_records import jsonlines
from elitescript.services.channels.connect_policy import OPTION, ConnectPolicy
from elitescript.services.child.jail import is_complete
from elitescript.services.clients.binding import bind
from elitescript.services.port_numbers import SSH, port_numbers, spare_numbers
from elitescript.services.robots import probe_jail
from elitescript.services.time.cycle import Cycle

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse

_CYCLES = 50


def doctor(options: argparse.Namespace) -> int:
    """Report versions, jail, ports and timers; return 1 if serving would be unsafe or would not work."""
    versions = {
        "elitescript": __version__,
        "Python": f"{platform.python_version()} ({sys.executable})",
        "greenlet": _greenlet_version(),
        "system": f"{platform.system()} {platform.release()} on {platform.machine()}",
    }
    layers, trouble = asyncio.run(probe_jail())
    extras = {name: state_of(name) for name in EXTRAS}
    ports = port_numbers(options.instance, {}, has_ssh=True)
    # Where this user may not bind a port, `serve` takes its spare one.
    for name, number in spare_numbers(options.instance, {}, has_ssh=True).items():
        if _is_forbidden(ports[name]):
            ports[name] = number
    busy = {name: number for name, number in ports.items() if not _is_free(number)}
    lateness = asyncio.run(_lateness())
    clock_ns = time.get_clock_info("monotonic").resolution * 1e9
    is_jailed = is_complete(layers)
    if options.json:
        record: dict[str, Any] = {
            "type": "doctor",
            "versions": versions,
            "extras": {name: state == INSTALLED for name, state in extras.items()},
            "studio_page": page.is_built(),
            "jail": {layer.name: {"active": layer.is_active, "detail": layer.detail} for layer in layers},
            "is_jailed": is_jailed,
            "trouble": trouble,
            "ports": {name: {"number": number, "free": name not in busy} for name, number in ports.items()},
            "clock_resolution_ns": clock_ns,
            "lateness_ms": lateness,
            "allow_connect": ConnectPolicy().text,
        }
        print(jsonlines.line(record))
        return 0 if is_jailed and not trouble else 1
    for name, version in versions.items():
        print(f"{name + ':':<14}{version}")
    found = (f"{name} {state}" for name, state in extras.items())
    print(f"{'extras:':<14}{', '.join(found)}")
    print(f"{'studio page:':<14}{'built' if page.is_built() else page.NOT_BUILT}")
    print("jail of the process that runs programs:")
    for layer in layers:
        print(f"  {'active' if layer.is_active else 'MISSING':<9}{layer.name + ':':<14}{layer.detail}")
    if trouble:
        print(f"  {trouble}")
    elif not is_jailed:
        print("  Without a layer, programs are trusted as far: serve only people you trust.")
    print(f"ports of instance {options.instance}:")
    for name, number in ports.items():
        condition = " (with serve --ssh)" if name == SSH.name else ""
        print(f"  {'in use' if name in busy else 'free':<9}{number:<6} {name}{condition}")
    print(f"connections:  programs of a served robot reach {ConnectPolicy().text} (`serve {OPTION}`)")
    late = f"{lateness['p50']:.2f} ms late (median), {lateness['max']:.2f} ms at worst"
    print(f"time:         clock resolution {clock_ns:.0f} ns; ticks begin {late}")
    return 0 if is_jailed and not trouble else 1


async def _lateness() -> dict[str, float]:
    cycle = Cycle()
    late: list[float] = []
    try:
        for _ in range(_CYCLES):
            cycle.worst_ns = 0
            await cycle.next()
            late.append(cycle.worst_ns / 1e6)
    finally:
        cycle.close()
    late.sort()
    return {"p50": late[len(late) // 2], "max": late[-1]}


def _is_free(number: int) -> bool:
    try:
        bind("127.0.0.1", number).close()
    except OSError:
        return False
    return True


def _is_forbidden(number: int) -> bool:
    with socket.socket() as probe:
        try:
            probe.bind(("127.0.0.1", number))
        except OSError as error:
            return isinstance(error, PermissionError)
    return False


def _greenlet_version() -> str:
    import greenlet  # type: ignore[import-untyped]

    return str(greenlet.__version__)
