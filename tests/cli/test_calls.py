"""Every command has a call in the table that others are made from, and each of these works."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import pytest

from elitescript.cli.arguments import COMMANDS
from tests.cli.calls import CALLS, Call, beside, chosen, finish, prepare


def test_every_command_has_a_call() -> None:
    without = COMMANDS.keys() - {call.command for call in CALLS}
    assert not without, f"tests/cli/calls.py has no call of {sorted(without)}"
    assert {call.command for call in CALLS} <= COMMANDS.keys()


def test_names_are_unique_and_begin_with_the_command() -> None:
    assert [name for name, count in Counter(call.name for call in CALLS).items() if count > 1] == []
    assert [call.name for call in CALLS if call.name.split()[0] != call.command] == []


def test_what_is_changed_is_there_before_and_what_is_written_is_not() -> None:
    for call in CALLS:
        assert set(call.changes) <= call.files.keys(), call.name
        assert not set(call.writes) & call.files.keys(), call.name


@pytest.mark.slow
@pytest.mark.parametrize("call", chosen())
def test_a_call_works(call: Call, tmp_path: Path) -> None:
    prepare(call, tmp_path)
    with beside(call, tmp_path) as words:
        done = finish(call, tmp_path, words)
    assert done.returncode == call.code, done.stderr.decode()
    written = {str(path.relative_to(tmp_path)) for path in tmp_path.rglob("*") if path.is_file()} - call.files.keys()
    assert set(call.writes) <= written
