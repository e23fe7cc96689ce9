"""`elitescript record`: writes down what a controller shows, without touching the robot."""

from __future__ import annotations

import asyncio
import re
import sys
from pathlib import Path
from typing import Final

from elitescript.cli.listening import check_fetching, check_host, check_positive, chosen_ports, ended, fetched
from elitescript.cli.output.screen import ScreenStream, StatusLine
from elitescript.environment.allowance import shown_size
from elitescript.errors import UsageError
from elitescript.recorder.session import PORTS, Session, Target
from elitescript.recorder.sinks import StorageError
from elitescript.recorder.storing import McapSink, Rotation
from elitescript.shown import shown, shown_word
from elitescript.untrusted.files import ARM, PROGRAM, WORLD, read_bytes

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse

_SIZES: Final = {"": 1, "k": 1000, "m": 1000**2, "g": 1000**3, "ki": 1 << 10, "mi": 1 << 20, "gi": 1 << 30}
_ROTATION: Final = re.compile(r"(\d+(?:\.\d+)?)\s*(s|([kmg]i?)?b)?", re.IGNORECASE)
_ROTATION_MAX: Final = 1e15
"""Bytes or seconds; more is a slip."""
LOST: Final = 1
"""Exit code: a part of the recording is lost."""
RATE_MIN_HZ: Final = 1.0
RATE_MAX_HZ: Final = 250.0


def record(options: argparse.Namespace) -> int:
    """Record until a signal comes or the time is over; return the exit code."""
    host: str = options.host
    check_host(host)
    check_positive(("for", options.seconds), ("rate", options.rate))
    if not RATE_MIN_HZ <= options.rate <= RATE_MAX_HZ:
        raise UsageError(f"--rate {options.rate:g}: a controller sends from {RATE_MIN_HZ:g} to {RATE_MAX_HZ:g} Hz")
    fetches = options.fetch_program is not None
    check_fetching(options)
    ports = chosen_ports("record", options)
    attachments = _attachments(options)
    about = {
        "host": host,
        "ports": ", ".join(f"{name} {ports[name]}" for name in PORTS),
        "rate_hz": f"{options.rate:g}",
        **{name: _name_of(value) for name, value in _files(options).items() if value},
    }
    sink = McapSink(Path(options.out), about, attachments, _rotation(options.rotate), _say)
    if fetches:
        sink.add_attachment(*fetched(options, ports), "program")
    session = Session(Target(host, ports, options.rate), [sink], _say)
    try:
        asyncio.run(_record(session, sink, options.seconds))
    except StorageError as error:
        _say(str(error))
        return LOST
    finally:
        sink.close()
    print(_summary(session, sink))
    return LOST if sink.losses else 0


async def _record(session: Session, sink: McapSink, for_s: float | None) -> None:
    status = sys.stderr.status if isinstance(sys.stderr, ScreenStream) else None
    shown = asyncio.create_task(_show_status(session, sink, status)) if status is not None else None
    try:
        await session.run(ended(session, for_s))
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
    if not sink.files:
        return f"{shown_word(str(sink.path))}: ended before anybody answered, nothing is recorded"
    pace = session.pace
    files = f" in {sink.files} files" if sink.files > 1 else ""
    restarts = f", the controller's time began anew {pace.restarts} x" if pace.restarts else ""
    repeated = f", {pace.repeated:,} repeated rows left out" if pace.repeated else ""
    # That they came without gaps is no comfort where rows are lost with their file.
    gaps = "" if sink.losses and not pace.gaps else f", {_gaps(session)}"
    gone = f", {sink.rows_lost:,} of them lost with their file" if sink.rows_lost else ""
    rows = f"{pace.rows:,} rows at {pace.rate_hz:g} Hz{gone}{gaps}{repeated}{restarts}"
    lost = "".join(f"\n{shown(words)}" for words in sink.losses)
    return f"{shown_word(str(sink.path))}: {rows}; {shown_size(sink.size)}{files}{lost}"


def _gaps(session: Session) -> str:
    pace = session.pace
    if not pace.gaps:
        return "no gaps"
    rows = f"{pace.missing:,} row{'s' if pace.missing > 1 else ''}"
    return f"{pace.gaps:,} gap{'s' if pace.gaps > 1 else ''} ({rows})"


def _say(text: str) -> None:
    print(f"elitescript record: {shown(text)}", file=sys.stderr, flush=True)


def _rotation(text: str | None) -> Rotation:
    if text is None:
        return Rotation()
    found = _ROTATION.fullmatch(text.strip())
    if found is None or not 0.0 < float(found[1]) < _ROTATION_MAX:
        raise UsageError(f"--rotate {text}: write a size, such as 500MB, or a time, such as 3600s")
    unit = (found[2] or "s").lower()
    if unit == "s":
        return Rotation(age_s=float(found[1]))
    return Rotation(size=round(float(found[1]) * _SIZES[unit.removesuffix("b")]))


def _files(options: argparse.Namespace) -> dict[str, str | None]:
    return {"program": options.program, "world": options.world, "robot": options.robot}


def _name_of(path: str) -> str:
    return Path(path).name


_KINDS: Final = {"program": PROGRAM, "world": WORLD, "robot": ARM}


def _attachments(options: argparse.Namespace) -> dict[str, bytes]:
    """Return the files that are to stand in the recording, by name."""
    found: dict[str, bytes] = {}
    for kind, path in _files(options).items():
        if path is None or (kind == "robot" and not path.endswith(".toml")):
            # A robot may be the name of a model.
            continue
        data = read_bytes(path, _KINDS[kind])
        name = _name_of(path)
        if name in found:
            raise UsageError(f"--{kind}: another file of the recording has the name {name} too")
        found[name] = data
    return found
