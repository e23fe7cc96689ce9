"""What commands have in common that listen to a controller: its address, how long, a program from its disk."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from pathlib import PurePosixPath

from elitescript.cli.ssh_login import checked_password
from elitescript.cli.stopping import stop_by_signals
from elitescript.errors import UsageError
from elitescript.recorder.fetching import fetch_program
from elitescript.recorder.session import PORTS, Session
from elitescript.services.port_numbers import port_numbers

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse


def check_host(host: str) -> None:
    """Raise UsageError for what is no name or address."""
    if not host or any(letter.isspace() or letter == "/" for letter in host):
        raise UsageError(f"HOST {host!r}: a name or an address is needed, such as 192.168.1.20")


def check_positive(*given: tuple[str, float | None]) -> None:
    """Raise UsageError for the value of an option that is neither None nor above 0."""
    for name, value in given:
        if value is not None and not 0.0 < value < float("inf"):
            raise UsageError(f"--{name} {value:g}: a number above 0 is needed")


def check_fetching(options: argparse.Namespace) -> None:
    """Raise UsageError for options of a program that do not go together."""
    if options.fetch_program is not None and options.program is not None:
        raise UsageError("--program and --fetch-program are two programs; write one of them")
    if (options.fetch_program is not None) != (options.ssh_password is not None):
        raise UsageError("--fetch-program PATH and --ssh-password TEXT|@FILE go together")


def chosen_ports(command: str, options: argparse.Namespace) -> dict[str, int]:
    """Return the numbers of the ports by service."""
    fetches = options.fetch_program is not None
    known = (*PORTS, "ssh") if fetches else PORTS
    chosen: dict[str, int] = {}
    for text in options.port:
        name, equals, number = text.partition("=")
        if not equals or not number.isdecimal():
            raise UsageError(f"--port {text}: write NAME=NUMBER, such as rtsi=40004")
        if name not in known:
            raise UsageError(f"--port {text}: {command} reads the ports {', '.join(known)}")
        chosen[name] = int(number)
    return port_numbers(options.instance, chosen, has_ssh=fetches)


def fetched(options: argparse.Namespace, ports: dict[str, int]) -> tuple[str, bytes]:
    """Return name and content of the program on the controller."""
    path: str = options.fetch_program
    data = fetch_program(options.host, ports["ssh"], checked_password(options.ssh_password), path)
    return PurePosixPath(path).name, data


def ended(session: Session, for_s: float | None) -> asyncio.Task[None]:
    """Return a task that waits for a signal to stop, or until a time is over, which counts from the first connection.

    Signals are handled from this call on, not from the first step of the wait: a connection may be there before that.
    """
    return asyncio.create_task(_wait_for_end(session, stop_by_signals(), for_s))


async def _wait_for_end(session: Session, stop: asyncio.Event, for_s: float | None) -> None:
    if for_s is None:
        await stop.wait()
        return
    await session.heard.wait()
    with suppress(TimeoutError):
        await asyncio.wait_for(stop.wait(), for_s)
