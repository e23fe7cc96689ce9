"""One small working call of each command of `elitescript`, and of each variant that writes or reads something else.

Tables of commands x situations are made from `CALLS`: parametrise over it (or over a choice of it), `prepare` a folder,
and `start` or `finish` the call there. A test fails for a command without a call, so that a new command is in every
table by itself.

>>> @pytest.mark.parametrize("call", chosen(lambda call: call.writes))
... def test_what_is_written_is_whole(call, tmp_path):
...     prepare(call, tmp_path)
...     with beside(call, tmp_path) as words:
...         done = finish(call, tmp_path, words)
...     assert done.returncode == call.code
"""

from __future__ import annotations

import asyncio
import json
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Final, Literal

import pytest

from elitescript import page
from elitescript.records import NamedTuple

LIMIT_S: Final = 120.0
"""Wall time after which a call hangs."""

MOVES: Final = """def moves():
  textmsg("begin")
  movej([0.3, -1.4, -1.7, -1.6, 1.57, 0], a=1.4, v=1.05)
  set_standard_digital_out(0, True)
  write_output_integer_register(5, 7)
  textmsg("end")
end
"""
BROKEN: Final = "def broken():\n  x = \nend\n"
UGLY: Final = "def ugly():\n x=1\nend\n"
ALARM: Final = "def alarm():\n  textmsg('begin')\n  x = [1][3]\nend\n"
WORLD: Final = """[[tcp]]
name = "camera"
port = 5000
replies = [{ to = "where?", send = "(1, 2)" }]
"""
File = str | Callable[[], bytes]
"""What a file holds: its text, or what makes its bytes."""
Ends = Literal["itself", "input", "signal"]
Beside = Literal["", "controller", "robot"]


class Call(NamedTuple):
    """A call that works.

    Attributes:
        name: unique: the command, and what the variant does.
        words: arguments of `elitescript`; the first one is the command.
        files: that it reads, by path in its folder.
        code: exit code; of one that is ended by a signal, after SIGTERM.
        writes: paths of what it writes, which are not there before.
        changes: those of `files` that it writes over by design.
        input: standard input, which ends behind it.
        ends: whether it ends `itself`, at the end of its `input`, or only at a `signal`; then it has printed a line
            that begins with `ready`.
        may_be_endless: whether calls of this kind can go on for ever, and so end with the reader of their output; those
            that speak a protocol end with their client instead.
        prints: whether it prints on standard output.
        beside: what must be there: nothing, a `controller` on the network, or a served `robot` that `ctl` reaches.
        extras: modules that must be installed.
        needs_page: whether the front end must be built.
    """

    name: str
    words: tuple[str, ...]
    files: Mapping[str, File] = {}
    code: int = 0
    writes: tuple[str, ...] = ()
    changes: tuple[str, ...] = ()
    input: str = ""
    ends: Ends = "itself"
    may_be_endless: bool = False
    prints: bool = True
    beside: Beside = ""
    extras: tuple[str, ...] = ()
    needs_page: bool = False

    @property
    def command(self) -> str:
        """The command."""
        return self.words[0]


def _framed(*messages: Mapping[str, Any]) -> str:
    """Return messages as the protocols of editors frame them."""
    texts = [json.dumps(message) for message in messages]
    return "".join(f"Content-Length: {len(text)}\r\n\r\n{text}" for text in texts)


def _rpc(method: str, number: int | None = None, **params: Any) -> dict[str, Any]:
    head = {} if number is None else {"id": number}
    return {"jsonrpc": "2.0", **head, "method": method, "params": params}


LSP_SESSION: Final = _framed(
    _rpc("initialize", 1, processId=None, rootUri=None, capabilities={}),
    _rpc("initialized"),
    {"jsonrpc": "2.0", "id": 2, "method": "shutdown"},
    {"jsonrpc": "2.0", "method": "exit"},
)
DAP_SESSION: Final = _framed(
    {"seq": 1, "type": "request", "command": "initialize", "arguments": {"adapterID": "elitescript"}},
    {"seq": 2, "type": "request", "command": "disconnect", "arguments": {}},
)


@cache
def recording() -> bytes:
    """Return a recording of a run of `MOVES`, with the program in it."""
    from tempfile import TemporaryDirectory

    from elitescript.recorder.writing import write_recording
    from elitescript.records import replace
    from tests.audit.recording_runs import record_run

    with TemporaryDirectory() as folder:
        path = Path(folder, "run.mcap")
        write_recording(path, replace(record_run(MOVES + "moves()\n"), attachments={"moves.script": MOVES.encode()}))
        return path.read_bytes()


@cache
def journal() -> bytes:
    """Return the journal of a short session of `serve`."""
    from tempfile import TemporaryDirectory

    from elitescript.environment.memory import MemoryFiles
    from elitescript.kernel import RobotOptions
    from elitescript.messages.inputs import RunUnit
    from elitescript.services.journal.replay import RecordedRobot
    from elitescript.services.journal.writer import Journal

    with TemporaryDirectory() as folder:
        path = Path(folder, "a.journal")
        options = RobotOptions(power_on=True)
        writer = Journal(path, options)
        robot = RecordedRobot(options, MemoryFiles({}), writer)
        robot.tick([RunUnit("primary#1", "program", MOVES)])
        for _ in range(20):
            robot.tick()
        writer.close()
        return path.read_bytes()


def case() -> bytes:
    """Return a case of a sweep: `moves.script` is stopped in its move."""
    from elitescript.sweep.failures.cases import digest_of

    return f"""program = "moves.script"
digest = "{digest_of(MOVES)}"
seed = 5
[options]
model = "CS66"
[[stop]]
kind = "protective_stop"
at_s = 0.1
[expect]
property = "no_alarm"
state = "alarm"
line = 3
""".encode()


def points() -> bytes:
    """Return joints and poses of the CS66."""
    from elitescript.kinematics.transforms import pose_from_transform
    from elitescript.models.model import load_model

    joints = (
        (0.4, -1.3, -1.7, -1.4, 1.5, 0.2),
        (0.9, -1.0, -1.2, -2.0, 0.9, 1.0),
        (-0.3, -1.7, -1.1, -0.9, 2.0, -0.4),
        (0.1, -0.8, -2.0, -1.1, 1.2, 0.6),
    )
    arm = load_model("CS66").arm
    return json.dumps([{"q": q, "pose": list(pose_from_transform(arm.forward(q)))} for q in joints]).encode()


PROGRAM: Final[Mapping[str, File]] = {"moves.script": MOVES}
TASK: Final = """<EliTask name="cell" installationName="cell" robotType="CS66">
  <MainTask isTaskAlwaysLoops="false" hasInitVariables="false" typeName="Robot Main Task">
    <WaitNode type="WAIT_TIME" typeName="Wait"><waitTime value="0.5" unit="S"/></WaitNode>
  </MainTask>
</EliTask>"""
CALLS: Final = (
    Call("task", ("task", "cell.task"), {"cell.task": TASK}),
    Call("task --tree", ("task", "cell.task", "--tree"), {"cell.task": TASK}),
    Call("task --json", ("task", "cell.task", "--json"), {"cell.task": TASK}),
    Call(
        "task -o", ("task", "cell.task", "-o", "out.script"), {"cell.task": TASK}, writes=("out.script",), prints=False
    ),
    Call("task --new", ("task", "--new", "cell", "-o", "new.task"), writes=("new.task",), prints=False),
    Call("task script", ("task", "moves.script", "-o", "out.task"), PROGRAM, writes=("out.task",), prints=False),
    Call(
        "task --diff",
        ("task", "cell.task", "--diff", "other.task"),
        {"cell.task": TASK, "other.task": TASK.replace('"0.5"', '"0.7"')},
        1,
    ),
    Call("run", ("run", "moves.script"), PROGRAM, may_be_endless=True),
    Call("run alarm", ("run", "alarm.script"), {"alarm.script": ALARM}, 1, may_be_endless=True),
    Call("run broken", ("run", "broken.script"), {"broken.script": BROKEN}, 3, may_be_endless=True, prints=False),
    Call("run --json", ("run", "moves.script", "--json", "--until", "0.1"), PROGRAM, 4, may_be_endless=True),
    Call("run --trace", ("run", "moves.script", "--trace", "out.csv"), PROGRAM, 0, ("out.csv",), may_be_endless=True),
    Call("run --state", ("run", "moves.script", "--state", "s.json"), PROGRAM, 0, ("s.json",), may_be_endless=True),
    Call(
        "run --world",
        ("run", "moves.script", "--world", "cell.toml"),
        {"moves.script": MOVES, "cell.toml": WORLD},
        may_be_endless=True,
    ),
    Call(
        "run --case",
        ("run", "--case", "a.case.toml"),
        {"moves.script": MOVES, "a.case.toml": case},
        1,
        may_be_endless=True,
    ),
    Call("sweep", ("sweep", "moves.script", "--runs", "2", "--jobs", "1"), PROGRAM, may_be_endless=True),
    Call(
        "sweep --out",
        ("sweep", "moves.script", "--runs", "2", "--jobs", "1", "--out", "out.csv", "--json"),
        PROGRAM,
        0,
        ("out.csv",),
        may_be_endless=True,
    ),
    Call(
        "sweep --page",
        ("sweep", "moves.script", "--runs", "2", "--jobs", "1", "--page", "out.html"),
        PROGRAM,
        0,
        ("out.html",),
        may_be_endless=True,
        needs_page=True,
    ),
    Call(
        "sweep alarm",
        ("sweep", "alarm.script", "--runs", "2", "--jobs", "1", "--no-cases"),
        {"alarm.script": ALARM},
        1,
        may_be_endless=True,
    ),
    Call(
        "sweep --minimise",
        (
            *("sweep", "moves.script", "--minimise", "time_s", "--over", "standard_analog_in[0]=uniform(0,1)"),
            *("--runs", "2", "--jobs", "1"),
        ),
        PROGRAM,
        may_be_endless=True,
        extras=("optuna",),
    ),
    Call("check", ("check", "moves.script"), PROGRAM, prints=False),
    Call("check broken", ("check", "broken.script"), {"broken.script": BROKEN}, 3),
    Call("check json", ("check", "broken.script", "--format", "json"), {"broken.script": BROKEN}, 3),
    Call("check github", ("check", "broken.script", "--format", "github"), {"broken.script": BROKEN}, 3),
    Call("check sarif", ("check", "broken.script", "--format", "sarif"), {"broken.script": BROKEN}, 3),
    Call("check --fix", ("check", "moves.script", "--fix"), PROGRAM, changes=("moves.script",), prints=False),
    Call("check --explain", ("check", "--explain", "E303")),
    Call("check --reach", ("check", "moves.script", "--reach"), PROGRAM, prints=False),
    Call("check -", ("check", "-"), code=3, input=BROKEN),
    Call("fmt", ("fmt", "ugly.script"), {"ugly.script": UGLY}, changes=("ugly.script",), prints=False),
    Call("fmt broken", ("fmt", "broken.script"), {"broken.script": BROKEN}, 3, prints=False),
    Call("fmt --check", ("fmt", "ugly.script", "--check"), {"ugly.script": UGLY}, 1, prints=False),
    Call("fmt --diff", ("fmt", "ugly.script", "--diff"), {"ugly.script": UGLY}),
    Call("fmt -", ("fmt", "-"), input=UGLY),
    Call("plot", ("plot", "moves.script", "-o", "out.html"), PROGRAM, 0, ("out.html",), needs_page=True),
    Call(
        "plot alarm",
        ("plot", "alarm.script", "-o", "out.html"),
        {"alarm.script": ALARM},
        1,
        ("out.html",),
        needs_page=True,
    ),
    Call(
        "serve",
        ("serve", "--port", "all=0", "--in-process"),
        ends="signal",
        may_be_endless=True,
    ),
    Call("serve children", ("serve", "--port", "all=0"), ends="signal", may_be_endless=True),
    Call(
        "serve --journal",
        ("serve", "--port", "all=0", "--in-process", "--journal", "a.journal", "--json"),
        writes=("a.journal",),
        ends="signal",
        may_be_endless=True,
    ),
    Call("ctl", ("ctl", "get"), beside="robot"),
    Call("ctl help", ("ctl", "help")),
    Call(
        "devices",
        ("devices", "cell.toml", "--port", "5000=0"),
        {"cell.toml": WORLD},
        ends="signal",
        may_be_endless=True,
    ),
    Call("replay", ("replay", "a.journal"), {"a.journal": journal}),
    Call(
        "replay --trace",
        ("replay", "a.journal", "--trace", "out.csv"),
        {"a.journal": journal},
        0,
        ("out.csv",),
    ),
    Call("audit", ("audit", "run.mcap"), {"run.mcap": recording}, extras=("mcap",)),
    Call("audit --json", ("audit", "run.mcap", "--json"), {"run.mcap": recording}, extras=("mcap",)),
    Call(
        "audit --fit",
        ("audit", "run.mcap", "--fit", "arm.toml"),
        {"run.mcap": recording},
        0,
        ("arm.toml",),
        extras=("mcap",),
    ),
    Call(
        "audit --page",
        ("audit", "run.mcap", "--page", "out.html"),
        {"run.mcap": recording},
        0,
        ("out.html",),
        extras=("mcap",),
        needs_page=True,
    ),
    Call(
        "record",
        ("record", "--out", "out.mcap", "--for", "0.2"),
        writes=("out.mcap",),
        may_be_endless=True,
        beside="controller",
        extras=("mcap",),
    ),
    Call(
        "shadow",
        ("shadow", "--program", "moves.script", "--for", "0.2"),
        PROGRAM,
        may_be_endless=True,
        beside="controller",
    ),
    Call("dap", ("dap",), input=DAP_SESSION, ends="input", prints=False),
    Call("doctor", ("doctor", "--instance", "90")),
    Call("doctor --json", ("doctor", "--instance", "90", "--json")),
    Call("lsp", ("lsp",), input=LSP_SESSION, ends="input", prints=False, extras=("pygls",)),
    Call("mcp", ("mcp", "."), ends="input", prints=False, extras=("mcp",)),
    Call(
        "studio",
        ("studio", "moves.script", "--no-browser"),
        PROGRAM,
        ends="signal",
        may_be_endless=True,
        extras=("websockets",),
        needs_page=True,
    ),
    Call("fit", ("fit", "--pairs", "points.json"), {"points.json": points}),
    Call("fit --out", ("fit", "--pairs", "points.json", "--out", "a.toml"), {"points.json": points}, 0, ("a.toml",)),
    Call("commands", ("commands",)),
    Call("commands one", ("commands", "movej")),
    Call("commands --json", ("commands", "--json")),
    Call("completion", ("completion", "bash")),
)


def chosen(is_meant: Callable[[Call], object] = bool) -> list[Any]:
    """Return calls as parameters of a test; those that cannot be made here are left out with the reason."""
    return [pytest.param(call, id=call.name, marks=_skipping(call)) for call in CALLS if is_meant(call)]


def of(name: str) -> Call:
    """Return the call of a name."""
    return next(call for call in CALLS if call.name == name)


def _skipping(call: Call) -> list[Any]:
    missing = [name for name in call.extras if find_spec(name) is None]
    marks = [pytest.mark.skip(reason=f"needs {', '.join(missing)}")] if missing else []
    if call.needs_page and not page.is_built():
        marks.append(pytest.mark.skip(reason="needs the built page"))
    return marks


def prepare(call: Call, folder: Path) -> None:
    """Write the files of a call into a folder."""
    for name, what in call.files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(what.encode() if isinstance(what, str) else what())


def start(
    call: Call,
    folder: Path,
    more: Sequence[str] = (),
    *,
    python: Sequence[str] = (),
    environment: Mapping[str, str | None] | None = None,
    **options: Any,
) -> subprocess.Popen[bytes]:
    """Start a call as a process.

    Args:
        call: what to run.
        folder: where; see `prepare`.
        more: further arguments, such as those of `beside`.
        python: options of Python.
        environment: variables that are set, or taken away where they are None.
        options: of `Popen`; by default the three streams are pipes.
    """
    variables = {**os.environ, **(environment or {})}
    streams = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.PIPE)
    return subprocess.Popen(
        [sys.executable, "-P", *python, "-m", "elitescript", *call.words, *more],
        cwd=folder,
        env={name: value for name, value in variables.items() if value is not None},
        **{**streams, **options},
    )


def finish(call: Call, folder: Path, more: Sequence[str] = (), **options: Any) -> subprocess.CompletedProcess[bytes]:
    """Run a call to its end, with its input; one that a signal ends gets SIGTERM when it is ready."""
    process = start(call, folder, more, **options)
    try:
        ready = b""
        if call.ends == "signal":
            ready = await_ready(process)
            process.send_signal(signal.SIGTERM)
        out, err = process.communicate(None if process.stdin is None else call.input.encode(), timeout=LIMIT_S)
    finally:
        process.kill()
        process.wait()
    return subprocess.CompletedProcess(call.words, process.returncode, ready + (out or b""), err or b"")


def await_ready(process: subprocess.Popen[bytes]) -> bytes:
    """Read standard output until the line that says that the process is ready; return what was read."""
    assert process.stdout is not None
    read = b""
    while line := process.stdout.readline():
        read += line
        if line.startswith((b"ready", b'{"type":"ready"')):
            break
    return read


@contextmanager
def beside(call: Call, folder: Path) -> Iterator[list[str]]:
    """Serve what a call needs beside it while the body runs; yield the words that name it."""
    if call.beside == "controller":
        with _controller() as words:
            yield words
    elif call.beside == "robot":
        served = Call("robot", ("serve", "--port", "all=0", "--in-process", "--json"))
        process = start(served, folder)
        try:
            ready = json.loads(await_ready(process))
            yield ["--socket", ready["robots"][0]["ctl"]]
        finally:
            process.send_signal(signal.SIGTERM)
            process.communicate(timeout=LIMIT_S)
    else:
        yield []


@contextmanager
def _controller() -> Iterator[list[str]]:
    """Open the ports of a controller in a thread; yield the words that name them."""
    from tests.recorder.controller import HOST, FakeController, served, ticks

    words: list[str] = []
    ready = threading.Event()
    done: list[tuple[asyncio.AbstractEventLoop, asyncio.Event]] = []

    async def serve() -> None:
        async with served(FakeController(ticks(1.0, 300))) as target:
            end = asyncio.Event()
            done.append((asyncio.get_running_loop(), end))
            words.extend([HOST, *(f"--port={name}={number}" for name, number in target.ports.items())])
            ready.set()
            await end.wait()

    thread = threading.Thread(target=lambda: asyncio.run(serve()))
    thread.start()
    assert ready.wait(10.0)
    try:
        yield words
    finally:
        loop, end = done[0]
        loop.call_soon_threadsafe(end.set)
        thread.join()
