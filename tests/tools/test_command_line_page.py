"""The page of the command line has every command and option, with its value and default."""

from __future__ import annotations

import pytest

from tools.command_line_page import command_line_page

PAGE = command_line_page()


@pytest.mark.parametrize(
    "line",
    [
        "| [`check`](#check) | report every problem of programs without running them |",
        "## run",
        "- `--until SECONDS`: stop after so much virtual time",
        "- `--strict`: refuse what only warns otherwise",
        "- `--firmware {2.10,2.14}`: controller firmware (default 2.14)",
        "- `-o OUT.html`, `--output OUT.html`: the page (default: NAME.plot.html, in this folder)",
        r"- `FILE`: programs, folders (every \*.script in them), or - for standard input",
    ],
)
def test_the_page_has_the_line(line: str) -> None:
    assert line in PAGE.splitlines()


def test_help_itself_is_no_option_of_the_page() -> None:
    assert "`--help`" not in PAGE
