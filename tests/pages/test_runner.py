"""The runner of pages notices what is not as a page says."""

from __future__ import annotations

import shutil
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tests.pages.runner import PageError, check_call, matches, reason_not_to_run, run_page
from tools.pages import github_slug, read_page

Run = Callable[[str], int]


@pytest.fixture
def run(monkeypatch: pytest.MonkeyPatch) -> Iterator[Run]:
    folder = Path(tempfile.mkdtemp(prefix="page"))
    yield lambda text: run_page("page.md", text, folder, monkeypatch)
    shutil.rmtree(folder)


def block(info: str, text: str) -> str:
    return f"```{info}\n{text}\n```\n"


def is_running(number: str) -> bool:
    """Whether a process has not ended, as the system lists it; one that nobody waits for stays there as `Z`."""
    found = subprocess.run(["ps", "-o", "stat=", "-p", number], capture_output=True, text=True, check=False)
    return found.stdout.strip()[:1] not in ("", "Z")


class TestBlocks:
    @pytest.mark.parametrize(
        ("page", "message"),
        [
            (block("python", "assert 1 == 2"), None),
            (block("python", "def test_it():\n    assert False"), None),
            (block("elitescript", "def a():\n  movejj([0, 0, 0, 0, 0, 0])\nend"), "E301"),
            (block("elitescript", "def a():\n  x = 1 / 0\nend"), "ZeroDivisionError"),
            (block("elitescript error=E302", "def a():\n  sync()\nend"), "no E302"),
            (block('elitescript title="a.script"', "def a("), "page.md:1"),
            (block("toml", "a = "), None),
            (block("json", "{"), None),
            (block("sh", "false"), "exit code 1"),
            (block("console", "$ echo one\ntwo"), "the page shows"),
            (block("console", "no command"), "begins with"),
            (block("console", "$ elitescript run --no-such-option a.script"), "refuses"),
            (block("ruby", "puts 1"), "no such language: 'ruby'"),
            (block("", "text"), "no such language: ''"),
            (block("python titel=x", "pass"), "no word titel"),
            (block('text title="../a"', "x"), "outside"),
        ],
    )
    def test_a_block_that_is_wrong_fails(self, run: Run, page: str, message: str | None) -> None:
        with pytest.raises((PageError, AssertionError, ValueError), match=message):
            run(page)

    def test_blocks_share_a_folder_names_and_the_place_in_it(self, run: Run) -> None:
        page = (
            block('elitescript title="cell/a.script"', 'def a():\n  textmsg("hello")\nend')
            + block("console", "$ cd cell\n$ elitescript run a.script\n     0.000 s  hello\n...")
            + block("python", "text = __import__('pathlib').Path('a.script').read_text()")
            + block("python", "assert 'hello' in text\ndef test_it():\n    global was_called\n    was_called = True")
            + block("python", "assert was_called")
        )
        assert run(page) == 5

    def test_a_code_is_found_in_a_check_and_in_a_run(self, run: Run) -> None:
        page = block("elitescript error=E303", "def a():\n  movej([0, 0, 0, 0, 0, 0], vv=1)\nend")
        page += block("elitescript error=R100", "def a():\n  x = 1 / 0\nend")
        assert run(page) == 2

    def test_a_program_that_waits_is_only_checked(self, run: Run) -> None:
        assert run(block("elitescript only=check", "def a():\n  x = 1 / 0\nend")) == 1

    def test_an_exit_code_is_expected(self, run: Run) -> None:
        assert run(block("console exit=3", "$ exit 3")) == 1

    def test_the_home_of_a_page_is_its_own(self, run: Run) -> None:
        before = Path.home()
        assert run(block("sh", 'test -z "$(ls ~)"')) == 1
        assert Path.home() != before

    def test_another_exit_code_fails(self, run: Run) -> None:
        with pytest.raises(PageError, match="exit code 3, not 2"):
            run(block("console exit=2", "$ exit 3"))

    def test_what_a_page_leaves_in_the_background_ends_with_it(self, run: Run) -> None:
        assert run(block("sh", "sleep 60 > /dev/null 2>&1 & echo $! > pid")) == 1
        number = Path("pid").read_text(encoding="utf-8").strip()
        deadline = time.monotonic() + 5
        while is_running(number):
            assert time.monotonic() < deadline


class TestServe:
    def test_documented_ports_reach_the_served_robot(self, run: Run) -> None:
        page = block(
            "console", "$ elitescript serve\nready on 127.0.0.1: CS66: dashboard 29999, primary 30001, ...\n..."
        )
        client = (
            "import socket\n"
            "with socket.create_connection(('127.0.0.1', 29999), timeout=5) as connection:\n"
            "    assert connection.recv(100)\n"
        )
        page += block("python", client)
        page += block('python title="client.py"', client)
        page += block("sh", "python client.py\nelitescript ctl state")
        assert run(page) == 4

    def test_what_it_prints_is_compared_at_the_end(self, run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr("tests.pages.runner.OUTPUT_LIMIT_S", 0.1)
        with pytest.raises(PageError, match="the page shows"):
            run(block("console", "$ elitescript serve\nready on 127.0.0.1: CS612..."))


@pytest.mark.parametrize(
    ("expected", "found", "same"),
    [
        (["a"], ["a "], True),
        (["a"], ["a", "b"], False),
        (["a", "..."], ["a", "b", "c"], True),
        (["...", "c"], ["a", "b", "c"], True),
        (["a", "...", "c"], ["a", "c"], True),
        (["at ... s"], ["at 1.2 s"], True),
        (["at ... s"], ["at 1.2 m"], False),
        (["a.c"], ["abc"], False),
    ],
)
def test_what_counts_as_the_output_of_a_page(expected: list[str], found: list[str], same: bool) -> None:
    assert matches(expected, found) is same


def test_a_command_in_the_table_of_exceptions_has_a_reason() -> None:
    assert reason_not_to_run("mbpoll -0 127.0.0.1") is not None
    assert reason_not_to_run("elitescript run a.script") is None


def test_a_call_is_judged_up_to_a_pipe() -> None:
    check_call("elitescript run a.script --until 3 | tail -n 1", "here")
    check_call("elitescript serve --robots 3 > log.txt", "here")


PAGE = """\
# One, two

`[code](nowhere.md)` and [a link](a.md#b) and ![a picture](b.svg)

## `get_it` and [more](c.md)

## One, two

- an item

      not code of its own

text

    code

```sh title="a b"
echo [x](d.md)
    indented
```

[name]: e.md
<a id="by-hand" href="f.md"></a>
"""


class TestReading:
    def test_links(self) -> None:
        assert [link.target for link in read_page(PAGE).links()] == ["a.md#b", "b.svg", "c.md", "e.md", "f.md"]
        assert all(PAGE[link.start :].startswith(link.target) for link in read_page(PAGE).links())

    def test_anchors_are_those_of_github(self) -> None:
        assert read_page(PAGE).anchors() == {"one-two", "one-two-1", "get_it-and-more", "by-hand"}
        assert github_slug("R100: the arm's `limit`") == "r100-the-arms-limit"

    def test_blocks(self) -> None:
        (block,) = read_page(PAGE).blocks
        assert (block.line, block.language, block.words) == (17, "sh", {"title": "a b"})
        assert block.text == "echo [x](d.md)\n    indented\n"

    def test_indented_code(self) -> None:
        assert read_page(PAGE).indented_code() == [15]

    def test_a_block_without_end(self) -> None:
        with pytest.raises(ValueError, match="line 2: a block that is not closed"):
            read_page("a\n```sh\nb\n")
