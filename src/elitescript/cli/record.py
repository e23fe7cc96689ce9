"""`elitescript record`: writes down what a controller shows, without touching the robot."""

from __future__ import annotations

import asyncio
import re
import signal
import sys
from contextlib import suppress
from pathlib import Path, PurePosixPath
from typing import Final

from elitescript.cli.output.screen import ScreenStream, StatusLine
from elitescript.cli.ssh_login import checked_password
from elitescript.environment.allowance import shown_size
from elitescript.errors import UsageError
from elitescript.paths import why_no_file
from elitescript.recorder.fetching import fetch_program
from elitescript.recorder.session import PORTS, Session, Target
from elitescript.recorder.storing import McapSink, Rotation
from elitescript.services.port_numbers import port_numbers

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse

_SIZES: Final = {"": 1, "k": 1000, "m": 1000**2, "g": 1000**3, "ki": 1 << 10, "mi": 1 << 20, "gi": 1 << 30}
_ROTATION: Final = re.compile(r"(\d+(?:\.\d+)?)\s*(s|([kmg]i?)?b)?", re.IGNORECASE)
RATE_MIN_HZ: Final = 1.0
RATE_MAX_HZ: Final = 250.0


def record(options: argparse.Namespace) -> int:
    """Record until a signal comes or the time is over; return the exit code."""
    host: str = options.host
    if not host or any(letter.isspace() or letter == "/" for letter in host):
        raise UsageError(f"HOST {host!r}: a name or an address is needed, such as 192.168.1.20")
    for name, value in (("for", options.seconds), ("rate", options.rate)):
        if value is not None and not 0.0 < value < float("inf"):
            raise UsageError(f"--{name} {value:g}: a number above 0 is needed")
    if not RATE_MIN_HZ <= options.rate <= RATE_MAX_HZ:
        raise UsageError(f"--rate {options.rate:g}: a controller sends from {RATE_MIN_HZ:g} to {RATE_MAX_HZ:g} Hz")
    fetches = options.fetch_program is not None
    if fetches and options.program is not None:
        raise UsageError("--program and --fetch-program are two programs; write one of them")
    if fetches != (options.ssh_password is not None):
        raise UsageError("--fetch-program PATH and --ssh-password TEXT|@FILE go together")
    ports = port_numbers(options.instance, _chosen(options.port, fetches=fetches), has_ssh=fetches)
    attachments = _attachments(options)
    about = {
        "host": host,
        "ports": ", ".join(f"{name} {ports[name]}" for name in PORTS),
        "rate_hz": f"{options.rate:g}",
        **{name: _name_of(value) for name, value in _files(options).items() if value},
    }
    sink = McapSink(Path(options.out), about, attachments, _rotation(options.rotate))
    if fetches:
        name = PurePosixPath(options.fetch_program).name
        data = fetch_program(host, ports["ssh"], checked_password(options.ssh_password), options.fetch_program)
        sink.add_attachment(name, data, "program")
    session = Session(Target(host, ports, options.rate), [sink], _say)
    try:
        asyncio.run(_record(session, sink, options.seconds))
    finally:
        sink.close()
    print(_summary(session, sink))
    return 0


async def _record(session: Session, sink: McapSink, for_s: float | None) -> None:
    stop = asyncio.Event()
    loop = asyncio.get_running_loop()
    for number in (signal.SIGINT, signal.SIGTERM):
        try:
            loop.add_signal_handler(number, stop.set)
        except NotImplementedError:
            signal.signal(number, lambda *_: loop.call_soon_threadsafe(stop.set))
    status = sys.stderr.status if isinstance(sys.stderr, ScreenStream) else None
    shown = asyncio.create_task(_show_status(session, sink, status)) if status is not None else None

    async def ended() -> None:
        if for_s is None:
            await stop.wait()
            return
        # The time counts from the first connection, so that a recording is as long as it was asked for.
        await session.heard.wait()
        with suppress(TimeoutError):
            await asyncio.wait_for(stop.wait(), for_s)

    try:
        await session.run(ended())
    finally:
        if shown is not None:
            shown.cancel()


async def _show_status(session: Session, sink: McapSink, status: StatusLine) -> None:
    before = 0
    while True:
        await asyncio.sleep(1.0)
        rows = session.pace.rows
        status.show(
            f"{rows:,} rows  {rows - before} Hz  {_gaps(session)}  {session.task or 'no task'}  "
            f"{shown_size(sink.size)}  (Ctrl-C ends it)"
        )
        before = rows


def _summary(session: Session, sink: McapSink) -> str:
    pace = session.pace
    files = f" in {sink.files} files" if sink.files > 1 else ""
    restarts = f", the controller's time began anew {pace.restarts} x" if pace.restarts else ""
    repeated = f", {pace.repeated:,} repeated rows left out" if pace.repeated else ""
    rows = f"{pace.rows:,} rows at {pace.rate_hz:g} Hz, {_gaps(session)}{repeated}{restarts}"
    return f"{sink.path}: {rows}; {shown_size(sink.size)}{files}"


def _gaps(session: Session) -> str:
    pace = session.pace
    if not pace.gaps:
        return "no gaps"
    rows = f"{pace.missing:,} row{'s' if pace.missing > 1 else ''}"
    return f"{pace.gaps:,} gap{'s' if pace.gaps > 1 else ''} ({rows})"


def _say(text: str) -> None:
    print(f"elitescript record: {text}", file=sys.stderr, flush=True)


def _chosen(given: list[str], *, fetches: bool) -> dict[str, int]:
    known = (*PORTS, "ssh") if fetches else PORTS
    chosen: dict[str, int] = {}
    for text in given:
        name, equals, number = text.partition("=")
        if not equals or not number.isdecimal():
            raise UsageError(f"--port {text}: write NAME=NUMBER, such as rtsi=40004")
        if name not in known:
            raise UsageError(f"--port {text}: record reads the ports {', '.join(known)}")
        chosen[name] = int(number)
    return chosen


def _rotation(text: str | None) -> Rotation:
    if text is None:
        return Rotation()
    found = _ROTATION.fullmatch(text.strip())
    if found is None or float(found[1]) <= 0.0:
        raise UsageError(f"--rotate {text}: write a size, such as 500MB, or a time, such as 3600s")
    unit = (found[2] or "s").lower()
    if unit == "s":
        return Rotation(age_s=float(found[1]))
    return Rotation(size=round(float(found[1]) * _SIZES[unit.removesuffix("b")]))


def _files(options: argparse.Namespace) -> dict[str, str | None]:
    return {"program": options.program, "world": options.world, "robot": options.robot}


def _name_of(path: str) -> str:
    return Path(path).name


def _attachments(options: argparse.Namespace) -> dict[str, bytes]:
    """Return the files that are to stand in the recording, by name."""
    found: dict[str, bytes] = {}
    for kind, path in _files(options).items():
        if path is None or (kind == "robot" and not path.endswith(".toml")):
            # A robot may be the name of a model.
            continue
        reason = why_no_file(path)
        if reason:
            raise UsageError(f"--{kind}: {path} {reason}")
        try:
            data = Path(path).read_bytes()
        except OSError as error:
            raise UsageError(f"--{kind}: {path}: {error.strerror or error}") from None
        name = _name_of(path)
        if name in found:
            raise UsageError(f"--{kind}: another file of the recording has the name {name} too")
        found[name] = data
    return found
