"""What the docstrings of the public devices show is run here; tests/pages runs docs/how-to/devices.md."""

from __future__ import annotations

import doctest
import importlib
import re

import pytest

from elitescript.testing import world as public
from tools.pages import ROOT, read_page

PAGE = ROOT / "docs" / "how-to" / "devices.md"


def test_the_first_device_of_the_page_has_ten_lines_at_most() -> None:
    code = next(
        block.text for block in read_page(PAGE.read_text(encoding="utf-8")).blocks if block.language == "python"
    )
    camera = re.search(r"class Camera.*?\n\n\n", code, re.DOTALL)
    assert camera is not None
    imports = [line for line in code.splitlines() if line.startswith("from")]
    assert len([line for line in camera.group().splitlines() if line] + imports) <= 10


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
