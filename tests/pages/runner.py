"""Run the blocks of a page in its order, in one folder, as a reader would; CONTRIBUTING.md has the rules of blocks."""

from __future__ import annotations

import contextlib
import json
import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
import threading
import time
import tomllib
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Final

import pytest

from elitescript import VirtualRobot
from elitescript.cli import main as command_line
from elitescript.language.text.source import SourceFile
from elitescript.lint.engine import check_source
from elitescript.messages.events import Warned
from elitescript.messages.profile import DEFAULT_FIRMWARE, profile
from tests.pages import not_run, redirect
from tools.pages import ROOT, Block, read_page

SOME: Final = "..."
"""Stands for any text in a line of an output; alone in a line, for any number of lines."""

COMMAND_LIMIT_S: Final = 40
READY_LIMIT_S: Final = 20
OUTPUT_LIMIT_S: Final = 5
ROBOT_LIMIT_S: Final = 60.0
"""Robot time that a program without end gets."""

NO_CODE: Final = frozenset({"text", "yaml", "cpp", "cmake", "lua", "make", "csv", "diff", "ini", "mermaid", "xml"})
"""Languages of blocks that are not ours to run."""

WORDS: Final[dict[str, frozenset[str]]] = {
    "python": frozenset({"title", "not-run"}),
    "elitescript": frozenset({"title", "only", "error"}),
    "toml": frozenset({"title"}),
    "json": frozenset({"title"}),
    "console": frozenset({"exit"}),
    "sh": frozenset(),
    **dict.fromkeys(NO_CODE, frozenset({"title"})),
}
"""The languages of blocks and the words that each may have."""

DOCUMENTED: Final = {
    "dashboard": 29999,
    "primary": 30001,
    "secondary": 30002,
    "realtime": 30003,
    "readonly": 30011,
    "rtsi": 30004,
    "interpreter": 30020,
    "query": 40011,
    "modbus": 502,
}


class PageError(AssertionError):
    """A block of a page that does not do what the page says."""


class Served:
    """A robot that a page serves, on free ports, from its command to the end of the page."""

    def __init__(self, command: str, cwd: Path, environment: dict[str, str]) -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-m", *shlex.split(command), "--port", "all=0"],
            cwd=cwd,
            env=environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        self.lines: list[str] = []
        self.ports: dict[int, int] = {}
        self._is_ready = threading.Event()
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()
        if not self._is_ready.wait(READY_LIMIT_S) or not self.ports:
            self.stop()
            raise PageError(f"{command} is not ready: {self.lines}")

    def _read(self) -> None:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            if line.startswith("ready on "):
                for name, number in DOCUMENTED.items():
                    found = re.search(rf"\b{name} (\d+)", line)
                    if found is not None:
                        self.ports[number] = int(found.group(1))
                        line = line.replace(found.group(), f"{name} {number}")
            self.lines.append(line.rstrip("\n"))
            if line.startswith("ready on "):
                self._is_ready.set()
        self._is_ready.set()

    def check(self, expected: list[str], place: str) -> None:
        """Wait until the output is what the page shows."""
        deadline = time.monotonic() + OUTPUT_LIMIT_S
        while not matches(expected, self.lines) and time.monotonic() < deadline:
            time.sleep(0.05)
        compare(expected, self.lines, place)

    def stop(self) -> None:
        """End it as Ctrl-C does."""
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGINT)
            try:
                self.process.wait(READY_LIMIT_S)
            except subprocess.TimeoutExpired:
                self.process.kill()
                self.process.wait()
        self._reader.join()
        assert self.process.stdout is not None
        self.process.stdout.close()


class PageRunner:
    """Runs the blocks of one page.

    Args:
        name: of the page, for messages.
        folder: empty; the current folder of the blocks. Its path is short enough for sockets.
        monkeypatch: takes back what the page changes in this process.
    """

    def __init__(self, name: str, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        self.name = name
        self.folder = folder / "page"
        self.cwd = self.folder
        self._ports_file = folder / "ports.json"
        self._cwd_file = folder / "cwd"
        self._module = ModuleType("page")
        self._served: list[tuple[Served, list[str], str]] = []
        self._background: list[int] = []
        shutil.copytree(ROOT / "examples", self.folder / "examples")
        hook = folder / "hook"
        hook.mkdir()
        (hook / "sitecustomize.py").write_text(
            Path(redirect.__file__).read_text(encoding="utf-8") + "\n\ninstall()\n", encoding="utf-8"
        )
        home = folder / "home"
        home.mkdir()
        monkeypatch.setenv("HOME", str(home))
        monkeypatch.setenv(redirect.PORTS_FILE, str(self._ports_file))
        monkeypatch.setattr("socket.socket.connect", redirect.connect)
        monkeypatch.setattr("socket.socket.connect_ex", redirect.connect_ex)
        monkeypatch.setitem(sys.modules, "page", self._module)
        monkeypatch.chdir(self.folder)
        self._environment = {
            **{name: value for name, value in os.environ.items() if not name.startswith(("PYTEST_", "COV_"))},
            "PATH": os.pathsep.join((str(Path(sys.executable).parent), os.environ.get("PATH", ""))),
            "PYTHONPATH": os.pathsep.join((str(hook), str(ROOT / "src"))),
            "XDG_RUNTIME_DIR": str(folder),
            "NO_COLOR": "1",
            "COLUMNS": "80",
            "PYTHONDONTWRITEBYTECODE": "1",
            # As in an environment with no other plugin; that ours is found there, tests/pytest_plugin tests.
            "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1",
            "PYTEST_PLUGINS": "elitescript.pytest_plugin.plugin",
        }

    def run(self, block: Block) -> None:
        """Do what the language of a block asks for.

        Raises:
            PageError: what the block does is not what the page says.
        """
        place = f"{self.name}:{block.line}"
        if block.language not in WORDS:
            raise PageError(f"{place}: no such language: {block.language!r}; there are {', '.join(sorted(WORDS))}")
        unknown = set(block.words) - WORDS[block.language]
        if unknown:
            raise PageError(f"{place}: {block.language} has no word {', '.join(sorted(unknown))}")
        title = block.words.get("title")
        if title is not None:
            self._write(title, block, place)
        runners: dict[str, Callable[[Block, str], None]] = {
            "python": self._python,
            "elitescript": self._program,
            "toml": self._toml,
            "json": self._json,
            "console": self._console,
            "sh": self._shell,
        }
        if block.language in runners:
            runners[block.language](block, place)

    def close(self) -> None:
        """Compare the output of what is served with what the page shows, and end all that is left."""
        try:
            for served, expected, place in self._served:
                served.check(expected, place)
        finally:
            for group in self._background:
                with contextlib.suppress(ProcessLookupError):
                    os.killpg(group, signal.SIGKILL)
            for served, _, _ in self._served:
                served.stop()

    def _write(self, title: str, block: Block, place: str) -> None:
        path = (self.cwd / title).resolve()
        if not path.is_relative_to(self.folder.resolve()):
            raise PageError(f"{place}: {title} is outside the folder of the page")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(block.text, encoding="utf-8")

    def _python(self, block: Block, place: str) -> None:
        code = compile("\n" * block.line + block.text, self.name, "exec", dont_inherit=True)
        if "title" in block.words or "not-run" in block.words:
            return
        names = vars(self._module)
        before = dict(names)
        exec(code, names)
        for name, value in list(names.items()):
            if name.startswith("test_") and before.get(name) is not value:
                value()

    def _program(self, block: Block, place: str) -> None:
        source = SourceFile(block.words.get("title", self.name), block.text)
        findings = {problem.code: problem for problem in check_source(source, profile(DEFAULT_FIRMWARE))}
        wanted = block.words.get("error")
        errors = [str(problem) for problem in findings.values() if problem.severity == "error"]
        if wanted is None and errors:
            raise PageError(f"{place}: {errors}")
        if wanted in findings:
            return
        if wanted is None and ("title" in block.words or block.words.get("only") == "check"):
            return
        run = VirtualRobot("CS66", task_dir=self.cwd).run(block.text, until_s=ROBOT_LIMIT_S)
        alarms = {alarm.code: str(alarm) for alarm in run.alarms}
        warned = {event.code for event in run.events if isinstance(event, Warned)}
        if wanted is None and alarms:
            raise PageError(f"{place}: {list(alarms.values())}")
        if wanted is not None and wanted not in alarms.keys() | warned:
            raise PageError(f"{place}: no {wanted}, but {sorted(findings.keys() | alarms.keys() | warned)}")

    def _toml(self, block: Block, place: str) -> None:
        tomllib.loads(block.text)

    def _json(self, block: Block, place: str) -> None:
        try:
            json.loads(block.text)
        except ValueError:
            for line in block.text.splitlines():
                json.loads(line)

    def _shell(self, block: Block, place: str) -> None:
        for command in block.text.replace("\\\n", " ").splitlines():
            if command.strip() and not command.startswith("#"):
                self._command(command, [], place, 0)

    def _console(self, block: Block, place: str) -> None:
        calls: list[tuple[str, list[str]]] = []
        for line in block.text.splitlines():
            if line.startswith("$ "):
                calls.append((line[2:], []))
            elif calls:
                calls[-1][1].append(line)
            else:
                raise PageError(f"{place}: a console block begins with `$ ` and a command")
        for index, (command, expected) in enumerate(calls):
            is_last = index == len(calls) - 1
            self._command(command, expected, place, int(block.words.get("exit", "0")) if is_last else 0)

    def _command(self, command: str, expected: list[str], place: str, exit_code: int) -> None:
        place = f"{place}: {command}"
        if command.startswith("elitescript "):
            check_call(command, place)
        if reason_not_to_run(command) is not None:
            return
        if re.match(r"elitescript serve\b", command):
            served = Served(command, self.cwd, self._environment | {"PYTHONPATH": str(ROOT / "src")})
            self._served.append((served, expected, place))
            self._ports_file.write_text(json.dumps(served.ports), encoding="utf-8")
            return
        code, output = self._run(f"trap 'pwd > {self._cwd_file}' EXIT\n{command}\n", place)
        if code != exit_code:
            raise PageError(f"{place}: exit code {code}, not {exit_code}\n{output}")
        if expected:
            compare(expected, output.splitlines(), place)
        self.cwd = Path(self._cwd_file.read_text(encoding="utf-8").strip())
        os.chdir(self.cwd)

    def _run(self, script: str, place: str) -> tuple[int, str]:
        # In a session of its own, so that a command that does not end takes its children with it.
        process = subprocess.Popen(
            ["sh", "-c", script],
            cwd=self.cwd,
            env=self._environment,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,
        )
        if re.search(r"(?<![&>])&(?![&\d])", script):
            self._background.append(process.pid)
        with process:
            try:
                output, _ = process.communicate(timeout=COMMAND_LIMIT_S)
            except subprocess.TimeoutExpired as late:
                os.killpg(process.pid, signal.SIGKILL)
                raise PageError(f"{place}: no end after {COMMAND_LIMIT_S} s") from late
        return process.returncode, output


def check_call(command: str, place: str) -> None:
    """Let the parser of the command line judge the options of a call, up to a redirection or pipe.

    Raises:
        PageError: it refuses them.
    """
    words = shlex.split(command, comments=True)[1:]
    ends = [index for index, word in enumerate(words) if word in ("|", ">", "<", "&&", ";", "&", "2>", "||", ">>")]
    try:
        command_line._parsed(words[: ends[0]] if ends else words)
    except SystemExit as end:
        if end.code:
            raise PageError(f"{place}: the command line refuses it") from end


def reason_not_to_run(command: str) -> str | None:
    """Find the reason for which a command is not run; None if it is."""
    return next((reason for pattern, reason in not_run.NOT_RUN.items() if re.fullmatch(pattern, command)), None)


def matches(expected: list[str], found: list[str]) -> bool:
    """Whether an output is what a page shows; `SOME` stands for any text, or any lines."""
    pattern = ""
    for line in trimmed(expected):
        if line.strip() == SOME:
            pattern += r"(?:[^\n]*\n)*?"
        else:
            pattern += r"[^\n]*".join(re.escape(part) for part in line.split(SOME)) + r"\n"
    return re.fullmatch(pattern, "".join(f"{line}\n" for line in trimmed(found))) is not None


def trimmed(lines: list[str]) -> list[str]:
    """Take away blanks at the ends of lines, and empty lines at the end."""
    text = "\n".join(line.rstrip() for line in lines).rstrip("\n")
    return text.split("\n") if text else []


def compare(expected: list[str], found: list[str], place: str) -> None:
    """Compare an output with what a page shows.

    Raises:
        PageError: they differ.
    """
    if not matches(expected, found):
        raise PageError(f"{place}\n--- the page shows\n" + "\n".join(expected) + "\n--- it is\n" + "\n".join(found))


def run_page(name: str, text: str, folder: Path, monkeypatch: pytest.MonkeyPatch) -> int:
    """Run all blocks of a page; return how many there are."""
    blocks = read_page(text).blocks
    runner = PageRunner(name, folder, monkeypatch)
    try:
        for block in blocks:
            runner.run(block)
    finally:
        runner.close()
    return len(blocks)


def commands_of(block: Block) -> list[str]:
    """List the commands of a console or shell block."""
    if block.language == "sh":
        return [line for line in block.text.replace("\\\n", " ").splitlines() if line.strip()]
    if block.language == "console":
        return [line[2:] for line in block.text.splitlines() if line.startswith("$ ")]
    return []
