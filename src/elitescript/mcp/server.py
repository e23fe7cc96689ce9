"""`elitescript mcp`: checks, runs and explains programs for agents, over the Model Context Protocol on stdio."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from functools import wraps
from pathlib import Path
from typing import Annotated, Any, Final, Literal, NotRequired, ParamSpec, TypeVar, cast

from mcp.server.mcpserver import MCPServer
from mcp.server.mcpserver.exceptions import ToolError
from mcp_types import CallToolResult, InputRequiredResult, Tool, ToolAnnotations
from pydantic import ConfigDict, Field, ValidationError
from typing_extensions import TypedDict

from elitescript import __version__
from elitescript.commands.catalogue import CATALOGUE
from elitescript.commands.definition.page import matches, record
from elitescript.errors import CODES, ElitescriptError, ProgramError, UsageError, did_you_mean
from elitescript.language.text.source import SourceFile
from elitescript.lint.explanations import body
from elitescript.mcp.answers import (
    Breakpoints,
    Commands,
    Ended,
    Explanation,
    Findings,
    History,
    Outcome,
    Programs,
    Stopped,
    Trace,
    Value,
)
from elitescript.mcp.debugged import DebuggedRuns
from elitescript.mcp.folder import Folder
from elitescript.mcp.workers import ask_once
from elitescript.models.model import model_names
from elitescript.paths import is_task_name
from elitescript.shown import shown
from elitescript.untrusted.files import PROGRAM, read_bytes

_PROGRAM: Final = PROGRAM._replace(bytes_max=2 << 20)

COMMANDS_MAX: Final = 30
RUNS_MAX: Final = 4
"""Programs that are checked or run at the same time; further calls wait."""
PROGRAMS_MAX: Final = 500
TEXT_MAX: Final = 500_000
"""Longest text of a program that comes with a call, characters."""
SHOWN: Final = 60
"""Characters of an argument in a text that refuses it."""

INSTRUCTIONS: Final = """\
EliteScript is the language of the Elite Robots CS arms: Python in which a block may also end with `end`. Programs run
here on a virtual robot: no arm moves, no network is reached. Angles are rad, lengths m, times s of robot time; the same
call gives the same answer. Check a program before running it; look commands up instead of guessing arguments."""

_READS: Final = ToolAnnotations(read_only_hint=True, open_world_hint=False, idempotent_hint=True)
_RUNS: Final = ToolAnnotations(
    read_only_hint=False, destructive_hint=False, open_world_hint=False, idempotent_hint=True
)
"""A program may write files of its folder."""

ProgramFile = Annotated[str | None, Field(description="program in the folder; or give its text")]
ProgramText = Annotated[str | None, Field(description="the program itself, if it is in no file")]
Arm = Annotated[str | None, Field(description="arm: CS63, CS66 (default), CS612, CS616, CS620, CS625, or a TOML file")]
Firmware = Annotated[str | None, Field(description="of the controller, such as 2.14 (default) or 2.10")]
WorldPath = Annotated[str | None, Field(description="TOML file with devices, wires, faults, inputs, robot options")]
Strict = Annotated[bool, Field(strict=True, description="refuse what only warns otherwise")]
Levels = Annotated[
    dict[str, Any] | None,
    Field(description='signals and globals at the start, such as {"standard_digital_in[3]": true, "parts": 4}'),
]
Joints = Annotated[
    list[Annotated[float, Field(strict=True)]] | None,
    Field(description="joint positions at the start, six angles, rad"),
]
Seed = Annotated[int | None, Field(strict=True, description="of random numbers")]
Until = Annotated[
    float | None, Field(strict=True, description="stop after so much robot time, s; an hour if not given")
]
Step = Annotated[float, Field(strict=True, description="time between two rows, s; at most 500 rows")]

Session = Annotated[int, Field(strict=True, description="number that debug_start returned")]
Thread = Annotated[int | None, Field(strict=True, description="number of a thread; the one that stopped if not given")]


class Breakpoint(TypedDict):
    """A breakpoint of a line."""

    __pydantic_config__ = ConfigDict(extra="forbid", strict=True)  # type: ignore[misc]

    line: int
    condition: NotRequired[str]
    """Stops only where it is true."""


_P = ParamSpec("_P")
_R = TypeVar("_R")


class CheckingServer(MCPServer):
    """Serves tools; refuses arguments that a tool does not have, and says in a sentence what is wrong with others."""

    async def list_tools(self) -> list[Tool]:
        """Return the tools; each says that it has no other arguments."""
        tools = await super().list_tools()
        for tool in tools:
            tool.input_schema["additionalProperties"] = False
        return tools

    async def call_tool(
        self, name: str, arguments: dict[str, Any], context: Any = None
    ) -> CallToolResult | InputRequiredResult:
        """Call a tool.

        Raises:
            ToolError: an argument makes no sense, or the tool says so.
        """
        known = {tool.name: tool.input_schema.get("properties", {}) for tool in await super().list_tools()}
        for argument in arguments if name in known else ():
            if argument not in known[name]:
                takes = ", ".join(known[name]) or "nothing"
                raise ToolError(f"{name} takes {takes}, not {argument[:SHOWN]!r}{did_you_mean(argument, known[name])}")
        try:
            return await super().call_tool(name, arguments, context)
        except ToolError as error:
            if isinstance(error.__cause__, ValidationError):
                raise ToolError("; ".join(map(_sentence, error.__cause__.errors()))) from None
            raise


def _sentence(found: Any) -> str:
    """Return in words what is wrong with an argument."""
    place = ".".join(str(part) for part in found["loc"])
    got = "" if found["type"] == "missing" else f", got {found['input']!r:.{SHOWN}}"
    return f"{place}: {found['msg'][:1].lower()}{found['msg'][1:]}{got}"


def make_server(folder: Folder, wall_s: float) -> MCPServer:
    """Return a server.

    Args:
        folder: in which all files are that can be named.
        wall_s: most wall time of one call.
    """
    debugged = DebuggedRuns(wall_s)
    turns = asyncio.Semaphore(RUNS_MAX)

    async def once(request: dict[str, Any]) -> dict[str, Any]:
        async with turns:
            return await ask_once(request, wall_s)

    @asynccontextmanager
    async def lifespan(_: MCPServer) -> AsyncIterator[None]:
        try:
            yield
        finally:
            await debugged.end_all()

    server = CheckingServer(
        "elitescript",
        title="EliteScript",
        version=__version__,
        instructions=INSTRUCTIONS,
        lifespan=lifespan,
        log_level="WARNING",
    )
    tool = _registrar(server)

    def program(
        file: str | None,
        text: str | None,
        robot: str | None = None,
        world: str | None = None,
        **settings: Any,
    ) -> dict[str, Any]:
        if (file is None) == (text is None):
            raise UsageError("name a program by `file`, or give its `text`: one of them")
        request: dict[str, Any] = {name: value for name, value in settings.items() if value is not None}
        if file is not None:
            path = folder.file(file, ".script", ".task", ".txt")
            request |= {"name": file, "task_dir": str(path.parent)}
            if is_task_name(path.name):
                request |= _graphical(path, has_arm=robot is not None or world is not None)
            else:
                request["text"] = SourceFile.from_bytes(file, read_bytes(path, _PROGRAM)).text
        else:
            assert text is not None
            if len(text) > TEXT_MAX:
                raise UsageError(f"the text has {len(text)} characters; at most {TEXT_MAX} are read")
            request |= {"name": "<text>", "text": text}
        if robot is not None:
            request["robot"] = str(folder.file(robot, ".toml")) if robot.endswith(".toml") else robot
        if world is not None:
            request["world"] = str(folder.file(world, ".toml"))
        return request

    @tool(_READS)
    async def programs() -> Programs:
        """List the robot programs (*.script, *.task) in the folder that this server was started for."""
        found, count = folder.programs(PROGRAMS_MAX)
        return {"folder": str(folder.path), "programs": found, "programs_left_out": count - len(found)}

    @tool(_READS)
    async def check(
        file: ProgramFile = None,
        text: ProgramText = None,
        robot: Arm = None,
        firmware: Firmware = None,
        world: WorldPath = None,
        strict: Strict = False,
    ) -> Findings:
        """Find every mistake of a program without running it."""
        request = program(file, text, robot, world, firmware=firmware, strict=strict)
        return cast("Findings", await once({"do": "check", **request}))

    @tool(_RUNS)
    async def run(
        file: ProgramFile = None,
        text: ProgramText = None,
        robot: Arm = None,
        firmware: Firmware = None,
        world: WorldPath = None,
        set: Levels = None,
        joints: Joints = None,
        seed: Seed = None,
        until_s: Until = None,
        strict: Strict = False,
    ) -> Outcome:
        """Run a program to its end on a virtual robot, and return how it ended and what it did."""
        request = program(
            file,
            text,
            robot,
            world,
            firmware=firmware,
            set=set,
            joints=joints,
            seed=seed,
            until_s=until_s,
            strict=strict,
        )
        return cast("Outcome", await once({"do": "run", **request}))

    @tool(_RUNS)
    async def trace(
        from_s: Annotated[float, Field(strict=True, description="begin, s of robot time")],
        to_s: Annotated[float, Field(strict=True, description="end, s of robot time")],
        step_s: Step = 0.1,
        file: ProgramFile = None,
        text: ProgramText = None,
        robot: Arm = None,
        firmware: Firmware = None,
        world: WorldPath = None,
        set: Levels = None,
        joints: Joints = None,
        seed: Seed = None,
        strict: Strict = False,
    ) -> Trace:
        """Run a program and return the robot in a stretch of its time: line, joints, speeds, TCP pose, signals."""
        request = program(
            file,
            text,
            robot,
            world,
            firmware=firmware,
            set=set,
            joints=joints,
            seed=seed,
            strict=strict,
        )
        window = {"from_s": from_s, "to_s": to_s, "step_s": step_s, "until_s": to_s}
        return cast("Trace", await once({"do": "trace", **request, **window}))

    @tool(_RUNS)
    async def debug_start(
        file: ProgramFile = None,
        text: ProgramText = None,
        robot: Arm = None,
        firmware: Firmware = None,
        world: WorldPath = None,
        set: Levels = None,
        joints: Joints = None,
        seed: Seed = None,
        until_s: Until = None,
    ) -> Stopped:
        """Begin to debug a program; it stands before its first statement. One can go on from there, and back."""
        request = program(
            file, text, robot, world, firmware=firmware, set=set, joints=joints, seed=seed, until_s=until_s
        )
        return cast("Stopped", await debugged.start({"do": "debug_start", **request}))

    @tool(_RUNS)
    async def debug_go(
        session: Session,
        how: Annotated[
            Literal["continue", "next", "in", "out", "back", "reverse", "to_time", "last_pass"],
            Field(
                description="continue: to the next breakpoint, alarm or the end; next, in, out, back: one step of a "
                "thread; reverse: to the last breakpoint before; to_time, last_pass (of a line): back or forth"
            ),
        ],
        thread: Thread = None,
        time_s: Annotated[float | None, Field(strict=True, description="for to_time: s of robot time")] = None,
        line: Annotated[int | None, Field(strict=True, description="for last_pass: line of the program")] = None,
    ) -> Stopped:
        """Let a debugged run go on or back; return where it stops, with stack, variables, robot and output."""
        request = {"do": "debug_go", "how": how, "thread": thread, "time_s": time_s, "line": line}
        return cast("Stopped", await debugged.ask(session, request))

    @tool(_RUNS)
    async def debug_breakpoints(
        session: Session,
        lines: Annotated[list[Breakpoint], Field(description="all of them; those that were set before are removed")],
    ) -> Breakpoints:
        """Replace the breakpoints of a debugged run."""
        return cast("Breakpoints", await debugged.ask(session, {"do": "debug_breakpoints", "lines": lines}))

    @tool(_READS)
    async def debug_evaluate(
        session: Session, expression: Annotated[str, Field(description="of the language")], thread: Thread = None
    ) -> Value:
        """Return the value of an expression where a debugged run stands; nothing can be changed by it."""
        request = {"do": "debug_evaluate", "expression": expression, "thread": thread}
        return cast("Value", await debugged.ask(session, request))

    @tool(_READS)
    async def debug_history(
        session: Session,
        name: Annotated[str, Field(description="a signal such as standard_digital_out[3], a global, or a variable")],
        function: Annotated[str, Field(description="in which the variable is; empty for the program's body")] = "",
    ) -> History:
        """Return every change of a variable or signal so far, with time, line and what made it."""
        request = {"do": "debug_history", "name": name, "function": function}
        return cast("History", await debugged.ask(session, request))

    @tool(_READS)
    async def debug_end(session: Session) -> Ended:
        """Give a debugged run up."""
        await debugged.end(session)
        return {"session": session}

    @tool(_READS)
    async def explain(code: Annotated[str, Field(description="such as W203")]) -> Explanation:
        """Explain the code of a finding or an alarm, such as E301, W203 or R110: what it means, why, what to do."""
        name = code.strip().upper()
        if name not in CODES:
            raise UsageError(f"there is no code {code!r}; codes look like E301, W203 and R110")
        return {"code": name, "title": CODES[name].title, "text": body(name)}

    @tool(_READS)
    async def commands(
        words: Annotated[str, Field(description="a name such as movej, or words such as 'digital output'")],
    ) -> Commands:
        """Look up robot commands: all facts of the one with this name, or those that words find."""
        exact = CATALOGUE.get(words.strip())
        if exact is not None:
            return {"commands": [record(exact)], "commands_left_out": 0}
        found = matches(CATALOGUE, words)
        if not found:
            raise UsageError(f"no command has {words!r} in its name, parameters or description")
        brief = [
            {name: value for name, value in record(item).items() if name in ("name", "signature", "summary", "since")}
            for item in found[:COMMANDS_MAX]
        ]
        return {"commands": brief, "commands_left_out": max(0, len(found) - COMMANDS_MAX)}

    return server


def _registrar(server: MCPServer) -> Callable[[ToolAnnotations], Callable[[Callable[_P, Awaitable[_R]]], None]]:
    """Return a decorator that makes tools of functions; what a user did wrong becomes the text of the tool's error."""

    def registered(annotations: ToolAnnotations) -> Callable[[Callable[_P, Awaitable[_R]]], None]:
        def register(function: Callable[_P, Awaitable[_R]]) -> None:
            @wraps(function)
            async def call(*args: _P.args, **keywords: _P.kwargs) -> _R:
                try:
                    return await function(*args, **keywords)
                except ProgramError as error:
                    raise ToolError("\n".join(shown(str(problem)) for problem in error.problems)) from error
                except ElitescriptError as error:
                    raise ToolError(shown(str(error))) from error

            server.tool(annotations=annotations, structured_output=True)(call)

        return register

    return registered


def _graphical(path: Path, *, has_arm: bool) -> dict[str, Any]:
    """Return what a request says of a graphical program; it runs on its own arm, if nothing names another one.

    Raises:
        UsageError: it cannot run; with its nodes.
    """
    from elitescript.environment.task_files import opened_task

    task = opened_task(path)
    if task.errors:
        texts = []
        for problem in task.errors:
            node = task.source.place(problem.line)
            hint = f" ({problem.hint})" if problem.hint else ""
            texts.append(f"{f'{node}: ' if node else ''}{problem}{hint}")
        raise UsageError("\n".join(texts))
    found: dict[str, Any] = {"text": task.source.text, "task": str(path)}
    if not has_arm and task.source.arm in model_names():
        found["robot"] = task.source.arm
    return found
