"""The server's texts are those of the client, whatever is edited and whatever it counts in."""

from __future__ import annotations

import random

import pytest
from lsprotocol import types
from pygls.workspace import Workspace

from tests.invariants.cases import CASES
from tests.lsp.memory_client import URI, span

PIECES = [
    "x",
    "\n",
    "\r\n",
    "\r",
    "def f():\n",
    "end",
    "\U0001f916",
    "\u00e9",
    "'\u4e2d\u6587'",
    "  ",
    "\ufeff",
    "\u2028",
    "\x0c",
]


def random_text(made: random.Random, size: int, pieces: list[str] = PIECES) -> str:
    return "".join(made.choice(pieces) for _ in range(made.randrange(size)))


def line_starts(text: str) -> list[int]:
    """Offsets at which lines start, as the protocol counts lines."""
    starts = [0]
    index = 0
    while index < len(text):
        if text[index] == "\r" and text[index + 1 : index + 2] == "\n":
            index += 1
        if text[index] in "\r\n":
            starts.append(index + 1)
        index += 1
    return starts


def client_position(text: str, offset: int, encoding: str) -> dict[str, int]:
    """Return the position of an offset as a client of its own would count it."""
    starts = line_starts(text)
    line = max(number for number, start in enumerate(starts) if start <= offset)
    codec, width = {"utf-16": ("utf-16-le", 2), "utf-8": ("utf-8", 1), "utf-32": ("utf-32-le", 4)}[encoding]
    return {"line": line, "character": len(text[starts[line] : offset].encode(codec)) // width}


def inside_line_end(text: str, offset: int) -> bool:
    return text[offset - 1 : offset + 1] == "\r\n"


def edit(made: random.Random, text: str, encoding: str, pieces: list[str] = PIECES) -> tuple[str, dict]:
    """Return a text after a random edit, and the edit as the client sends it."""
    places = [offset for offset in range(len(text) + 1) if not inside_line_end(text, offset)]
    start, end = sorted((made.choice(places), made.choice(places)))
    if made.random() < 0.6:
        end = start
    new = random_text(made, 4, pieces)
    place = {"start": client_position(text, start, encoding), "end": client_position(text, end, encoding)}
    return text[:start] + new + text[end:], {"range": place, "text": new}


@pytest.mark.invariants
@pytest.mark.parametrize("encoding", ["utf-16", "utf-8", "utf-32"])
def test_random_edits_leave_the_text_of_the_client(bare, encoding, finding):
    bare.initialize({"general": {"positionEncodings": [encoding]}})
    made = random.Random(13)
    text = random_text(made, 40)
    bare.open(text)
    for number in range(CASES):
        changes = []
        for _ in range(made.randrange(1, 4)):
            text, change = edit(made, text, encoding)
            changes.append(change)
        if len(text) > 400:
            text = random_text(made, 40)
            changes.append({"text": text})
        bare.change(*changes, version=number + 2)
        assert bare.text() == text, (number, changes)
        assert bare.server.texts.open[URI].version == number + 2
        if number % 40 == 0:
            fresh = bare.server.texts.made(URI, text)
            assert fresh.problems == bare.server.texts.open[URI].problems
    finding(f"texts of an editor that counts in {encoding}", f"{CASES} random edits", "all as the editor has them")


def test_it_is_the_text_that_pygls_has(client):
    """Of edits inside the text, with the lines that Python and the protocol count alike."""
    made = random.Random(4)
    workspace = Workspace(None, types.TextDocumentSyncKind.Incremental, [], types.PositionEncodingKind.Utf16)
    text = "def p():\n  x = '\U0001f916'\nend\n"
    workspace.put_text_document(types.TextDocumentItem(URI, "elitescript", 1, text))
    client.open(text)
    for version in range(2, 60):
        text, change = edit(made, text, "utf-16", PIECES[:-3])
        client.change(change, version=version)
        converted = client.server.protocol._converter.structure(change, types.TextDocumentContentChangePartial)
        workspace.update_text_document(types.VersionedTextDocumentIdentifier(version, URI), converted)
        assert client.text() == text == workspace.get_text_document(URI).source


def test_line_ends_and_a_byte_order_mark_are_kept(client):
    client.open("\ufeffa = 1\r\nb = 2\rc = 3\n")
    client.change({"range": span(1, 0, 1, 1), "text": "bb"})
    assert client.text() == "\ufeffa = 1\r\nbb = 2\rc = 3\n"


def test_edits_outside_the_text_are_moved_into_it(client):
    client.open("a = 1\n")
    client.change({"range": span(70, 3, 90, 0), "text": "b = 2\n"})
    client.change({"range": span(0, 99, 0, 120), "text": "0"}, version=3)
    assert client.text() == "a = 10\nb = 2\n"


def test_an_edit_without_a_range_replaces_the_text(client):
    client.open("a = 1\n")
    client.change({"text": "b"}, {"range": span(0, 1, 0, 1), "text": " = 2"})
    assert client.text() == "b = 2"


def test_no_edit_is_a_new_version(client):
    client.open("a = 1\n")
    client.change(version=9)
    assert client.server.texts.open[URI].version == 9


def test_a_closed_text_is_forgotten(client):
    client.open("a = 1\n")
    client.notify("textDocument/didClose", {"textDocument": {"uri": URI}})
    assert client.server.texts.open == {}
