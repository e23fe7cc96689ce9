"""Everything that pages show as code is run, or stands in a table with the reason why not."""

from __future__ import annotations

import re
import shutil
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.pages.not_run import CHECKED_ELSEWHERE, NOT_RUN
from tests.pages.runner import commands_of, run_page
from tools.pages import ROOT, read_page

PAGES = sorted([*ROOT.glob("README*.md"), *(ROOT / "docs").rglob("*.md")])
NAMES = [path.relative_to(ROOT).as_posix() for path in PAGES]


@pytest.fixture
def folder() -> Iterator[Path]:
    """A folder with a short path: the control socket of `serve` lies in it."""
    path = Path(tempfile.mkdtemp(prefix="page"))
    yield path
    shutil.rmtree(path)


@pytest.mark.skipif(sys.platform == "win32", reason="the commands of pages are for a POSIX shell")
@pytest.mark.parametrize("name", [name for name in NAMES if name not in CHECKED_ELSEWHERE])
def test_the_blocks_of_a_page_do_what_it_says(name: str, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run_page(name, (ROOT / name).read_text(encoding="utf-8"), folder, monkeypatch)


@pytest.mark.parametrize("name", NAMES)
def test_code_is_fenced_so_that_it_is_run(name: str) -> None:
    lines = read_page((ROOT / name).read_text(encoding="utf-8")).indented_code()
    assert lines == [], f"{name}: code that is indented instead of fenced"


def test_every_exception_is_needed() -> None:
    texts = [path.read_text(encoding="utf-8") for path in PAGES]
    commands = [command for text in texts for block in read_page(text).blocks for command in commands_of(block)]
    unused = [pattern for pattern in NOT_RUN if not any(re.fullmatch(pattern, command) for command in commands)]
    assert unused == []
    assert [name for name in CHECKED_ELSEWHERE if name not in NAMES] == []
