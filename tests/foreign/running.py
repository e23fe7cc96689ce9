"""Runs programs on a virtual robot and by CPython itself, each in a process of its own with bounded time and memory."""

from __future__ import annotations
import __future__

import ast
import builtins
import contextlib
import gc
import importlib
import io
import json
import os
import resource
import selectors
import signal
import subprocess
import sys
import time
import traceback
from collections.abc import Callable, Iterable, Iterator
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from elitescript.run import Run

FILE: Final = "foreign.script"
ROBOT_S: Final = 900.0
"""Robot time of a program."""
CPU_S: Final = 20
WALL_S: Final = 40.0
MEMORY_BYTES: Final = 1 << 30
ANSWER_BYTES_MAX: Final = 8 << 20


@dataclass(slots=True)
class Outcome:
    """What came of a program.

    Attributes:
        end: `passed`, `failed`, `error`, `skipped`; `refused` before it runs; `stuck` at the limit of robot time;
            `late`, `crash` and `internal` are those of the process.
        kind: class of the exception, or code of the refusal.
        text: its text.
        line: where it ended; 0 if nowhere.
        notes: operands of the assertions, in their order.
        cpu_s: processor time of the run without its compilation, s.
    """

    end: str
    kind: str = ""
    text: str = ""
    line: int = 0
    notes: list[list[str]] = field(default_factory=list)
    cpu_s: float = field(default=0.0, compare=False)


def on_python(text: str) -> Outcome:
    """Run a program as the body of a function of CPython."""
    try:
        code = _as_function(text)
    except SyntaxError as error:
        return Outcome("refused", type(error).__name__, str(error.msg), error.lineno or 0)
    names: dict[str, Any] = {"__name__": "__main__", "__builtins__": builtins, "textmsg": lambda *parts: None}
    raised: BaseException | None = None
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        began_s = time.process_time()
        try:
            exec(code, names)
            names["main"]()
        except BaseException as error:
            raised = error
        cpu_s = time.process_time() - began_s
    line = 0
    if raised is not None:
        lines = [n for frame, n in traceback.walk_tb(raised.__traceback__) if frame.f_code.co_filename == FILE]
        line = lines[-1] if lines else 0
    outcome = _outcome(names, raised, line)
    outcome.cpu_s = cpu_s
    return outcome


def _as_function(text: str) -> Any:
    tree = ast.parse(text, FILE)
    flags = 0
    body = tree.body
    if isinstance(body[0], ast.ImportFrom) and body[0].module == "__future__":
        flags, body = __future__.annotations.compiler_flag, body[1:]
    main = ast.parse("def main(): pass").body[0]
    assert isinstance(main, ast.FunctionDef)
    main.body = body
    return compile(ast.Module([main], []), FILE, "exec", flags, dont_inherit=True)


def _outcome(names: dict[str, Any], raised: BaseException | None, line: int) -> Outcome:
    ends = names.get("foreign_end") or []
    notes = list(names.get("foreign_notes") or [])
    if ends:
        end, kind, text = ends[-1]
        return Outcome(end, kind, text, line if end in ("failed", "error") else 0, notes)
    if raised is None:
        return Outcome("error", "", "the test did not end", 0, notes)
    return Outcome("error", type(raised).__name__, str(raised), line, notes)


def on_robot(text: str) -> Outcome:
    """Run a program on a virtual robot."""
    from elitescript import VirtualRobot
    from elitescript.errors import ProgramError

    robot = VirtualRobot(network="none")
    try:
        unit = robot.compile(text)
    except ProgramError as error:
        first = next((each for each in error.problems if each.code != "E115"), error.problems[0])
        return Outcome("refused", first.code, first.text, first.line)
    began_s = time.process_time()
    run = robot.run(unit, until_s=ROBOT_S)
    outcome = _outcome_of(run)
    outcome.cpu_s = time.process_time() - began_s
    return outcome


def _outcome_of(run: Run) -> Outcome:
    names = dict(run.globals)
    if run.state == "alarm":
        alarm = run.alarms[0]
        found = _outcome(names, None, alarm.line)
        if names.get("foreign_end"):
            return found
        return Outcome("error", alarm.class_name, alarm.text, alarm.line, found.notes)
    if run.state == "time_limit":
        return Outcome("stuck", "", run.why or "", 0, _outcome(names, None, 0).notes)
    return _outcome(names, None, 0)


def on_fresh_python(text: str) -> Outcome:
    """Run a program by CPython in a process that is no fork, with another seed of hashes, other addresses and times."""
    call = [sys.executable, "-m", "tests.foreign", "--again"]
    environment = {**os.environ, "PYTHONHASHSEED": "random"}
    ended = subprocess.run(call, input=text.encode(), env=environment, capture_output=True, timeout=WALL_S)
    return Outcome(**json.loads(ended.stdout))


SIDES: Final[dict[str, Callable[[str], Outcome]]] = {
    "python": on_python,
    "robot": on_robot,
    "fresh": on_fresh_python,
}


def warm_up() -> None:
    """Load what programs need, once for all forks."""
    modules = (
        "collections contextlib dataclasses datetime decimal enum fractions functools itertools json math operator"
    )
    names = f"{modules} random re statistics string struct textwrap threading typing".split()
    program = "".join(f"import {name}\n" for name in names) + "global foreign_end\nforeign_end = [['passed', '', '']]\n"
    for name in names:
        importlib.import_module(name)
    for text in (program, "raise ValueError(1)\n"):
        on_python(text)
        on_robot(text)
    gc.collect()
    gc.freeze()


@dataclass(slots=True)
class _Child:
    key: Any
    pid: int
    reader: int
    due_s: float
    answer: bytearray = field(default_factory=bytearray)


def run_all(
    jobs: Iterable[tuple[Any, str, str]], width: int, cpu_s: int = CPU_S, wall_s: float = WALL_S
) -> Iterator[tuple[Any, Outcome]]:
    """Run programs side by side, each in a fork of this process; yield the outcomes as they come.

    Args:
        jobs: key, side and text of each.
        width: how many run at once.
        cpu_s, wall_s: bounds of each.
    """
    sys.stdout.flush()
    sys.stderr.flush()
    pending = iter(jobs)
    children: dict[int, _Child] = {}
    with selectors.DefaultSelector() as selector:
        is_more = True
        while children or is_more:
            while is_more and len(children) < width:
                job = next(pending, None)
                if job is None:
                    is_more = False
                    break
                child = _started(*job, cpu_s, wall_s)
                children[child.reader] = child
                selector.register(child.reader, selectors.EVENT_READ)
            for event, _ in selector.select(0.2) if children else ():
                child = children[event.fd]
                part = os.read(child.reader, 1 << 16)
                child.answer += part
                if not part or len(child.answer) > ANSWER_BYTES_MAX:
                    selector.unregister(child.reader)
                    del children[child.reader]
                    yield child.key, _ended(child)
            now_s = time.monotonic()
            for child in [child for child in children.values() if child.due_s < now_s]:
                selector.unregister(child.reader)
                del children[child.reader]
                child.answer.clear()
                yield child.key, _ended(child, is_late=True)


def _started(key: Any, side: str, text: str, cpu_s: int, wall_s: float) -> _Child:
    reader, writer = os.pipe()
    pid = os.fork()
    if pid == 0:
        try:
            os.close(reader)
            os.setpgid(0, 0)
            _bound(cpu_s)
            answer = _answer(SIDES[side], text)
            with os.fdopen(writer, "wb") as out:
                out.write(json.dumps(asdict(answer)).encode("ascii"))
        finally:
            os._exit(0)
    os.close(writer)
    return _Child(key, pid, reader, time.monotonic() + wall_s)


def _answer(side: Callable[[str], Outcome], text: str) -> Outcome:
    try:
        return side(text)
    except BaseException as error:
        last = traceback.extract_tb(error.__traceback__)[-1]
        where = f"{Path(last.filename).name}:{last.name}"
        return Outcome("internal", type(error).__name__, f"{error} ({where})")


def _bound(cpu_s: int) -> None:
    """Bound time, memory and files of this process; what it would print goes nowhere."""
    resource.setrlimit(resource.RLIMIT_CPU, (cpu_s, cpu_s + 2))
    if sys.platform == "linux":
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_FSIZE, (MEMORY_BYTES, MEMORY_BYTES))
    nowhere = os.open(os.devnull, os.O_RDWR)
    for number in (0, 1, 2):
        os.dup2(nowhere, number)


def _ended(child: _Child, *, is_late: bool = False) -> Outcome:
    os.close(child.reader)
    with contextlib.suppress(ProcessLookupError, PermissionError):
        os.killpg(child.pid, signal.SIGKILL)
    _, status = os.waitpid(child.pid, 0)
    if child.answer:
        try:
            return Outcome(**json.loads(child.answer))
        except (ValueError, TypeError):
            return Outcome("crash", "", "its answer cannot be read")
    if is_late or (os.WIFSIGNALED(status) and os.WTERMSIG(status) in (signal.SIGXCPU, signal.SIGKILL)):
        return Outcome("late")
    number = os.WTERMSIG(status) if os.WIFSIGNALED(status) else 0
    return Outcome("crash", signal.Signals(number).name if number else "", "the process ended without an answer")
