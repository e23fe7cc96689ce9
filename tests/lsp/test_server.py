"""What the server announces it answers; settings, folders and files of the workspace take effect."""

from __future__ import annotations

from pathlib import Path

import pytest
from lsprotocol import types

from elitescript.assist.completion import ItemKind
from elitescript.assist.folding import FoldKind
from elitescript.assist.names import Access
from elitescript.assist.outline import SymbolKind
from elitescript.lsp import explaining, files, navigating, server
from elitescript.lsp.server import FEATURES
from tests.lsp.memory_client import URI, at, position, span

PROGRAM = """\
def cell():
  speed = 0.5
  def pick(height):
    movej([0, -1.57, 0, -1.57, 0, 0], a=1.4, v=speed)
    textmsg("\U0001f916", height)
  end
  pick(0.2)
  pick(0.3)
end
"""
TEXT = {"textDocument": {"uri": URI}}
LAYOUT = {"tabSize": 2, "insertSpaces": True}
WHOLE = span(0, 0, 9, 0)
PICK = span(2, 6, 2, 10)


def names(symbols):
    return [(symbol["name"], names(symbol.get("children") or [])) for symbol in symbols]


def edited(text, edits):
    """Return a text after edits of ASCII lines, which do not overlap."""
    rows = text.split("\n")
    for edit in sorted(edits, key=lambda one: -one["range"]["start"]["line"]):
        start, end = edit["range"]["start"], edit["range"]["end"]
        before, after = rows[start["line"]][: start["character"]], rows[end["line"]][end["character"] :]
        rows[start["line"] : end["line"] + 1] = [before + edit["newText"] + after]
    return "\n".join(rows)


def hover(client):
    assert "movej" in client.result("textDocument/hover", at(3, 6))["contents"]["value"]


def completion(client):
    client.change({"range": span(6, 2, 6, 12), "text": "movej(q"})
    labels = {item["label"] for item in client.result("textDocument/completion", at(6, 2))["items"]}
    assert {"movej", "pick"} <= labels
    written = client.result("textDocument/completion", at(6, 5))
    labels = {item["label"] for item in written["items"]}
    assert ("movej" in labels, "textmsg" in labels, written["isIncomplete"]) == (True, False, True)


def resolve(client):
    items = client.result("textDocument/completion", at(6, 2))["items"]
    movej = next(item for item in items if item["label"] == "movej")
    assert "documentation" not in movej
    assert "rad" in client.result("completionItem/resolve", movej)["documentation"]["value"]


def signature_help(client):
    [found] = client.result("textDocument/signatureHelp", at(3, 40))["signatures"]
    assert found["label"].startswith("movej(")
    start, end = found["parameters"][found["activeParameter"]]["label"]
    assert found["label"][start:end].startswith("a")


def definition(client):
    assert [place["range"] for place in client.result("textDocument/definition", at(6, 3))] == [PICK]


def declaration(client):
    assert [place["range"] for place in client.result("textDocument/declaration", at(6, 3))] == [PICK]


def references(client):
    lines = [
        [place["range"]["start"]["line"] for place in client.result("textDocument/references", asked)]
        for asked in ({**at(6, 3), "context": {"includeDeclaration": with_it}} for with_it in (True, False))
    ]
    assert lines == [[2, 6, 7], [6, 7]]


def highlights(client):
    found = client.result("textDocument/documentHighlight", at(1, 3))
    assert [(one["range"]["start"]["line"], one["kind"]) for one in found] == [(1, 3), (3, 2)]


def document_symbols(client):
    assert names(client.result("textDocument/documentSymbol", TEXT)) == [("cell", [("pick", [])])]


def workspace_symbols(client):
    assert "pick" in [one["name"] for one in client.result("workspace/symbol", {"query": "pk"})]


def prepare_rename(client):
    assert client.result("textDocument/prepareRename", at(6, 3))["placeholder"] == "pick"
    assert client.ask("textDocument/prepareRename", at(3, 6))["error"]["code"] == -32803


def rename(client):
    edit = client.result("textDocument/rename", {**at(6, 3), "newName": "grip"})
    [change] = edit["documentChanges"]
    assert change["textDocument"]["version"] == 1
    assert [one["newText"] for one in change["edits"]] == ["grip"] * 3
    assert client.ask("textDocument/rename", {**at(6, 3), "newName": "movej"})["error"]["code"] == -32803


def folding(client):
    found = client.result("textDocument/foldingRange", TEXT)
    assert (2, 4) in {(fold["startLine"], fold["endLine"]) for fold in found} or (2, 5) in {
        (fold["startLine"], fold["endLine"]) for fold in found
    }


def selection(client):
    [found] = client.result("textDocument/selectionRange", {**TEXT, "positions": [position(6, 3)]})
    assert found["range"] == span(6, 2, 6, 6)
    while "parent" in found:
        found = found["parent"]
    assert found["range"]["start"] == position(0, 0)


def links(client, tmp_path):
    pass


def tokens(client):
    data = client.result("textDocument/semanticTokens/full", TEXT)["data"]
    assert len(data) % 5 == 0
    assert data


def tokens_of_range(client):
    asked = {**TEXT, "range": span(3, 0, 3, 60)}
    data = client.result("textDocument/semanticTokens/range", asked)["data"]
    assert data[0] == 3
    assert set(data[5::5]) == {0}


def tokens_delta(client):
    old = client.result("textDocument/semanticTokens/full", TEXT)
    client.change({"range": span(1, 2, 1, 2), "text": "x = 1\n  "})
    delta = client.result("textDocument/semanticTokens/full/delta", {**TEXT, "previousResultId": old["resultId"]})
    [edit] = delta["edits"]
    data = old["data"]
    data[edit["start"] : edit["start"] + edit["deleteCount"]] = edit.get("data", [])
    assert len(edit.get("data", [])) < len(data) / 2
    assert data == client.result("textDocument/semanticTokens/full", TEXT)["data"]
    unknown = {**TEXT, "previousResultId": "no such"}
    assert client.result("textDocument/semanticTokens/full/delta", unknown)["data"] == data


def formatting(client):
    client.change({"range": span(3, 43, 3, 45), "text": ","})
    edits = client.result("textDocument/formatting", {**TEXT, "options": LAYOUT})
    assert edited(client.text(), edits) == PROGRAM


def range_formatting(client):
    client.change({"range": span(3, 43, 3, 45), "text": ","})
    asked = {**TEXT, "range": span(3, 0, 3, 9), "options": LAYOUT}
    assert edited(client.text(), client.result("textDocument/rangeFormatting", asked)) == PROGRAM
    asked["range"] = span(6, 0, 7, 0)
    assert client.result("textDocument/rangeFormatting", asked) == []


def on_type_formatting(client):
    client.change({"range": span(6, 0, 6, 0), "text": "  if True:\n\n"})
    edits = client.result("textDocument/onTypeFormatting", {**at(7, 0), "ch": "\n", "options": LAYOUT})
    assert edited(client.text(), edits).split("\n")[6:9] == ["  if True:", "    ", "  end"]


def code_action(client):
    client.change({"range": span(6, 2, 6, 6), "text": "pik"})
    asked = {**TEXT, "range": span(6, 2, 6, 3), "context": {"diagnostics": []}}
    found = client.result("textDocument/codeAction", asked)
    assert any("pick" in action["title"] and action["kind"] == "quickfix" for action in found)
    assert (
        client.result("textDocument/codeAction", {**asked, "context": {"diagnostics": [], "only": ["refactor.x"]}})
        == []
    )


def inlay_hint(client):
    found = client.result("textDocument/inlayHint", {**TEXT, "range": WHOLE})
    assert 3 in {hint["position"]["line"] for hint in found}
    assert client.result("textDocument/inlayHint", {**TEXT, "range": span(0, 0, 2, 0)}) == []


def code_lens(client):
    commands = [lens["command"] for lens in client.result("textDocument/codeLens", TEXT)]
    shown = {command["command"]: command["arguments"] for command in commands if command["command"]}
    assert shown == {name: [URI] for name in ("elitescript.run", "elitescript.debug", "elitescript.showPath")}


def call_hierarchy(client):
    [item] = client.result("textDocument/prepareCallHierarchy", at(6, 3))
    assert item["name"] == "pick"
    return item


def incoming(client):
    [call] = client.result("callHierarchy/incomingCalls", {"item": call_hierarchy(client)})
    assert (call["from"]["name"], len(call["fromRanges"])) == ("cell", 2)


def outgoing(client):
    [item] = client.result("textDocument/prepareCallHierarchy", at(0, 5))
    calls = client.result("callHierarchy/outgoingCalls", {"item": item})
    assert [call["to"]["name"] for call in calls] == ["pick"]


def link(client):
    assert client.result("textDocument/documentLink", TEXT) == []


def diagnostic(client):
    client.change({"range": span(3, 38, 3, 39), "text": "aa"})
    first = client.result("textDocument/diagnostic", TEXT)
    assert [one["code"] for one in first["items"]] == ["E303"]
    again = client.result("textDocument/diagnostic", {**TEXT, "previousResultId": first["resultId"]})
    assert again == {"kind": "unchanged", "resultId": first["resultId"]}


def workspace_diagnostic(client):
    [first] = client.result("workspace/diagnostic", {"previousResultIds": []})["items"]
    assert (first["uri"], first["version"], first["items"]) == (URI, 1, [])
    known = {"uri": URI, "value": first["resultId"]}
    gone = {"uri": "file:///gone.script", "value": "1"}
    found = client.result("workspace/diagnostic", {"previousResultIds": [known, gone]})["items"]
    assert [(one["uri"], one["kind"]) for one in found] == [(URI, "unchanged"), ("file:///gone.script", "full")]


def execute_command(client):
    """What the commands do is in `test_background`."""
    ask = "workspace/executeCommand"
    assert client.ask(ask, {"command": "elitescript.nonsense"})["error"]["code"] == -32602
    assert client.ask(ask, {"command": "elitescript.server.run"})["error"]["code"] == -32602
    error = client.ask(ask, {"command": "elitescript.server.plot", "arguments": ["file:///no.script"]})["error"]
    assert error["code"] == -32803


EXERCISED = {
    types.TEXT_DOCUMENT_HOVER: hover,
    types.TEXT_DOCUMENT_COMPLETION: completion,
    types.COMPLETION_ITEM_RESOLVE: resolve,
    types.TEXT_DOCUMENT_SIGNATURE_HELP: signature_help,
    types.TEXT_DOCUMENT_DEFINITION: definition,
    types.TEXT_DOCUMENT_DECLARATION: declaration,
    types.TEXT_DOCUMENT_REFERENCES: references,
    types.TEXT_DOCUMENT_DOCUMENT_HIGHLIGHT: highlights,
    types.TEXT_DOCUMENT_DOCUMENT_SYMBOL: document_symbols,
    types.WORKSPACE_SYMBOL: workspace_symbols,
    types.TEXT_DOCUMENT_PREPARE_RENAME: prepare_rename,
    types.TEXT_DOCUMENT_RENAME: rename,
    types.TEXT_DOCUMENT_FOLDING_RANGE: folding,
    types.TEXT_DOCUMENT_SELECTION_RANGE: selection,
    types.TEXT_DOCUMENT_SEMANTIC_TOKENS_FULL: tokens,
    types.TEXT_DOCUMENT_SEMANTIC_TOKENS_RANGE: tokens_of_range,
    types.TEXT_DOCUMENT_SEMANTIC_TOKENS_FULL_DELTA: tokens_delta,
    types.TEXT_DOCUMENT_FORMATTING: formatting,
    types.TEXT_DOCUMENT_RANGE_FORMATTING: range_formatting,
    types.TEXT_DOCUMENT_ON_TYPE_FORMATTING: on_type_formatting,
    types.TEXT_DOCUMENT_CODE_ACTION: code_action,
    types.TEXT_DOCUMENT_INLAY_HINT: inlay_hint,
    types.TEXT_DOCUMENT_CODE_LENS: code_lens,
    types.TEXT_DOCUMENT_PREPARE_CALL_HIERARCHY: call_hierarchy,
    types.CALL_HIERARCHY_INCOMING_CALLS: incoming,
    types.CALL_HIERARCHY_OUTGOING_CALLS: outgoing,
    types.TEXT_DOCUMENT_DOCUMENT_LINK: link,
    types.TEXT_DOCUMENT_DIAGNOSTIC: diagnostic,
    types.WORKSPACE_DIAGNOSTIC: workspace_diagnostic,
    types.WORKSPACE_EXECUTE_COMMAND: execute_command,
}

RICH = {
    "textDocument": {
        "diagnostic": {},
        "documentSymbol": {"hierarchicalDocumentSymbolSupport": True},
        "rename": {"prepareSupport": True},
        "completion": {"completionItem": {"snippetSupport": True}},
    },
    "workspace": {"workspaceEdit": {"documentChanges": True}},
}


class TestCapabilities:
    def test_every_request_is_exercised(self):
        assert set(EXERCISED) == set(FEATURES)

    @pytest.mark.parametrize("method", EXERCISED)
    def test_it_answers(self, bare, method):
        bare.initialize(RICH)
        bare.open(PROGRAM)
        EXERCISED[method](bare)

    def test_what_is_announced(self, bare):
        """Typed by hand: the table of the protocol's providers."""
        announced = bare.initialize(RICH)["capabilities"]
        assert announced.pop("workspace")["workspaceFolders"] == {"supported": True, "changeNotifications": True}
        assert announced.pop("textDocumentSync") == {"openClose": True, "change": 2, "save": True}
        assert announced.pop("positionEncoding") == "utf-16"
        assert announced.pop("renameProvider") == {"prepareProvider": True}
        assert announced.pop("executeCommandProvider") == {
            "commands": ["elitescript.server.run", "elitescript.server.plot"]
        }
        assert announced.pop("diagnosticProvider") == {
            "identifier": "elitescript",
            "interFileDependencies": False,
            "workspaceDiagnostics": True,
        }
        assert announced.pop("semanticTokensProvider")["full"] == {"delta": True}
        assert announced.pop("completionProvider")["resolveProvider"] is True
        assert announced.pop("codeActionProvider")["codeActionKinds"] == [
            "quickfix",
            "refactor.rewrite",
            "source.fixAll",
        ]
        assert announced.pop("documentOnTypeFormattingProvider")["firstTriggerCharacter"] == "\n"
        assert sorted(announced) == [
            "callHierarchyProvider",
            "codeLensProvider",
            "declarationProvider",
            "definitionProvider",
            "documentFormattingProvider",
            "documentHighlightProvider",
            "documentLinkProvider",
            "documentRangeFormattingProvider",
            "documentSymbolProvider",
            "foldingRangeProvider",
            "hoverProvider",
            "inlayHintProvider",
            "referencesProvider",
            "selectionRangeProvider",
            "signatureHelpProvider",
            "workspaceSymbolProvider",
        ]

    def test_notebooks_are_not_announced(self, bare):
        capabilities = {"notebookDocument": {"synchronization": {}}}
        assert "notebookDocumentSync" not in bare.initialize(capabilities)["capabilities"]

    @pytest.mark.parametrize(
        ("table", "kinds"),
        [
            (explaining._KINDS, ItemKind),
            (navigating._SYMBOLS, SymbolKind),
            (navigating._ACCESS, Access),
        ],
    )
    def test_every_kind_has_one_of_the_protocol(self, table, kinds):
        assert set(table) == set(kinds)

    def test_folds_without_a_kind_of_the_protocol(self):
        assert set(FoldKind) - set(navigating._FOLDS) == {FoldKind.BLOCK, FoldKind.NODE, FoldKind.LINES}

    def test_clients_without_trees_get_a_flat_outline(self, client):
        client.open(PROGRAM)
        found = client.result("textDocument/documentSymbol", TEXT)
        assert [(one["name"], one.get("containerName")) for one in found] == [("cell", None), ("pick", "cell")]

    def test_clients_without_snippets_get_plain_texts(self, client):
        client.open(PROGRAM)
        items = client.result("textDocument/completion", at(6, 2))["items"]
        assert not [item for item in items if "$" in item["textEdit"]["newText"]]

    def test_clients_without_versioned_edits_get_plain_ones(self, client):
        client.open(PROGRAM)
        edit = client.result("textDocument/rename", {**at(6, 3), "newName": "grip"})
        assert len(edit["changes"][URI]) == 3

    def test_an_emoji_before_a_place_is_counted_as_the_client_counts(self, client):
        client.open(PROGRAM)
        found = client.result("textDocument/references", {**at(2, 12), "context": {"includeDeclaration": True}})
        assert found[-1]["range"] == span(4, 18, 4, 24)


def folder_uri(path: Path) -> str:
    return path.as_uri()


def codes(client, uri):
    return [one["code"] for one in client.result("textDocument/diagnostic", {"textDocument": {"uri": uri}})["items"]]


OLD_FIRMWARE = {"firmware": "2.10"}
STRICT_ONLY = 'def p():\n  print "x"\nend\n'
"""A warning, and an error with `strict`."""


def severities(client, uri=URI):
    found = client.result("textDocument/diagnostic", {"textDocument": {"uri": uri}})["items"]
    return {one["severity"] for one in found}


class TestSettings:
    @pytest.mark.parametrize(
        "given", [{"strict": True}, {"elitescript": {"strict": True}}, {"elitescript.strict": True}]
    )
    def test_those_of_initialize(self, bare, given):
        bare.initialize(RICH, initializationOptions=given)
        bare.open(STRICT_ONLY)
        assert severities(bare) == {1}

    def test_without_any(self, bare):
        bare.initialize(RICH)
        bare.open(STRICT_ONLY)
        assert severities(bare) == {2}

    def test_those_of_a_notification(self, bare):
        bare.initialize(RICH)
        bare.open(STRICT_ONLY)
        bare.notify("workspace/didChangeConfiguration", {"settings": {"elitescript": {"strict": True}}})
        assert severities(bare) == {1}

    def test_those_that_the_server_asks_for(self, bare, tmp_path):
        one, two = tmp_path / "one", tmp_path / "two"
        roots = [{"uri": folder_uri(path), "name": path.name} for path in (one, two)]
        bare.initialize(
            {"workspace": {"configuration": True}, "textDocument": {"diagnostic": {}}}, workspaceFolders=roots
        )
        asked = bare.until(lambda message: message.get("method") == "workspace/configuration")
        assert asked["params"]["items"] == [{"scopeUri": root["uri"], "section": "elitescript"} for root in roots]
        for path in (one, two):
            bare.open(STRICT_ONLY, f"{folder_uri(path)}/a.script")
        bare.reply(asked, [{"strict": True}, {}])
        assert severities(bare, f"{folder_uri(one)}/a.script") == {1}
        assert severities(bare, f"{folder_uri(two)}/a.script") == {2}
        bare.notify("workspace/didChangeConfiguration", {"settings": None})
        asked = bare.until(lambda message: message.get("method") == "workspace/configuration")
        bare.reply(asked, [{}, {"strict": True}])
        assert severities(bare, f"{folder_uri(one)}/a.script") == {2}
        assert severities(bare, f"{folder_uri(two)}/a.script") == {1}

    @pytest.mark.parametrize("answer", [None, [], [1], [{"firmware": 7}]])
    def test_a_strange_answer_leaves_the_defaults(self, bare, answer):
        bare.initialize({"workspace": {"configuration": True}, "textDocument": {"diagnostic": {}}})
        asked = bare.until(lambda message: message.get("method") == "workspace/configuration")
        bare.reply(asked, answer)
        bare.open(STRICT_ONLY)
        assert severities(bare) == {2}

    @pytest.mark.parametrize(
        ("given", "said"),
        [
            ({"firmware": "9.9"}, "elitescript.firmware: firmware '9.9' is not known"),
            ({"strict": "yes"}, "elitescript.strict: must be true or false, got 'yes'"),
            ({"robot": "CS77"}, "elitescript.robot: "),
            ({"hints": {"run": 1}}, "elitescript.hints.run: must be true or false"),
            ({"world": "no.toml"}, "cannot read no.toml: "),
            ([1], "elitescript: must be a table"),
        ],
    )
    def test_a_wrong_value_is_shown_and_left_out(self, bare, given, said):
        bare.initialize(RICH, initializationOptions=given)
        shown = bare.notification("window/showMessage")
        assert said in shown["message"]
        bare.open(STRICT_ONLY)
        assert severities(bare) == {2}

    def test_a_world_file_has_options(self, bare, tmp_path):
        (tmp_path / "cell.toml").write_text("[robot]\nstrict = true\n", encoding="utf-8")
        uri = f"{folder_uri(tmp_path)}/a.script"
        bare.initialize(
            RICH,
            workspaceFolders=[{"uri": folder_uri(tmp_path), "name": "cell"}],
            initializationOptions={"world": "cell.toml"},
        )
        bare.open(STRICT_ONLY, uri)
        assert severities(bare, uri) == {1}
        (tmp_path / "cell.toml").write_text("[robot]\nstrict = false\n", encoding="utf-8")
        change = {"uri": f"{folder_uri(tmp_path)}/cell.toml", "type": 2}
        bare.notify("workspace/didChangeWatchedFiles", {"changes": [change]})
        assert severities(bare, uri) == {2}

    def test_a_world_file_has_names(self, bare, tmp_path):
        (tmp_path / "cell.toml").write_text('[[tcp]]\naddress = "10.1.2.3"\nport = 7\n', encoding="utf-8")
        bare.initialize(RICH, initializationOptions={"world": str(tmp_path / "cell.toml")})
        bare.open('def p():\n  socket_open("", 7)\nend\n')
        items = bare.result("textDocument/completion", at(1, 15))["items"]
        assert "10.1.2.3" in [item["label"] for item in items]

    def test_an_arm_has_a_reach(self, bare):
        far = "def p():\n  movel([2.5, 0, 0.3, 0, 3.14, 0], a=0.5, v=0.1)\nend\n"
        bare.initialize(RICH, initializationOptions={"robot": "CS63"})
        bare.open(far)
        with_arm = codes(bare, URI)
        bare.notify("workspace/didChangeConfiguration", {"settings": {"elitescript": {}}})
        assert set(with_arm) - set(codes(bare, URI))


class TestFolders:
    def make(self, home: Path) -> Path:
        for name in ("a.script", "in/b.script", ".hidden/c.script", "node_modules/d.script", ".venv/e.script", "f.py"):
            path = home / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(f"def {path.stem}_program():\n  x = 1\nend\n", encoding="utf-8")
        return home

    def symbols(self, client, query=""):
        found = client.result("workspace/symbol", {"query": query})
        return sorted(one["name"] for one in found if one["name"].endswith("_program"))

    def initialized(self, client, *homes, capabilities=None):
        folders = [{"uri": folder_uri(home), "name": home.name} for home in homes]
        client.initialize(capabilities, workspaceFolders=folders)

    def test_programs_are_searched_but_not_hidden_or_foreign_ones(self, bare, tmp_path):
        self.initialized(bare, self.make(tmp_path))
        assert self.symbols(bare) == ["a_program", "b_program"]

    @pytest.mark.parametrize("name", ["rootUri", "rootPath"])
    def test_the_root_of_older_clients(self, bare, tmp_path, name):
        home = self.make(tmp_path)
        bare.initialize(**{name: folder_uri(home) if name == "rootUri" else str(home)})
        assert self.symbols(bare) == ["a_program", "b_program"]

    def test_several_folders_that_come_and_go(self, bare, tmp_path):
        one, two = self.make(tmp_path / "one"), self.make(tmp_path / "two")
        (two / "g.script").write_text("def g_program():\n  x = 1\nend\n", encoding="utf-8")
        self.initialized(bare, one)
        added, removed = ({"uri": folder_uri(home), "name": "x"} for home in (two, one))
        bare.notify("workspace/didChangeWorkspaceFolders", {"event": {"added": [added], "removed": []}})
        assert self.symbols(bare) == ["a_program"] * 2 + ["b_program"] * 2 + ["g_program"]
        bare.notify("workspace/didChangeWorkspaceFolders", {"event": {"added": [], "removed": [removed]}})
        assert self.symbols(bare) == ["a_program", "b_program", "g_program"]

    def test_the_open_text_counts_and_not_the_file(self, bare, tmp_path):
        home = self.make(tmp_path)
        self.initialized(bare, home)
        bare.open("def new_program():\n  x = 1\nend\n", f"{folder_uri(home)}/a.script")
        assert self.symbols(bare) == ["b_program", "new_program"]

    def test_files_are_read_again_when_they_change(self, bare, tmp_path, monkeypatch):
        monkeypatch.setattr(server, "REGISTERED_AFTER_S", 0.0)
        home = self.make(tmp_path)
        watching = {"workspace": {"didChangeWatchedFiles": {"dynamicRegistration": True}}}
        self.initialized(bare, home, capabilities=watching)
        registered = bare.notification("client/registerCapability")["registrations"]
        assert [one["method"] for one in registered] == ["workspace/didChangeWatchedFiles"]
        patterns = [one["globPattern"] for one in registered[0]["registerOptions"]["watchers"]]
        assert patterns == ["**/*.script", "**/*.SCRIPT", "**/*.toml"]
        assert self.symbols(bare) == ["a_program", "b_program"]
        (home / "a.script").write_text("def other_program():\n  x = 12\nend\n", encoding="utf-8")
        (home / "h.script").write_text("def h_program():\n  x = 1\nend\n", encoding="utf-8")
        (home / "in" / "b.script").unlink()
        changes = [{"uri": f"{folder_uri(home)}/h.script", "type": 1}]
        bare.notify("workspace/didChangeWatchedFiles", {"changes": changes})
        assert self.symbols(bare) == ["h_program", "other_program"]

    def test_there_is_a_limit(self, bare, tmp_path, monkeypatch):
        monkeypatch.setattr(files, "FILES_MAX", 1)
        self.initialized(bare, self.make(tmp_path))
        assert self.symbols(bare) == ["a_program"]

    def test_findings_of_all_programs(self, bare, tmp_path):
        home = self.make(tmp_path)
        (home / "a.script").write_text("def p():\n  nonsense()\nend\n", encoding="utf-8")
        self.initialized(bare, home)
        found = bare.result("workspace/diagnostic", {"previousResultIds": []})["items"]
        assert {Path(one["uri"]).name: [item["code"] for item in one["items"]] for one in found} == {
            "a.script": ["E301"],
            "b.script": [],
        }

    def test_links_lead_to_files_that_are_there(self, bare, tmp_path):
        home = self.make(tmp_path)
        (home / "points.csv").write_text("1", encoding="utf-8")
        self.initialized(bare, home)
        uri = f"{folder_uri(home)}/a.script"
        bare.open('def p():\n  f = open("points.csv")\n  g = open("nothing.csv")\nend\n', uri)
        [found] = bare.result("textDocument/documentLink", {"textDocument": {"uri": uri}})
        assert (found["target"], found["range"]["start"]["line"]) == (f"{folder_uri(home)}/points.csv", 1)
