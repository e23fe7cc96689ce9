"""What cannot be script, and how it is counted."""

from __future__ import annotations

import pytest

from elitescript.protocol.garbage import REPORT_TICKS, GarbageBurst, is_garbage, is_statement


@pytest.mark.parametrize(
    "line", ["\0", "x = '\0'", "\x16\x03\x01", "\x7f", "\ufffdx", "a\x01\ufffd", "GET / HTTP/1.1", "SSH-2.0-x"]
)
def test_garbage(line: str) -> None:
    assert is_garbage(line)


@pytest.mark.parametrize(
    "line", ["halt()", "x", "textmsg('\x1b[0m')", "textmsg('Gr\ufffd\ufffde')", "\tx = 1", "", "  ", "GET = 1", ")"]
)
def test_what_may_be_script(line: str) -> None:
    assert not is_garbage(line)


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("halt()", True),
        ("x = 1", True),
        ("x: int = 1", False),
        ("User-Agent: curl (Linux)", False),
        ("Accept: */*", False),
        ("x", False),
        ("f(\x01)", False),
    ],
)
def test_in_the_middle_of_garbage_a_statement_calls_or_assigns(line: str, expected: bool) -> None:
    assert is_statement(line) is expected
    burst = GarbageBurst()
    assert not burst.takes(line)
    burst.add("\0", 1)
    assert burst.takes(line) is not expected


def test_a_burst_counts_and_begins_anew() -> None:
    burst = GarbageBurst()
    assert burst.is_empty
    burst.add("\0" * 20, 5)
    burst.add("ab", 6)
    assert not burst.is_due(5 + REPORT_TICKS - 1)
    assert burst.is_due(5 + REPORT_TICKS)
    text = burst.take("primary#1")
    assert text.startswith("primary#1 sent 22 characters in 2 lines that are no script, beginning with ")
    assert text.count("\\x00") == 16
    assert burst.is_empty
    assert not burst.is_due(10**6)
