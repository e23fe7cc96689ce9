"""`elitescript check --reach`: lists what programs name outside the robot, and whether the options let it through."""

from __future__ import annotations

import json
import sys
from typing import TYPE_CHECKING, Final

from elitescript.cli.program_texts import program_texts
from elitescript.cli.robot_options import options_from
from elitescript.environment.addresses import place_of
from elitescript.environment.line_bindings import parse_bindings
from elitescript.environment.network_option import COMMAND_LINE
from elitescript.errors import ProgramError, ScriptError
from elitescript.language.options import Options
from elitescript.language.parser import parse
from elitescript.language.text.source import SourceFile
from elitescript.lint.outside import CODE, FILE, RPC, SERIAL, Named, outside_names
from elitescript.lint.program import AnalysedProgram
from elitescript.records import NamedTuple
from elitescript.robot import VirtualRobot
from elitescript.runtime.environment import TASK_PATH, relative_name
from elitescript.shown import printable, shown, shown_word

if TYPE_CHECKING:
    import argparse

NOT_FOUND: Final = 2
BROKEN: Final = 3
"""Exit codes: a file cannot be read; a text is no program."""

_LATER: Final = "not known before the run; it is decided when the program connects"


class Verdict(NamedTuple):
    """What becomes of one place of a program.

    Attributes:
        target: where it leads, in one word: address and port, a serial port, or a file.
        reached: whether the options let it through; None if that is not known before the run.
        why: where it ends, or why it is not let through and the option that would allow it.
    """

    target: str
    reached: bool | None
    why: str
    address: str | None = None
    port: int | None = None


def reach(options: argparse.Namespace) -> int:
    """List what the programs of the command line name; return the exit code."""
    robot = VirtualRobot(
        world=options.world, lines=parse_bindings(options.serial) if options.serial else None, **options_from(options)
    )
    robot.set_network_by(COMMAND_LINE)
    code = 0
    count = left = unknown = 0
    for text in program_texts(options.files, "check"):
        if text.data is None:
            print(f"elitescript check: {shown(text.why_not)}", file=sys.stderr)
            code = NOT_FOUND
            continue
        try:
            source = SourceFile.from_bytes(text.name, text.data)
        except ProgramError as error:
            print(f"elitescript check: {shown_word(text.name)}: {error}", file=sys.stderr)
            code = code or BROKEN
            continue
        parsed = parse(source, Options(strict=robot.options.strict))
        if parsed.has_errors:
            name = shown_word(text.name)
            print(f"elitescript check: {name} has errors; what stands there is not listed", file=sys.stderr)
            code = code or BROKEN
        for named in outside_names(AnalysedProgram(parsed, robot.profile)):
            verdict = verdict_on(named, robot)
            count += 1
            left += verdict.reached is False
            unknown += verdict.reached is None
            print(_json(text.name, named, verdict) if options.json else _line(text.name, named, verdict))
    more = f", {unknown} not known before the run" if unknown else ""
    print(
        f"{count} place{'s' * (count != 1)}, {left} not let through by --network {robot.options.network}{more}",
        file=sys.stderr,
    )
    return code


def verdict_on(named: Named, robot: VirtualRobot) -> Verdict:
    """Return what becomes of one place of a program of a robot."""
    if named.kind == FILE:
        return _file(named)
    if named.kind == CODE:
        return Verdict(
            named.text,
            None,
            "what a program in a text reaches is not known before the run; it is decided when it connects",
        )
    if named.name is None or (named.port is None and named.kind not in (RPC, SERIAL)):
        address = None if named.kind in (RPC, SERIAL) else named.name
        return Verdict(named.text if named.name is None else named.name, None, _LATER, address, named.port)
    try:
        place = robot.place(named.kind, named.name, named.port or 0)
    except ScriptError as error:
        return Verdict(named.name, False, str(error))
    if place.port is None:
        return Verdict(place.name, place.is_reached, place.words)
    return Verdict(place_of(place.name, place.port), place.is_reached, place.words, place.name, place.port)


def _file(named: Named) -> Verdict:
    if named.name is None:
        return Verdict(named.text, None, "a file of the task folder, or it is refused")
    try:
        return Verdict(TASK_PATH + relative_name(named.name), True, "in the task folder")
    except ScriptError as error:
        return Verdict(named.name, False, str(error))


def _line(name: str, named: Named, verdict: Verdict) -> str:
    answer = {True: "yes", False: "no", None: "?"}[verdict.reached]
    place = f"{shown_word(name)}:{named.line}:{named.column}"
    return f"{place}: {named.kind} {printable(verdict.target)}: {answer}: {shown(verdict.why)}"


def _json(name: str, named: Named, verdict: Verdict) -> str:
    return json.dumps(
        {
            "type": "reach",
            "file": name,
            "line": named.line,
            "column": named.column,
            "kind": named.kind,
            "by": named.by,
            "target": verdict.target,
            "address": verdict.address,
            "port": verdict.port,
            "reached": verdict.reached,
            "why": verdict.why,
        }
    )
