"""The TextMate grammar; `make vscode-test` tests with an editor's own engine that it colours programs rightly."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from typing import Any

from elitescript.commands.catalogue import CATALOGUE
from tools.textmate_grammar import PATH, grammar_text

GRAMMAR = json.loads(grammar_text())


def rules(part: Any = GRAMMAR) -> Iterator[dict[str, Any]]:
    if isinstance(part, dict):
        yield part
    for inner in part.values() if isinstance(part, dict) else part if isinstance(part, list) else ():
        yield from rules(inner)


def test_the_file_is_up_to_date():
    is_same = PATH.read_text(encoding="utf-8") == grammar_text()
    assert is_same, f"{PATH.name} is out of date; run `make reference`"


def test_all_patterns_are_regular_expressions_and_all_names_are_there():
    for rule in rules():
        for key in ("match", "begin", "end"):
            if isinstance(rule.get(key), str):
                re.compile(rule[key])
        if "include" in rule:
            assert rule["include"].removeprefix("#") in GRAMMAR["repository"]
        if isinstance(rule.get("name"), str) and rule is not GRAMMAR:
            assert rule["name"].endswith(".elitescript")


def test_every_command_is_coloured_as_one_and_no_attribute_is():
    command = re.compile(GRAMMAR["repository"]["command"]["match"])
    for name in CATALOGUE.names():
        found = command.match(name)
        assert found is not None and found.group() == name
    assert command.search("gripper.movej()") is None
    assert command.search("my_movej()") is None
    assert command.search("movej2()") is None


def test_end_is_a_keyword_on_a_line_of_its_own_alone():
    end = re.compile(GRAMMAR["repository"]["end"]["match"])
    assert all(map(end.match, ("end", "  end ;", "  end # while", "end;")))
    assert not any(map(end.match, ("end = 3", "a[b:end]", "endless", "end(1)", "end;b")))
