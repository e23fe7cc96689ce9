"""How much of a file a program reads at once, in every environment."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from elitescript.environment.local import LocalFiles
from elitescript.environment.memory import MemoryFiles
from elitescript.runtime.environment import READ_MAX, Files
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
