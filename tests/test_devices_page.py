"""What docs/devices.md and the docstrings of the public devices show is run here."""

from __future__ import annotations

import doctest
import importlib
import re
from pathlib import Path

import pytest

from elitescript.testing import world as public
from elitescript.world_file import load_world_file

PAGE = Path(__file__).resolve().parent.parent / "docs" / "devices.md"
TEXT = PAGE.read_text(encoding="utf-8")
CODE = re.findall(r"```python\n(.*?)```", TEXT, re.DOTALL)
FILES = re.findall(r"```toml\n(.*?)```", TEXT, re.DOTALL)


def test_the_code_of_the_page_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(PAGE.parent.parent)
    names: dict[str, object] = {"__name__": "page"}
    for block in CODE:
        exec(compile(block, str(PAGE), "exec"), names)
    tests = [value for name, value in names.items() if name.startswith("test_")]
    assert len(tests) == 4
    for test in tests:
        assert callable(test)
        test()


def test_the_first_device_of_the_page_has_ten_lines_at_most() -> None:
    camera = re.search(r"class Camera.*?\n\n\n", CODE[0], re.DOTALL)
    assert camera is not None
    imports = [line for line in CODE[0].splitlines() if line.startswith("from")]
    assert len([line for line in camera.group().splitlines() if line] + imports) <= 10


@pytest.mark.parametrize("text", FILES)
def test_the_world_file_of_the_page_is_read(text: str, tmp_path: Path) -> None:
    path = tmp_path / "cell.toml"
    path.write_text(text, encoding="utf-8")
    world = load_world_file(path).world
    assert world is not None
    assert [device.title for device in world.devices if device.name == "camera"] == ["camera"]


@pytest.mark.parametrize("name", [name for name in public.__all__ if ">>>" in (getattr(public, name).__doc__ or "")])
def test_the_example_of_a_docstring_is_true(name: str) -> None:
    found = getattr(public, name)
    module = importlib.import_module(found.__module__)
    (example,) = (test for test in doctest.DocTestFinder(recurse=False).find(found, name, module, globs={}))
    result = doctest.DocTestRunner(verbose=False).run(example)
    assert result.attempted > 0
    assert result.failed == 0


def test_every_public_device_has_an_example() -> None:
    silent = {"DeviceError", "RpcFault", "TcpConnection", "load_world"}
    assert {name for name in public.__all__ if ">>>" not in (getattr(public, name).__doc__ or "")} <= silent
