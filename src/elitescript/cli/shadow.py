"""`elitescript shadow`: follows a controller with its program on the simulated robot beside it."""

from __future__ import annotations

import asyncio
import json
import sys
from typing import Final

from elitescript.audit.live import DIFFERENCE, WANTED, Said, Shadow
from elitescript.audit.live_run import Expected
from elitescript.audit.simulation import Cell, cell_of
from elitescript.audit.words import cut_as_json
from elitescript.cli.audit import AGREES, DIFFERS, USAGE, given_program, parse_tolerance, print_problems
from elitescript.cli.listening import check_fetching, check_host, check_positive, chosen_ports, ended, fetched
from elitescript.cli.output.screen import palette_of, rendered
from elitescript.cli.robot_options import options_from
from elitescript.errors import ProgramError, UsageError
from elitescript.findings.found import Findings, finding_of_text, in_order
from elitescript.json_records.jsonlines import line as line_of
from elitescript.language.diagnostics import to_json
from elitescript.language.text.source import SourceFile
from elitescript.lint.engine import check_source
from elitescript.messages.state import Payload
from elitescript.recorder.live import LiveSink
from elitescript.recorder.session import Session, Target
from elitescript.robot import VirtualRobot
from elitescript.shown import shown

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse

_BATCH_S: Final = 0.02
"""Rows of so long are taken together."""


def shadow(options: argparse.Namespace) -> int:
    """Follow a controller until a signal comes or the time is over; return the exit code."""
    check_host(options.host)
    check_positive(("for", options.seconds), ("wait", options.wait))
    check_fetching(options)
    given = options_from(options)
    speed = given.pop("speed", 1.0)
    tolerance, payload = parse_tolerance(options.tolerance), _payload(options.payload)
    ports = chosen_ports("shadow", options)
    cell = _cell(options, given, ports)
    robot = cell.robot()
    try:
        robot.compile(cell.source)
    except ProgramError as error:
        print_problems("shadow", options.program, error)
        return USAGE
    of_text = _say_problems(cell.source, robot, is_json=options.json)
    palette = palette_of(sys.stdout)

    def say(said: Said) -> None:
        text = json.dumps(said.json(), ensure_ascii=False) if options.json else shown(str(said))
        if not options.json and said.kind == DIFFERENCE:
            text = palette.paint("error", text)
        print(text, flush=True)

    follower = Shadow(Expected(cell, tolerance, speed, payload, options.wait), say)
    session = Session(Target(options.host, ports, wanted=WANTED), [sink := LiveSink()], _say)
    asyncio.run(_follow(session, sink, follower, options.seconds))
    follower.finish()
    if sink.left_out:
        _say(f"{sink.left_out:,} rows and messages were left out: this computer is too busy")
    runs, found = follower.runs, follower.differences
    if options.json:
        data = {"complete": follower.ends is None, "ends": cut_as_json(follower.ends)}
        print(
            json.dumps({"type": "summary", "runs": runs, "differences": found, **data, "findings": of_text.counts()}),
            flush=True,
        )
    else:
        words = f"{found} difference{'s' if found != 1 else ''}" if found else "no difference"
        if (cut := follower.ends) is not None:
            words += f"; run {cut.run} goes on, followed until {cut.t:.3f} s, line {cut.line}"
        if of_text:
            words += f"; in the text {of_text.words}"
        print(f"{runs} run{'s' if runs != 1 else ''}: {words}", flush=True)
    return DIFFERS if found else AGREES


def _say_problems(source: SourceFile, robot: VirtualRobot, *, is_json: bool) -> Findings:
    """Print what `check` finds in the text, as `run` does; return it."""
    options = robot.options
    problems = check_source(source, robot.profile, strict=options.strict, arm=robot.model, ignored=options.ignored)
    for problem in problems:
        if is_json:
            print(line_of(to_json(problem)), flush=True)
        else:
            print(rendered(problem, source, palette_of(sys.stderr)), file=sys.stderr)
    return in_order(map(finding_of_text, problems))


async def _follow(session: Session, sink: LiveSink, follower: Shadow, for_s: float | None) -> None:
    async def follow() -> None:
        while True:
            for item in await sink.take():
                follower.take(item)
            await asyncio.sleep(_BATCH_S)

    end = ended(session, for_s)

    async def until() -> None:
        tasks = [asyncio.create_task(follow()), end]
        try:
            done, _ = await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
            for task in done:
                task.result()
        finally:
            for task in tasks:
                task.cancel()

    await session.run(until())


def _cell(options: argparse.Namespace, given: dict[str, object], ports: dict[str, int]) -> Cell:
    model = given.pop("model", None)
    assert model is None or isinstance(model, str)
    if options.fetch_program is not None:
        name, data = fetched(options, ports)
        source: SourceFile | None = SourceFile(f"<{name}>", data.decode("utf-8", "replace"))
    else:
        source = given_program(options.program)
    if source is None:
        raise UsageError(
            "name the program that runs there: --program FILE, or --fetch-program PATH where its SSH port is open; "
            "no other port gives its text"
        )
    return cell_of(source, model, options.world, given)


def _payload(text: str | None) -> Payload | None:
    if text is None:
        return None
    try:
        mass, *cog = (float(part) for part in text.split(","))
    except ValueError:
        mass, cog = -1.0, []
    if not 0.0 <= mass < float("inf") or len(cog) not in (0, 3) or not all(abs(value) < float("inf") for value in cog):
        raise UsageError(f"--payload {text}: write KG or KG,X,Y,Z, such as 2.5,0,0,0.05")
    x, y, z = cog or (0.0, 0.0, 0.0)
    return Payload(mass, (x, y, z))


def _say(text: str) -> None:
    print(f"elitescript shadow: {shown(text)}", file=sys.stderr, flush=True)
