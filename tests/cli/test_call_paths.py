"""Paths of calls: the table of commands x situations, made from what the command line says of its arguments."""

from __future__ import annotations

import os
import re
import socket
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

import pytest

from elitescript.cli.arguments import COMMANDS
from elitescript.cli.call_paths import CLAIMED, READS, WRITES, outputs_of
from elitescript.cli.main import _parsed, main
from elitescript.cli.plain_call import PathArgument, PlainCall
from elitescript.page import MARK
from tests.cli.calls import CALLS, MOVES, WORLD

VALUES: Final = {
    "program": "moves.script",
    "program or trace": "moves.script",
    "task": "cell.task",
    "other task": "other.task",
    "compared": "other.script",
    "programs": "moves.script",
    "world": "cell.toml",
    "arm": "arm.toml",
    "case": "a.case.toml",
    "profile": "chaos.toml",
    "expression": "n=prop.py:ok",
    "recording": "run.mcap",
    "session": "a.journal",
    "points": "points.json",
    "urdf": "arm.urdf",
    "password": "@password",
}
"""A value of each kind of argument that reads a file."""
NOT_FILES: Final = ("folder", "device", "address", "elsewhere")
IN_PLACE: Final = ("programs", "edited")
"""What is read and written by design."""


def arguments(command: str) -> dict[str, PathArgument]:
    call = PlainCall()
    COMMANDS[command][1](call)
    return call.paths


def outputs() -> list[tuple[str, PathArgument]]:
    return [
        (command, argument)
        for command in COMMANDS
        for argument in arguments(command).values()
        if argument.writes and argument.writes not in IN_PLACE
    ]


def file_of(kind: str) -> str:
    return VALUES[kind].rpartition("=")[2].removesuffix(":ok").removeprefix("@")


def words(command: str, *given: tuple[str, str]) -> list[str]:
    """Return a call of a command with these options, and what else it needs."""
    base = next(call for call in CALLS if call.command == command)
    rest = list(base.words[1:])
    positionals: list[str] = []
    while rest and not rest[0].startswith("-"):
        positionals.append(rest.pop(0))
    rows = arguments(command).values()
    flags = [name for name, _ in given]
    if needs := [row for row in rows if not row.flag.startswith("-") and row.reads]:
        positionals = [VALUES.get(needs[0].reads, ".")]
    if command == "record" or command == "shadow":
        positionals = ["127.0.0.1"]
    if "--case" in flags:
        positionals = []
    options = [word for name, value in given if name.startswith("-") for word in (name, value)]
    return [command, *positionals, *(["--runs", "2"] if command == "sweep" else []), *options]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    texts = dict.fromkeys(map(file_of, VALUES), "x")
    texts |= {
        "moves.script": MOVES,
        "cell.toml": WORLD,
        "a.case.toml": "program = 'moves.script'\n[expect]\nproperty = 'no_alarm'\n",
    }
    for name, text in texts.items():
        (tmp_path / name).write_text(text)
    return tmp_path


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


def refusal(call: list[str], folder: Path, capsys: pytest.CaptureFixture[str]) -> str:
    """Run a call that must be refused; return what it says."""
    before = contents(folder)
    assert main(call) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert contents(folder) == before
    return said.err


# ---------------------------------------------------------------- the table


def test_every_argument_that_is_a_path_says_what_it_is() -> None:
    found: list[str] = []

    class Looker(PlainCall):
        def add_argument(self, *flags: str, reads: str = "", writes: str = "", **settings: Any) -> None:
            text = f"{settings.get('metavar') or ''} {settings.get('help')}"
            looks = r"FILE|OUT|DIR\b|FOLDER|PATH|DEVICE|\bOTHER\b|\.(toml|csv|html|mcap|json|py)\b|\bfile\b|\bpage\b"
            is_named = re.search(looks, text) and settings.get("action") not in ("store_true", "store_const")
            if is_named and not reads and not writes:
                found.append(f"{flags[0]}: {text}")

    for _, add_arguments in COMMANDS.values():
        add_arguments(Looker())
    harmless = ("--only", "--set", "--network", "--vary", "--over", "--run:", "--rotate", "--task-dir-limit")
    assert [row for row in found if not row.startswith(harmless)] == []


def test_every_kind_of_path_is_known() -> None:
    rows = [row for command in COMMANDS for row in arguments(command).values()]
    assert {row.reads for row in rows} - {""} == READS.keys()
    assert {row.writes for row in rows} - {""} == WRITES.keys()
    assert VALUES.keys() | set(NOT_FILES) == READS.keys()


def collisions() -> Iterator[Any]:
    for command, output in outputs():
        for row in arguments(command).values():
            if row.reads and row.reads not in NOT_FILES:
                yield pytest.param(command, output.flag, row, id=f"{command} {output.flag} {row.flag}")


@pytest.mark.parametrize(("command", "output", "read"), list(collisions()))
def test_an_output_is_no_input(
    command: str, output: str, read: PathArgument, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    name = file_of(read.reads)
    for value in (name, "symlink.html", "link.html"):
        if value == "symlink.html":
            Path(value).symlink_to(name)
        elif value == "link.html":
            os.link(name, value)
        said = refusal(words(command, (read.flag, VALUES[read.reads]), (output, value)), folder, capsys)
        assert f"{output} {value}" in said
        assert f"({read.flag} {VALUES[read.reads]})" in said


def test_paths_are_compared_and_not_names(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Path("other").symlink_to(folder)
    for value in (
        "./moves.script",
        f"../{folder.name}/moves.script",
        str(folder / "moves.script"),
        "other/moves.script",
    ):
        assert "this is the program" in refusal(["run", "moves.script", "--trace", value], folder, capsys)


def pairs() -> Iterator[Any]:
    for command, one in outputs():
        for row in arguments(command).values():
            if row.writes and row.writes not in IN_PLACE and row.flag != one.flag:
                yield pytest.param(command, one.flag, row.flag, id=f"{command} {one.flag} {row.flag}")


@pytest.mark.parametrize(("command", "one", "other"), list(pairs()))
def test_two_outputs_are_two_files(
    command: str, one: str, other: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("alias").symlink_to("out")
    for value in ("./out", "alias"):
        said = refusal(words(command, (one, "out"), (other, value)), folder, capsys)
        assert one in said
        assert other in said
        assert "same file" in said


CANNOT: Final = {
    "no/such/out": "there is no folder no/such",
    ".": "it is a folder, not a file",
    "out/": "this is the name of a folder",
    "moves.script/out": "there is no folder moves.script",
    "x" * 300: "File name too long",
    "round": "Too many levels of symbolic links",
    "socket": "it is a socket, not a file",
}


@pytest.mark.parametrize(("command", "output"), [pytest.param(*row, id=f"{row[0]} {row[1].flag}") for row in outputs()])
def test_what_cannot_be_written_is_refused_before_anything_runs(
    command: str, output: PathArgument, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("round").symlink_to("round")
    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind("socket")
        for value, why in CANNOT.items():
            said = refusal(words(command, (output.flag, value)), folder, capsys)
            assert f"{output.flag} {value}: {why}" in said


PAGES: Final = [(command, row.flag) for command, row in outputs() if row.writes.startswith("page")]


def test_pages_are_written_by_these() -> None:
    assert PAGES == [("sweep", "--page"), ("plot", "-o"), ("audit", "--page")]


@pytest.mark.parametrize(("command", "flag"), PAGES)
def test_a_page_replaces_pages_alone(
    command: str, flag: str, folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    Path("report.html").write_text("<html>mine</html>")
    call = words(command, (flag, "report.html"))
    assert "no page of elitescript" in refusal(call, folder, capsys)
    assert is_accepted([*call, "--force"])
    assert Path("report.html").read_text() == "<html>mine</html>"
    for text in ("", f"<!DOCTYPE html>\n<html>\n<head>\n{MARK}\n</head>", "<title>job · elitescript plot</title>"):
        Path("report.html").write_text(text, encoding="utf-8")
        assert is_accepted(call)
    assert "--force" in call or "this is the program" not in call


def is_accepted(call: list[str]) -> bool:
    """Return whether the paths of a call are right; nothing runs."""
    with outputs_of(_parsed(call)):
        return True


# ---------------------------------------------------------------- single cases


def test_what_a_world_file_names_is_read_too(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Path("kinds.py").write_text("")
    Path("own.toml").write_text('base = "CS66"\n')
    Path("cell.toml").write_text(
        '[robot]\nmodel = "own.toml"\n[[tcp]]\nname = "a"\nport = 5\nclass = "kinds.py:Camera"\n'
    )
    for name in ("kinds.py", "own.toml"):
        said = refusal(["run", "moves.script", "--world", "cell.toml", "--trace", name], folder, capsys)
        assert f"this is {name}, which the world file names (--world cell.toml)" in said


def test_what_a_case_names_is_read_too(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Path("a.case.toml").write_text(
        "program = 'moves.script'\nworld = 'cell.toml'\n[options]\nmodel = 'arm.toml'\n"
        "[expect]\nproperty = 'prop.py:ok'\n"
    )
    for name in ("moves.script", "cell.toml", "prop.py", "arm.toml"):
        said = refusal(["plot", "--case", "a.case.toml", "-o", name], folder, capsys)
        assert "(--case a.case.toml)" in said


def test_what_a_program_names_in_its_task_folder_is_no_output(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Path("moves.script").write_text(
        "# run --trace rows.csv\nimport os\ndef p():\n  f = open('/task/points.csv')\n"
        "  load_micro_line_file('line.csv')\n"
        "  os.remove('../out.csv')\n  os.remove('old.csv')\nend\n"
    )
    Path("tasks").mkdir()
    Path("points.csv").write_text("1,2\n")
    for call in (["run", "moves.script", "--trace"], ["sweep", "moves.script", "--runs", "2", "--out"]):
        for name in ("points.csv", "line.csv", "old.csv"):
            assert f"this is {name}, which the program names" in refusal([*call, name], folder, capsys)
            said = refusal([*call, f"tasks/{name}", "--task-dir", "tasks"], folder, capsys)
            assert f"this is {name}, which the program names" in said
            assert is_accepted([*call, f"tasks/{name}"])
        assert is_accepted([*call, "rows.csv"])
        assert is_accepted([*call, "out.csv"])


def test_files_beside_a_table_that_are_none_of_a_sweep_stay(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name in ("t.csv.part", "t.csv.sweep"):
        Path(name).write_text("mine")
        said = refusal(["sweep", "moves.script", "--runs", "1", "--out", "t.csv"], folder, capsys)
        assert f"{name} is there, and is none of a sweep" in said
        Path(name).unlink()


@pytest.mark.parametrize(
    ("call", "file"),
    [
        (["sweep", "moves.script", "--out", "t.csv", "--world", "t.csv.part"], "t.csv.part"),
        (["sweep", "moves.script", "--out", "t.csv", "--world", "t.csv.sweep"], "t.csv.sweep"),
        (["run", "moves.script", "--state", "s.json", "--world", "s.json.lock"], "s.json.lock"),
    ],
)
def test_what_stands_beside_an_output_is_an_output(
    call: list[str], file: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    Path(file).write_text("x")
    assert f"which writes {file} too: this is the world file" in refusal(call, folder, capsys)


def test_files_of_further_robots_are_outputs(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Path("day.1.journal").write_text("x")
    call = ["serve", "--robots", "2", "--journal", "day.journal", "--world", "day.1.journal"]
    assert "this is the world file" in refusal(call, folder, capsys)


def test_replays_of_a_sweep_are_pages(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    call = ["sweep", "moves.script", "--page", "out.html"]
    Path("out.replays").write_text("")
    assert "out.replays, and there is a file of this name" in refusal(call, folder, capsys)
    Path("out.replays").unlink()
    Path("out.replays").mkdir()
    Path("out.replays/run-3.html").write_text("mine")
    assert "no page of elitescript" in refusal(call, folder, capsys)
    assert is_accepted([*call, "--force"])
    assert "names" in refusal(["sweep", "moves.script", "--page", "CASE-3.case.toml"], folder, capsys)


def test_the_page_of_a_plot_has_the_name_of_the_program(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Path("moves.plot.html").write_text("mine")
    assert "-o moves.plot.html: it is no page of elitescript" in refusal(["plot", "moves.script"], folder, capsys)


def test_programs_are_changed_in_their_place_by_design(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    os.link("moves.script", "linked.script")
    assert is_accepted(["fmt", "moves.script", "linked.script", "moves.script"])
    assert is_accepted(["check", "--fix", "moves.script", "linked.script", "."])
    call = ["check", "--fix", "cell.toml", "--world", "cell.toml"]
    assert "FILE cell.toml: this is the world file (--world cell.toml)" in refusal(call, folder, capsys)


def test_devices_take_several_outputs(folder: Path) -> None:
    assert is_accepted(["audit", "run.mcap", "--page", "/dev/null", "--fit", "/dev/null"])


def test_pipes_may_be_outputs(folder: Path) -> None:
    os.mkfifo("pipe.csv")
    for call in (["run", "moves.script", "--trace", "pipe.csv"], ["plot", "moves.script", "-o", "pipe.csv"]):
        assert is_accepted(call)


def test_what_another_process_writes_is_refused(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for command, row in outputs():
        if row.writes in CLAIMED:
            call = words(command, (row.flag, "out.html"))
            with outputs_of(_parsed(call)):
                assert main(call) == 2
                assert f"{row.flag} out.html: another process writes it" in capsys.readouterr().err
            assert is_accepted(call)


def test_standard_output_is_an_output(folder: Path, capfd: pytest.CaptureFixture[str]) -> None:
    saved = os.dup(1)
    target = os.open("out.csv", os.O_WRONLY | os.O_CREAT)
    try:
        os.dup2(target, 1)
        code = main(["run", "moves.script", "--trace", "out.csv"])
    finally:
        os.dup2(saved, 1)
        os.close(saved)
        os.close(target)
    assert code == 2
    assert "--trace out.csv: standard output of this call goes to the same file" in capfd.readouterr().err
    assert Path("out.csv").read_bytes() == b""


def test_a_call_that_is_refused_leaves_nothing(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Path("bad.script").write_text("def p():\n  x = \nend\n")
    before = contents(folder)
    for call in (
        ["run", "bad.script", "--trace", "t.csv"],
        ["run", "moves.script", "--trace", "t.txt"],
        ["plot", "bad.script"],
        ["sweep", "bad.script", "--page", "p.html", "--no-cases"],
    ):
        assert main(call) in (2, 3)
        assert contents(folder) == before
