"""Programs of robots write no files that start programs elsewhere."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from elitescript.environment.local import LocalFiles
from elitescript.environment.memory import MemoryFiles
from elitescript.errors import ScriptPermissionError
from elitescript.runtime.environment import Files

REFUSED = [
    *(".bashrc", ".git/hooks/pre-commit", "sub/.vscode/tasks.json", "conftest.py", "sitecustomize.py", "sub/a.pth"),
    *("CONFTEST.PY", "a.py.", "a.py ", "a.py::$DATA", "Makefile", "pyproject.toml", "package.json", "run.sh", "x.so"),
    *("a.bat", "camera.Py", "sub/pytest.ini", "x.pyc"),
]
ALLOWED = ["log.txt", "a.b.csv", "points.json", "sub/path.txt", "program.script", "a", "py", "notes.pyx.txt", "中.txt"]


@pytest.fixture(params=["of this computer", "in memory"])
def files(request: pytest.FixtureRequest, tmp_path: Path) -> Files:
    if request.param == "in memory":
        return MemoryFiles({"sub/kept.txt": b"", ".git/hooks/x": b"", "sub/.vscode/x": b"", "device.py": b"1"})
    (tmp_path / ".git" / "hooks").mkdir(parents=True)
    (tmp_path / "sub" / ".vscode").mkdir(parents=True)
    (tmp_path / "device.py").write_bytes(b"1")
    return LocalFiles(tmp_path)


@pytest.mark.parametrize("name", REFUSED)
@pytest.mark.parametrize("mode", ["wb", "ab", "xb", "rb+"])
def test_is_not_written(files: Files, name: str, mode: str) -> None:
    with pytest.raises((ScriptPermissionError, FileNotFoundError)) as found:
        files.open(name, mode, None, None)
    if "r" not in mode:
        assert found.type is ScriptPermissionError
        assert found.value.code == "R123"
        assert "programs of robots write no" in str(found.value)


@pytest.mark.parametrize("name", ALLOWED)
def test_is_written(files: Files, name: str) -> None:
    with files.open(name, "wb", None, None) as file:
        file.write(b"x")
    assert files.size(name) == 1
    files.remove(name)


def test_what_is_there_is_read_and_not_changed(files: Files) -> None:
    with files.open("device.py", "rb", None, None) as file:
        assert file.read() == b"1"
    with pytest.raises(ScriptPermissionError):
        files.open("device.py", "rb+", None, None)
    with pytest.raises(ScriptPermissionError):
        files.remove("device.py")
    with pytest.raises(ScriptPermissionError):
        files.make_folder(".ssh")


@pytest.mark.skipif(os.name == "nt", reason="links need rights")
def test_links_do_not_lead_there(tmp_path: Path) -> None:
    root = tmp_path / "task"
    (root / ".git").mkdir(parents=True)
    (root / ".git" / "config").write_bytes(b"")
    (root / "log.txt").symlink_to(".git/config")
    (root / "folder").symlink_to(".git")
    (tmp_path / "outside").write_bytes(b"kept")
    (root / "hard.txt").hardlink_to(tmp_path / "outside")
    files = LocalFiles(root)
    for name in ("log.txt", "folder/new", "hard.txt"):
        with pytest.raises(ScriptPermissionError):
            files.open(name, "wb", None, None)
    with pytest.raises(ScriptPermissionError, match="another name too"):
        files.remove("hard.txt")
    with files.open("hard.txt", "rb", None, None) as file:
        assert file.read() == b"kept"
    assert (tmp_path / "outside").read_bytes() == b"kept"
