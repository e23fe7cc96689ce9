"""Programs that are compiled in a process of their own: what comes back, and what may go wrong with that process."""

from __future__ import annotations

import asyncio
import os
import subprocess
import sys
import time
from collections.abc import Awaitable, Callable
from pathlib import Path
from types import CodeType
from typing import Any

import pytest

from elitescript.codec.values import CodecError
from elitescript.environment.memory import MemoryFiles
from elitescript.environment.request_channels import RequestEnvironment
from elitescript.kernel import Kernel, RobotOptions
from elitescript.kernel.arm import model_of
from elitescript.kernel.compiling import Job, compiled_job, tree_text
from elitescript.language.limits import LINES_MAX
from elitescript.language.text.source import SourceFile
from elitescript.lint.engine import CheckResult
from elitescript.messages.events import Alarm, TextMessage
from elitescript.messages.inputs import Compiled, Input, RunUnit
from elitescript.messages.profile import DEFAULT_FIRMWARE, profile
from elitescript.models.model import load_model
from elitescript.records import replace
from elitescript.services.child import frames
from elitescript.services.child.link import ChildLink
from elitescript.services.compiler import desk as compiler_desk
from elitescript.services.compiler import packing
from elitescript.services.compiler.desk import CODE_MAX, JOB_MAX, CompilerDesk
from elitescript.services.compiler.jobs import job_bytes, portion, read_job
from elitescript.services.compiler.loading import Loading
from elitescript.services.compiler.packing import END, LENGTH, VALUES, packed
from elitescript.services.compiler.remote import RemoteWorkshop
from elitescript.services.debugging import debugging
from elitescript.services.journal.replay import Replay
from elitescript.services.journal.writer import Journal, JournalReader

TEXT = (
    """
def big(depth=2):
  global total
  total = 0
  def inner(n):
    for i in range(n):
      total = i
      if i in {1, 2, 3}:
        textmsg("point", (1.0, 2, "x", None, True, ...), b"y", 2j)
      end
    end
    return lambda: n
  end
"""
    + "".join(f"  x{n} = [{n}, {n}.5, 'n{n}']\n  f{n} = lambda a, b={n}: a + b\n" for n in range(150))
    + """
  undefined_name
  inner(3)
  textmsg("big runs")
end
"""
)


def names_in(code: CodeType) -> list[tuple[str, str]]:
    inner = [names_in(value) for value in code.co_consts if isinstance(value, CodeType)]
    return [(code.co_filename, code.co_qualname), *(pair for pairs in inner for pair in pairs)]


def job(text: str = TEXT, number: int = 7, kind: str | None = "program") -> Job:
    return Job(number, "<primary#1>", text, kind, False, "attach", 100, ("preset",))


def compiled(text: str = TEXT, kind: str | None = "program"):
    return compiled_job(job(text, kind=kind), profile(DEFAULT_FIRMWARE), model_of(RobotOptions()), frozenset())


@pytest.fixture(scope="module")
def whole() -> CheckResult:
    return compiled()


@pytest.mark.parametrize("size", [1, 977, 1 << 20])
def test_what_comes_back_is_what_was_compiled(size, whole):
    assert whole.unit is not None
    loading = Loading(SourceFile("<primary#1>", TEXT))
    data = b"".join(packed(whole))
    for at in range(0, len(data), size):
        assert loading.result is None
        loading.feed(data[at : at + size])
    assert loading.result is not None
    unit = loading.result.unit
    assert unit is not None
    assert unit.code == whole.unit.code
    assert names_in(unit.code) == names_in(whole.unit.code)
    assert (unit.kind, unit.name, unit.source, unit.global_names) == (
        "program",
        "big",
        whole.unit.source,
        whole.unit.global_names,
    )
    assert tuple(unit.statements) == tuple(whole.unit.statements)
    assert (unit.probes.first, unit.probes.size, unit.probes.functions) == (
        100,
        whole.unit.probes.size,
        whole.unit.probes.functions,
    )
    assert loading.result.problems == tuple(replace(problem, fix=None) for problem in whole.problems)
    assert {problem.code for problem in whole.problems} == {"W201", "W202"}


def test_no_piece_is_large_but_the_code_of_a_function(whole, monkeypatch):
    monkeypatch.setattr(packing, "PIECE_BYTES", 1000)
    pieces = list(packed(whole))
    assert len(pieces) > 30
    body = max(pieces, key=len)
    assert body[LENGTH.size : LENGTH.size + 1] == packing.FUNCTION
    assert all(len(piece) < 2500 for piece in pieces if piece[LENGTH.size : LENGTH.size + 1] == VALUES)


def test_what_does_not_compile_comes_back_with_its_findings():
    whole = compiled("def a():\n  x = (\nend\n")
    loading = Loading(SourceFile("<primary#1>", ""))
    loading.feed(b"".join(packed(whole)))
    assert loading.result is not None
    assert loading.result.unit is None
    assert loading.result.problems == whole.problems
    assert loading.result.is_refused


@pytest.mark.parametrize(
    "data",
    [
        LENGTH.pack(2) + b"?" + b"N",
        LENGTH.pack(4) + VALUES + b"(((",
        LENGTH.pack(1) + END,
    ],
)
def test_what_is_no_program_gives_no_result(data):
    loading = Loading(SourceFile("x", ""))
    with pytest.raises((ValueError, EOFError, TypeError)):
        loading.feed(data)
    assert loading.result is None


def test_jobs_survive_the_way():
    for text in ("", "x\ny\n", "é\ud800\0", '{"a": "\\n"}'):
        assert read_job(job_bytes(job(text))) == job(text)


def test_the_parent_never_loads_code():
    """What makes objects of bytes is imported by the process of the robot and by the compiler, and by nothing else."""
    names = ("elitescript.services.compiler.loading", "elitescript.services.compiler.packing")
    code = f"import sys, elitescript.cli.serve; print([name for name in {names} if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"


# ---------------------------------------------------------------- the parent's desk


def with_desk(body: Callable[[CompilerDesk], Awaitable[None]], **options) -> None:
    async def run() -> None:
        desk = CompilerDesk(RobotOptions(), is_jailed=True, **options)
        try:
            await body(desk)
        finally:
            await desk.close()

    asyncio.run(run())


async def outcome(desk: CompilerDesk) -> tuple[bytes, Compiled]:
    """What goes to the robot in the end."""
    data = b""
    while True:
        content, inputs = desk.step()
        data += b"" if content is None else frames.split_number(content)[1]
        if inputs:
            return data, inputs[0]
        await asyncio.sleep(0.004)


def test_a_compiler_sends_the_program_and_ends():
    async def body(desk: CompilerDesk) -> None:
        data = job_bytes(job())
        desk.take_text(portion(7, data[:1000], False))
        pid = desk.pid
        desk.take_text(portion(7, data[1000:], True))
        code, back = await outcome(desk)
        assert back == Compiled("compiler", 7)
        assert not desk.is_active
        loading = Loading(SourceFile("<primary#1>", TEXT))
        loading.feed(code)
        assert loading.result is not None
        assert loading.result.unit is not None
        assert loading.result.unit.name == "big"
        while Path(f"/proc/{pid}").exists():
            await asyncio.sleep(0.01)

    with_desk(body)


def test_a_killed_compiler_refuses_the_text():
    async def body(desk: CompilerDesk) -> None:
        desk.take_text(portion(7, b"x", False))
        os.kill(desk.pid, 9)
        _, back = await outcome(desk)
        assert back.failure == "the process that compiles it has failed: it has ended (killed by signal 9)" or (
            back.failure.startswith("the process that compiles it has failed: it is gone")
        )
        assert not desk.is_active

    with_desk(body)


def test_one_that_takes_too_long_is_ended(monkeypatch):
    monkeypatch.setattr(compiler_desk, "START_S", 0.0)
    monkeypatch.setattr(compiler_desk, "compile_s", lambda size: 0.001)

    async def body(desk: CompilerDesk) -> None:
        data = job_bytes(job())
        desk.take_text(portion(7, data, True))
        _, back = await outcome(desk)
        assert back.failure.startswith(f"a text of {len(data):,} bytes was not compiled within")

    with_desk(body)


def test_what_has_too_many_lines_is_refused_with_their_number_and_the_limit():
    async def body(desk: CompilerDesk) -> None:
        text = "def a():\n" + "  x = 1\n" * 210_000 + "end"
        data = job_bytes(job(text))
        began_s = time.process_time()
        desk.take_text(portion(7, data, True))
        code, back = await outcome(desk)
        assert time.process_time() - began_s < 2.0
        assert back == Compiled("compiler", 7)
        loading = Loading(SourceFile("<primary#1>", text))
        loading.feed(code)
        assert loading.result is not None
        assert f"the program has 210,002 lines, at most {LINES_MAX:,} are read" in loading.result.problems[0].text

    with_desk(body)


class TestHostile:
    """Neither of the two processes can do more than end what it has asked for."""

    def test_a_second_text_before_the_first_has_come_back(self):
        async def body(desk: CompilerDesk) -> None:
            desk.take_text(portion(1, b"x", False))
            with pytest.raises(CodecError, match="before the one before"):
                desk.take_text(portion(2, b"x", False))
            desk.take_text(portion(1, b"x", True))
            with pytest.raises(CodecError, match="before the one before"):
                desk.take_text(portion(1, b"x", True))

        with_desk(body)

    def test_a_text_without_end(self):
        async def body(desk: CompilerDesk) -> None:
            with pytest.raises(CodecError, match=f"more than {JOB_MAX} bytes"):
                for _ in range(JOB_MAX // (1 << 20) + 2):
                    desk.take_text(portion(1, bytes(1 << 20), False))

        with_desk(body)

    def test_no_number(self):
        async def body(desk: CompilerDesk) -> None:
            for content in (b"", b"1234567"):
                with pytest.raises(CodecError):
                    desk.take_text(content)
                with pytest.raises(CodecError):
                    desk.drop(content)

        with_desk(body)

    def answering(self, letter: str, content: bytes, count: int = 1) -> str:
        """What is said of a compiler that sends this."""

        async def body(desk: CompilerDesk) -> None:
            desk.take_text(portion(1, b"x", False))
            assert desk._job is not None
            for _ in range(count):
                desk._job._message(letter, content)
            said.append(desk._job.failure())

        said: list[str] = []
        with_desk(body)
        return said[0]

    def test_code_without_end(self):
        assert "more than a program" in self.answering(frames.CODE, bytes(1 << 20), CODE_MAX // (1 << 20) + 1)

    def test_another_message(self):
        assert "it has sent a message 'Q'" in self.answering(frames.QUESTION, b"[]")

    def test_a_reason_that_is_no_text(self):
        assert "\ufffd" in self.answering(frames.FAILED, b"\xff" * 100_000)
        assert len(self.answering(frames.FAILED, b"\xff" * 100_000)) < 9000


# ---------------------------------------------------------------- the whole way


async def ticks(link: ChildLink, inputs: tuple[Input, ...] = (), count: int = 10_000, until: str = "") -> list[str]:
    """What is said in some ticks, by the wall clock; the last one in which `until` was said."""
    said: list[str] = []
    for at in range(count):
        output = await link.tick(inputs if at == 0 else ())
        said += [event.text for event in output.events if isinstance(event, TextMessage | Alarm)]
        if until in said:
            return said
        await asyncio.sleep(0.004)
    return said


def linked(body: Callable[[ChildLink], Awaitable[None]], journal: Journal | None = None) -> None:
    async def run() -> None:
        options = RobotOptions(power_on=True, compiles_elsewhere=True)
        link = ChildLink(options, journal=journal)
        await link.open()
        try:
            await body(link)
        finally:
            await link.close()

    asyncio.run(run())


PROGRAM = TEXT.replace("\n  undefined_name", "").strip()


def test_runs_in_the_robot_and_a_replay_of_the_journal_is_equal(tmp_path):
    path = tmp_path / "a.journal"
    options = RobotOptions(power_on=True, compiles_elsewhere=True)

    async def body(link: ChildLink) -> None:
        await ticks(link, count=2)
        said = await ticks(link, (RunUnit("primary#1", "program", PROGRAM),), until="big runs")
        assert said[-1] == "big runs"
        await ticks(link, count=3)

    linked(body, Journal(path, options))
    replay = Replay(JournalReader(path))
    texts = [event.text for output in replay.outputs() for event in output.events if isinstance(event, TextMessage)]
    assert "big runs" in texts
    assert replay.difference is None


def test_a_robot_that_ends_meanwhile_takes_its_compiler_with_it_and_says_so():
    async def body(link: ChildLink) -> None:
        await ticks(link, count=2)
        await ticks(link, (RunUnit("primary#1", "program", PROGRAM),), count=1)
        while not link._compilers.is_active:
            await link.tick(())
            await asyncio.sleep(0.004)
        os.kill(link.pid, 9)
        texts: list[str] = []
        while "the program that was being compiled does not begin: the controller was restarted" not in texts:
            texts += [getattr(event, "text", "") for event in (await link.tick(())).events]
            await asyncio.sleep(0.004)
        assert not link._compilers.is_active

    linked(body)


@pytest.mark.slow
def test_no_step_of_the_robot_takes_as_long_as_a_stop_may():
    """50,000 lines, 400 kB: processor time of each step of the robot's process, with what is around it."""
    sent: list[bytes] = []

    class Line:
        def send(self, letter: str, content: bytes) -> None:
            sent.append(content)

    def step(work: Callable[..., Any], *arguments: object) -> Any:
        began_s = time.thread_time()
        given = work(*arguments)
        steps.append(time.thread_time() - began_s)
        return given

    steps: list[float] = []
    workshop = RemoteWorkshop(Line())  # type: ignore[arg-type]
    options = RobotOptions(power_on=True, compiles_elsewhere=True)
    environment = RequestEnvironment(MemoryFiles({}))
    kernel = Kernel(options, environment, debugging=debugging(), workshop=workshop)
    kernel.tick()
    text = "def big():\n" + "  a = 1\n" * 50_000 + "  textmsg('big runs')\nend"
    step(kernel.tick, (RunUnit("primary#1", "program", text),))
    for _ in range(10):
        step(workshop.pump)
        step(kernel.tick)
    data = b"".join(packed(compiled(text)))
    for at in range(0, len(data), 128 * 1024):
        step(workshop.code, frames.numbered(1, data[at : at + 128 * 1024]))
        step(kernel.tick)
    events = step(kernel.tick, (Compiled("compiler", 1),)).events
    assert "big runs" in [event.text for event in events if isinstance(event, TextMessage)]
    assert max(steps) < 0.02


def test_the_script_of_a_tree_comes_back_with_its_nodes() -> None:
    text = tree_text({"a.task": b'<EliTask name="a"><MainTask><HaltNode/></MainTask></EliTask>', "b": b"\xff"})
    job = Job(1, "a.task", text, None, False, "", 0, (), True)
    whole = compiled_job(job, profile(DEFAULT_FIRMWARE), load_model("CS66"), frozenset())
    loading = Loading(SourceFile("a.task", ""))
    loading.feed(b"".join(packed(whole)))
    assert loading.result is not None
    assert loading.result.unit is not None
    assert whole.unit is not None
    source = loading.result.unit.source
    assert (source.text, source.places) == (whole.unit.source.text, whole.unit.source.places)
    assert "1 Robot Main Task > 2 Halt" in source.places
