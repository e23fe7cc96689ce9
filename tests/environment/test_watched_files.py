"""A command is run again when a file that it reads has changed, however an editor saves it."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from subprocess import TimeoutExpired
from typing import Any

import pytest

from elitescript.environment.watched_files import MISSING_S, QUIET_S, Rounds, files_below


class Command:
    """A command that ends when a test says so, or is ended."""

    def __init__(self, code: int | None) -> None:
        self.code = code
        self.asked: list[str] = []

    def poll(self) -> int | None:
        return self.code

    def wait(self, timeout: float | None = None) -> int:
        if self.code is None:
            raise TimeoutExpired("command", timeout or 0.0)
        return self.code

    def terminate(self) -> None:
        self.asked.append("terminate")
        self.code = -15

    def kill(self) -> None:
        self.asked.append("kill")


class Bench:
    """Rounds whose pauses are the steps of a test: each acts in its turn, the last one is Ctrl-C."""

    def __init__(self, folder: Path, codes: list[int | None], steps: list[Callable[[], None] | None], **options: Any):
        self.files = {folder / "cell.script": False, folder / "data.csv": True, folder / "cell.toml": False}
        for path in self.files:
            path.write_text("a")
        self.commands: list[Command] = []
        self._codes = codes
        self._steps = steps
        self.paused_s: list[float] = []
        self.rounds = Rounds(self._start, lambda: self.files, "test", pause=self._pause, **options)

    def _start(self) -> Command:
        self.commands.append(Command(self._codes[len(self.commands)]))
        return self.commands[-1]

    def _pause(self, seconds: float) -> None:
        self.paused_s.append(seconds)
        if not self._steps:
            raise KeyboardInterrupt
        if (step := self._steps.pop(0)) is not None:
            step()

    def run(self) -> int:
        """Return how many commands were started until Ctrl-C."""
        with pytest.raises(KeyboardInterrupt):
            self.rounds.run()
        return len(self.commands)


def writes(path: Path, text: str) -> Callable[[], None]:
    return lambda: path.write_text(text) and None  # type: ignore[func-returns-value]


def renames(path: Path, text: str) -> Callable[[], None]:
    """Save as editors do that rename: the old file goes away, the new one takes its name."""

    def save() -> None:
        new = path.with_name("new~")
        new.write_text(text)
        new.replace(path)

    return save


def said(capsys: pytest.CaptureFixture[str]) -> list[str]:
    out, err = capsys.readouterr()
    assert out == "", "nothing is cleared where standard output is no terminal"
    return err.splitlines()


@pytest.mark.parametrize("save", [writes, renames])
def test_a_change_runs_it_again(tmp_path, capsys, save):
    bench = Bench(tmp_path, [3, 0], [None, save(tmp_path / "cell.script", "bb"), None, None, None])
    assert bench.run() == 2
    lines = said(capsys)
    assert lines[0] == "test: exit code 3; a change of 3 files runs it again, Ctrl-C ends it"
    assert lines[1] == "test: cell.script changed"


def test_the_same_size_and_time_in_another_file_is_a_change(tmp_path):
    path = tmp_path / "cell.script"

    def swap() -> None:
        before = path.stat()
        renames(path, "b")()
        os.utime(path, ns=(before.st_atime_ns, before.st_mtime_ns))

    assert Bench(tmp_path, [0, 0], [swap, None, None, None]).run() == 2


def test_a_burst_is_one_change(tmp_path, capsys):
    steps = [
        writes(tmp_path / name, text)
        for name, text in (("cell.script", "1"), ("cell.toml", "22"), ("cell.script", "333"))
    ]
    bench = Bench(tmp_path, [0, 0], [*steps, None, None])
    assert bench.run() == 2
    assert bench.paused_s[1] == QUIET_S
    assert said(capsys)[1] == "test: cell.script, cell.toml changed"


def test_a_file_that_an_editor_takes_away_for_a_moment_is_waited_for(tmp_path):
    path = tmp_path / "cell.script"
    bench = Bench(tmp_path, [0, 0], [path.unlink, None, None, writes(path, "new"), None, None])
    assert bench.run() == 2
    assert path.read_text() == "new"


def test_a_file_that_does_not_come_back_is_a_change(tmp_path):
    bench = Bench(tmp_path, [0, 2], [(tmp_path / "cell.script").unlink, *[None] * round(MISSING_S / QUIET_S), None])
    assert bench.run() == 2


def test_nothing_runs_again_when_nothing_changes(tmp_path):
    assert Bench(tmp_path, [0], [None] * 5).run() == 1


def test_a_new_file_counts(tmp_path):
    bench = Bench(tmp_path, [0, 0], [])
    bench._steps = [
        lambda: bench.files.update({tmp_path / "cell.script": False, Path(__file__): False}),
        None,
        None,
        None,
    ]
    assert bench.run() == 2


def test_a_command_that_runs_is_ended_by_a_change_of_what_it_reads(tmp_path, capsys):
    bench = Bench(tmp_path, [None, 0], [None, writes(tmp_path / "cell.toml", "bb"), None, None])
    assert bench.run() == 2
    assert bench.commands[0].asked == ["terminate"]
    assert said(capsys)[0] == "test: cell.toml changed"


def test_what_the_command_itself_may_write_does_not_end_it_and_does_not_run_it_again(tmp_path):
    bench = Bench(tmp_path, [None], [])

    def end() -> None:
        bench.commands[0].code = 0

    bench._steps = [writes(tmp_path / "data.csv", "bb"), end, None, None]
    assert bench.run() == 1
    assert bench.commands[0].asked == []


def test_data_that_changes_afterwards_runs_it_again(tmp_path):
    assert Bench(tmp_path, [0, 0], [writes(tmp_path / "data.csv", "bb"), None, None, None]).run() == 2


def test_a_change_meanwhile_runs_it_again_when_it_has_ended_but_not_for_ever(tmp_path, capsys):
    bench = Bench(tmp_path, [None] * 3, [], is_ended_by_change=False)

    def write_and_end(text: str) -> Callable[[], None]:
        def act() -> None:
            (tmp_path / "cell.script").write_text(text)
            bench.commands[-1].code = 0

        return act

    bench._steps = [write_and_end("1"), write_and_end("22"), write_and_end("333"), None]
    assert bench.run() == 3
    assert "test: cell.script: the command itself changes it" in said(capsys)
    assert all(command.asked == [] for command in bench.commands)


def test_ctrl_c_waits_for_the_command_and_ends_one_that_goes_on(tmp_path):
    bench = Bench(tmp_path, [None], [])
    assert bench.run() == 1
    assert bench.commands[0].asked == ["terminate"]


@pytest.mark.parametrize("code", [141, -13])
def test_a_command_whose_reader_has_gone_ends_it(tmp_path, code):
    assert Bench(tmp_path, [code], []).rounds.run() == 141


def test_files_below_folders(tmp_path):
    for name in ("a.py", "b.txt", ".git/c.py", "left/d.py", "in/e.py"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text("")
    found = files_below([tmp_path], lambda name: name.endswith(".py"), lambda name: name == "left")
    assert sorted(path.name for path in found) == ["a.py", "e.py"]
