"""The table of node kinds on the page of what is simulated, against the kinds that are read, and what they give."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from elitescript.program_tree import generated, read_task
from elitescript.program_tree.kinds import KINDS

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs/explanation/simulated.md").read_text(encoding="utf-8")
EXAMPLES = (Path(__file__).with_name("nodes.md")).read_text(encoding="utf-8")
ROWS = re.findall(r"^\| `(\w+)` \| (.+?) \| (.+?) \|$", PAGE, re.MULTILINE)
WORDS = ("seen in a pair", "meaning known", "refused by name")


def test_each_kind_has_one_row() -> None:
    elements = [element for element, _, _ in ROWS]
    assert sorted(elements) == sorted({kind.element for kind in KINDS} | {"CompressNode"})
    assert "was ever opened on a pendant" in PAGE


@pytest.mark.parametrize(("element", "evidence"), [(element, evidence) for element, _, evidence in ROWS])
def test_what_a_row_says(element: str, evidence: str) -> None:
    assert any(word in evidence for word in WORDS)
    if evidence.startswith("refused"):
        data = f"<EliTask><MainTask><{element}/></MainTask></EliTask>".encode()
        assert generated(read_task(data)).errors
    else:
        # Its script was written by hand.
        assert f"<{element}" in EXAMPLES or element in WHOLE_TASKS


WHOLE_TASKS = ("InitVariables", "BeforeStart", "MainTask", "SubTaskNode", "ThreadNode", "EventNode")
"""Parts of tasks, which stand in no example of a node: tests of whole tasks have them."""


def test_the_others_are_refused_by_name() -> None:
    problems = generated(read_task(b"<EliTask><MainTask><PalletNode/></MainTask></EliTask>")).errors
    assert "nodes of the kind `PalletNode` are not known" in problems[0].text
