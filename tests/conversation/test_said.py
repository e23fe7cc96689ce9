"""What sources say to people has a row in the table of the Chinese page: read from the sources, not from a list."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from elitescript import VirtualRobot
from elitescript.devices.channels.faults import title_of
from elitescript.studio import services

ROOT = Path(__file__).parents[2]
TABLE = (ROOT / "web" / "src" / "text" / "said.ts").read_text(encoding="utf-8")
ROWS = re.findall(r'^  \["((?:[^"\\]|\\.)*)", "((?:[^"\\]|\\.)*)"\],$', TABLE, re.MULTILINE)
ENGLISH = [re.sub(r"\{\d\}", "{}", english) for english, _ in ROWS]

SAYING = {"UsageError", "LinkError", "PeerError", "CommandError", "notice", "refused"}
"""Calls whose texts come to a page, as they are or in others."""
BEFORE_THE_PAGE = {"serving.py", "target.py"}
"""Modules whose refusals end the command, before there is a page."""


def template(node: ast.expr, named: dict[str, str]) -> str:
    """Return a text with `{}` in place of its values; empty for what is none."""
    match node:
        case ast.Constant(value=str(text)):
            return re.sub(r"\{[^}]*\}", "{}", text)
        case ast.JoinedStr(values=parts):
            return "".join(part.value if isinstance(part, ast.Constant) else "{}" for part in parts)  # type: ignore[misc]
        case ast.Name(id=name) | ast.Attribute(attr=name):
            return named.get(name, "")
        case ast.Call(func=ast.Name(id="said"), args=[ast.Constant(value=str(text))]):
            return re.sub(r"\{[^}]*\}", "{}", text)
        case ast.Call(func=ast.Attribute(value=inner, attr="format")):
            return template(inner, named)
        case ast.BinOp(left=left, right=right):
            return template(left, named) + template(right, named)
        case _:
            return ""


def texts_of(path: Path, calls: set[str]) -> Iterator[str]:
    """Yield the texts that a module gives to some calls."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    named = {
        item.target.id: template(item.value, {})
        for item in tree.body
        if isinstance(item, ast.AnnAssign) and isinstance(item.target, ast.Name) and item.value is not None
    }
    for node in ast.walk(tree):
        if isinstance(node, ast.Call):
            name = node.func.id if isinstance(node.func, ast.Name) else getattr(node.func, "attr", "")
            if name in calls:
                yield from (template(argument, named) for argument in node.args)


def is_ours(text: str) -> bool:
    """Return whether a text has words of its own besides its values."""
    return len(re.findall(r"[A-Za-z]{2,}", text.replace("{}", ""))) >= 2


def of_the_page() -> list[tuple[str, str]]:
    folders = [ROOT / "src" / "elitescript" / name for name in ("studio", "client")]
    paths = sorted(path for folder in folders for path in folder.rglob("*.py") if path.name not in BEFORE_THE_PAGE)
    found = {(path.name, text): None for path in paths for text in texts_of(path, SAYING) if is_ours(text)}
    return list(found)


def waits() -> list[tuple[str, str]]:
    """Return the reasons of waits: what is given to `wait`, and what is kept as `reason` before."""
    found: dict[tuple[str, str], None] = {}
    for path in sorted((ROOT / "src" / "elitescript" / "runtime").rglob("*.py")):
        source = path.read_text(encoding="utf-8")
        for text in texts_of(path, {"wait"}):
            found[path.name, text] = None
        if "wait" in source:
            for node in ast.walk(ast.parse(source)):
                if isinstance(node, ast.AnnAssign | ast.Assign) and node.value is not None:
                    target = node.target if isinstance(node, ast.AnnAssign) else node.targets[0]
                    if isinstance(target, ast.Name) and target.id in {
                        "reason",
                        "A_LOCK",
                        "RESUME",
                        "POPUP",
                        "MOVE_END",
                    }:
                        values = (
                            [node.value.body, node.value.orelse] if isinstance(node.value, ast.IfExp) else [node.value]
                        )
                        found |= {(path.name, template(value, {})): None for value in values}
    return [item for item in found if item[1] and is_ours(item[1]) and item[1] not in NO_WAITS]


NO_WAITS = {
    "the peer sent more than {} bytes that are not read",
    "it was configured by another thread meanwhile",
    "its device has gone",
}
"""Texts named `reason` that are reasons of something else."""


@pytest.mark.parametrize(("module", "text"), of_the_page())
def test_what_the_page_is_told_has_a_row(module, text):
    assert text in ENGLISH


@pytest.mark.parametrize(("module", "text"), waits())
def test_what_threads_wait_for_has_a_row(module, text):
    assert text in ENGLISH


@pytest.mark.parametrize("on", [5000, "plant"])
def test_what_a_fault_reports_has_a_row(on):
    text = f"{title_of('delay', on)} acts"
    assert re.sub("delay|plant|5000", "{}", text) in ENGLISH
    assert "fault" in ENGLISH


def test_there_is_something_to_look_for():
    assert len(of_the_page()) > 80
    assert len(waits()) > 12


def test_the_titles_of_the_examples_have_rows():
    titles = [services._title(path.read_text(encoding="utf-8")) for path in services.EXAMPLES.glob("*.script")]
    assert len(titles) == 3
    assert set(titles) <= set(ENGLISH)


@pytest.mark.parametrize(("english", "chinese"), ROWS)
def test_rows_keep_their_values_and_are_chinese(english, chinese):
    assert sorted(re.findall(r"\{\d\}", english)) == sorted(re.findall(r"\{\d\}", chinese))
    assert re.findall(r"\{(\d)\}", english) == [str(number) for number in range(1, english.count("{") + 1)]
    assert re.search(r"[一-鿿]", chinese)


def test_a_real_wait_is_said_in_rows():
    robot = VirtualRobot("CS66")
    seen: set[str] = set()
    text = (
        'def a():\n  movej([0.1, -1.57, -1.57, -1.57, 1.57, 0])\n  sleep(0.1)\n  socket_open("192.168.0.9", 1)\nend\n'
    )
    robot.run(text, watch=lambda robot: seen.update(thread.waits_for for thread in robot.threads()))
    seen.discard("")
    patterns = [re.escape(english).replace(r"\{\}", ".+?") for english in ENGLISH if not english.startswith("{}")]
    assert len(seen) >= 2
    for words in seen:
        reason = re.sub(r", until [\d.]+ s$", "", words)
        assert any(re.fullmatch(pattern, reason) for pattern in patterns) or reason.endswith("to accept a connection")
