"""How much of a file a program reads at once, in every environment."""

from __future__ import annotations

import re
from io import BytesIO, TextIOWrapper
from pathlib import Path
from typing import Any

import pytest

from elitescript.environment.local import LocalFiles
from elitescript.environment.memory import MemoryEnvironment, MemoryFiles
from elitescript.runtime.environment import READ_MAX, Files
from elitescript.runtime.files import OpenFiles
from elitescript.services.child.remote_files import FileDesk, RemoteFiles


def environment(kind: str, folder: Path) -> Files:
    if kind == "in memory":
        return MemoryFiles({name: (folder / name).read_bytes() for name in ("fits", "larger")})
    local = LocalFiles(folder)
    return local if kind == "of this computer" else RemoteFiles(asked(FileDesk(local)))


def asked(desk: FileDesk) -> Any:
    def ask(question: list[Any]) -> list[Any]:
        if question[0] != "read":
            desk.new_tick()
        return desk.answer(question)

    return ask


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("task")
    for name, size in (("fits", READ_MAX), ("larger", READ_MAX + 1)):
        with (path / name).open("wb") as file:
            file.truncate(size)
    return path


@pytest.mark.parametrize("kind", ["in memory", "of this computer", "of another process"])
def test_a_whole_file_has_a_limit(kind: str, folder: Path) -> None:
    files = environment(kind, folder)
    with files.open("fits", "rb", None, None) as file:
        assert len(file.read()) == READ_MAX
    with files.open("larger", "rb", None, None) as file, pytest.raises(OSError, match="bytes") as found:
        file.read()
    assert found.value.errno == 27
    with files.open("larger", "rb", None, None) as file:
        file.seek(READ_MAX)
        assert file.read() == b"\0"


def test_a_served_robot_reads_so_much_in_one_tick(folder: Path) -> None:
    desk = FileDesk(LocalFiles(folder))
    handle = desk.answer(["open", "larger", "rb"])[1]
    piece = 1 << 18
    answers = [desk.answer(["read", handle, 0, piece])[0] for _ in range(READ_MAX // piece + 2)]
    assert answers == ["ok"] * (READ_MAX // piece + 1) + ["error"]
    desk.new_tick()
    assert desk.answer(["read", handle, 0, piece])[0] == "ok"
    desk.close()


class _Looks:
    """Counts where a tick may end."""

    def __init__(self) -> None:
        self.count = 0

    def __call__(self) -> None:
        self.count += 1


LONG = "é1\n" * 200_000
"""More than half a million characters."""


@pytest.mark.parametrize(
    ("mode", "use", "wanted"),
    [
        ("r", lambda file: file.read(), LONG),
        ("rb", lambda file: file.read(), LONG.encode()),
        ("r", lambda file: file.read(500_000), LONG[:500_000]),
        ("r+", lambda file: file.read(), LONG),
        ("r", lambda file: file.readlines(), LONG.splitlines(keepends=True)),
        ("rb", lambda file: file.readlines(3_000), LONG.encode().splitlines(keepends=True)[:751]),
        ("w", lambda file: file.write(LONG), len(LONG)),
        ("wb", lambda file: file.write(LONG.encode()), len(LONG.encode())),
        ("wb", lambda file: file.write(bytearray(LONG.encode())), len(LONG.encode())),
        ("w", lambda file: file.writelines([LONG, LONG]), None),
    ],
)
def test_a_tick_may_end_within_a_long_call(mode: str, use: Any, wanted: Any) -> None:
    looks = _Looks()
    environment = MemoryEnvironment({"long.txt": LONG.encode()})
    file = OpenFiles(environment, looks).open("long.txt", mode)
    assert use(file) == wanted
    file.close()
    assert looks.count >= (1 if 3_000 in use.__code__.co_consts else len(LONG) // 200_000)
    again = OpenFiles(environment).open("long.txt").read()
    assert again in (LONG, LONG + LONG)


@pytest.mark.parametrize("newline", [None, "", "\n", "\r", "\r\n"])
@pytest.mark.parametrize("mode", ["r", "r+", "rb"])
@pytest.mark.parametrize("size", [-1, 131_073])
def test_a_long_line_is_the_one_that_python_reads(newline: str | None, mode: str, size: int) -> None:
    text = b"".join(b"x" * (131_070 + n) + end for n in range(3) for end in (b"\r\n", b"\r", b"\n"))
    if "b" in mode:
        wanted: Any = BytesIO(text)
        given = None
    else:
        wanted, given = TextIOWrapper(BytesIO(text), "utf-8", newline=newline), newline
    file = OpenFiles(MemoryEnvironment({"t": text})).open("t", mode, newline=given)
    if mode == "r+" and newline is None:
        # Line ends of files that are changed are read by the product's own code, whose pieces are of no fixed size.
        wanted, size = TextIOWrapper(BytesIO(text), "utf-8"), -1
    for _ in range(20):
        assert file.readline(size) == wanted.readline(size)


def test_nothing_of_a_long_text_is_written_that_cannot_be_encoded() -> None:
    environment = MemoryEnvironment({})
    file = OpenFiles(environment).open("new.txt", "w")
    with pytest.raises(UnicodeEncodeError):
        file.write("x" * 300_000 + "\ud800")
    file.close()
    assert environment.files.contents["new.txt"] == b""


@pytest.mark.parametrize("call", ["read()", "readline()", "readlines()"])
def test_each_way_to_read_much_at_once_has_the_same_limit(call: str) -> None:
    line = b"x" * (1 << 20) + (b"" if call == "readline()" else b"\n")
    environment = MemoryEnvironment({"much.txt": line * 25})
    opened = OpenFiles(environment).open("much.txt")
    with pytest.raises(OSError, match=re.escape(f"{call} of more than {READ_MAX} bytes at once")):
        getattr(opened, call[:-2])()
