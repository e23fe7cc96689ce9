"""Files of graphical programs in an editor: outline, hover and findings at their nodes; nothing is edited in them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from tests.lsp.memory_client import MemoryClient

TASK = """<EliTask name="cell" robotType="CS66">
  <InitVariables/>
  <MainTask isTaskAlwaysLoops="false" hasInitVariables="true" typeName="Robot Main Task">
    <MoveNode movementType="JOINT_MOVEMENT" positionType="JOINT_ANGLES" typeName="MoveJ">
      <WaypointNode name="W1" positionNodeType="FIXED_POSITION" typeName="Waypoint">
        <internalPosition><jointPositions joints="0.1, -1.5, -1.5, -1.5, 1.5, 0.0"/></internalPosition>
      </WaypointNode>
    </MoveNode>
    <CompressNode><CompressedNode><HaltNode typeName="Halt"/></CompressedNode></CompressNode>
  </MainTask>
</EliTask>"""


class Editor:
    """An open file."""

    def __init__(self, client: MemoryClient, folder: Path, text: str, name: str = "cell.task") -> None:
        self.client = client
        self.uri = (folder / name).as_uri()
        item = {"uri": self.uri, "languageId": "elitescript-task", "version": 1, "text": text}
        client.notify("textDocument/didOpen", {"textDocument": item})

    def ask(self, method: str, **more: Any) -> Any:
        return self.client.ask(f"textDocument/{method}", {"textDocument": {"uri": self.uri}, **more})

    def at(self, line: int, character: int = 8) -> dict[str, Any]:
        return {"position": {"line": line - 1, "character": character}}

    def findings(self) -> list[tuple[int, int, str, str]]:
        found = self.ask("diagnostic")
        return [
            (row["range"]["start"]["line"] + 1, row["severity"], row["code"], row["message"])
            for row in found["result"]["items"]
        ]


@pytest.fixture
def hierarchical(bare: MemoryClient) -> MemoryClient:
    symbols = {"documentSymbol": {"hierarchicalDocumentSymbolSupport": True}, "diagnostic": {}}
    bare.initialize({"textDocument": symbols})
    return bare


def test_the_outline_is_the_tree(hierarchical: MemoryClient, tmp_path: Path) -> None:
    found = Editor(hierarchical, tmp_path, TASK).ask("documentSymbol")["result"]
    assert [symbol["name"] for symbol in found] == ["1 Initial variables", "2 Main task"]
    main = found[1]
    assert (main["detail"], [child["name"] for child in main["children"]]) == ("once", ["3 MoveJ", "5 Halt"])
    (waypoint,) = main["children"][0]["children"]
    assert (waypoint["name"], waypoint["range"]["start"]) == ("4 Waypoint W1", {"line": 4, "character": 6})
    assert waypoint["range"]["end"] == {"line": 6, "character": 21}
    assert waypoint["selectionRange"]["end"]["line"] == 4
    assert main["children"][1]["detail"] == "suppressed"


def test_a_hover_says_what_a_node_does_and_shows_its_script(hierarchical: MemoryClient, tmp_path: Path) -> None:
    editor = Editor(hierarchical, tmp_path, TASK)
    said = editor.ask("hover", **editor.at(6))["result"]["contents"]["value"]
    assert said.startswith("**4 Waypoint W1**: joints [0.1, -1.5, -1.5, -1.5, 1.5, 0]")
    assert '```elitescript\n$ LINE: (4, "W1", "after")\nmovej([0.1, -1.5,' in said
    assert "script line 2" in said
    assert editor.ask("hover", **editor.at(11, 0))["result"] is None


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("", "", []),
        ("<EliTask name", '<EliTask installationName="i" name', [(1, 3, "N225", "i.configuration or ")]),
        (
            "0.1, -1.5, -1.5, -1.5, 1.5, 0.0",
            "NaN, NaN, NaN, NaN, NaN, NaN",
            [(5, 1, "E004", "3 MoveJ > 4 W1: the way")],
        ),
        ('"0.1, -1.5', '"9.1, -1.5', [(5, 2, "", "3 MoveJ > 4 W1: ")]),
        ("</MoveNode>", "</MoveNod>", [(8, 1, "E004", "no XML: mismatched tag")]),
    ],
)
def test_findings_stand_at_nodes_in_the_file(
    hierarchical: MemoryClient, tmp_path: Path, old: str, new: str, expected: list[tuple[int, int, str, str]]
) -> None:
    found = Editor(hierarchical, tmp_path, TASK.replace(old, new) if old else TASK).findings()
    assert [(line, severity) for line, severity, *_ in found] == [(line, severity) for line, severity, *_ in expected]
    for (_, _, code, message), (_, _, wanted, begin) in zip(found, expected, strict=True):
        assert wanted in ("", code)
        assert message.startswith(begin)


@pytest.mark.parametrize("method", ["rename", "prepareRename", "references"])
def test_nothing_is_renamed_in_a_tree_nor_in_a_text_made_of_one(
    hierarchical: MemoryClient, tmp_path: Path, method: str
) -> None:
    tree = Editor(hierarchical, tmp_path, TASK)
    text = Editor(hierarchical, tmp_path, "a = 1\n", "cell.task.script")
    for editor, words in (
        (tree, "a task is edited as a tree"),
        (text, "this text is generated from cell.task: the tree"),
    ):
        more = {"newName": "b", "context": {"includeDeclaration": True}, **editor.at(1, 0)}
        answer = editor.ask(method, **more)
        assert answer["error"]["message"].startswith(words)


@pytest.mark.parametrize(
    "method", ["completion", "definition", "foldingRange", "codeLens", "formatting", "documentLink"]
)
def test_what_a_tree_has_not_is_nothing(hierarchical: MemoryClient, tmp_path: Path, method: str) -> None:
    editor = Editor(hierarchical, tmp_path, TASK)
    options = {"tabSize": 2, "insertSpaces": True}
    assert editor.ask(method, options=options, **editor.at(5))["result"] is None
