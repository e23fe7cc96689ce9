"""The server as a process: with an independent client, on standard streams and TCP, and how it ends."""

from __future__ import annotations

import asyncio
import json
import os
import socket
import subprocess
import sys
from pathlib import Path

import pytest
from lsprotocol import types
from pytest_lsp import ClientServerConfig, LanguageClient, client_capabilities

from elitescript.cli.main import main
from elitescript.lsp import serve
from elitescript.lsp.processes import is_alive
from elitescript.lsp.server import Server

SERVER = [sys.executable, "-m", "elitescript", "lsp"]
PROGRAM = "def cell():\n  height = 0.2\n  movej([0, -1.5, 0, -1.57, 0, 0], v=1.0)\n  textmesg(height)\nend\n"


async def opened_client(folder: Path) -> LanguageClient:
    """Return the client of pytest-lsp with a session. Its pytest plugin is off: it takes tests for functions."""
    client = await ClientServerConfig(server_command=SERVER).start()
    capabilities = client_capabilities("visual-studio-code")
    roots = [types.WorkspaceFolder(folder.as_uri(), "cell")]
    params = types.InitializeParams(capabilities, process_id=os.getpid(), workspace_folders=roots)
    # Nothing runs in the background: a test has no time to wait.
    client.set_configuration({"elitescript": {"hints": {"run": False}}})
    # It has no answer of its own to that.
    client.feature(types.CLIENT_REGISTER_CAPABILITY)(lambda params: None)
    await client.initialize_session(params)
    return client


def test_a_journey_with_an_independent_client(tmp_path: Path):
    """Opens a program, sees its mistake, repairs it, renames, lays out; the client checks the types of all answers."""

    async def journey() -> None:
        editor = await opened_client(tmp_path)
        await _journey(editor, f"{tmp_path.as_uri()}/cell.script")
        await editor.shutdown_session()
        await editor.stop()

    asyncio.run(journey())


async def _journey(editor: LanguageClient, uri: str) -> None:
    editor.text_document_did_open(
        types.DidOpenTextDocumentParams(types.TextDocumentItem(uri, "elitescript", 1, PROGRAM))
    )
    named = types.TextDocumentIdentifier(uri)
    report = await editor.text_document_diagnostic_async(types.DocumentDiagnosticParams(named))
    [found] = report.items
    assert (found.code, found.source, found.range.start) == ("E301", "elitescript", types.Position(3, 2))

    asked = types.CodeActionParams(named, found.range, types.CodeActionContext([found]))
    actions = await editor.text_document_code_action_async(asked)
    repair = next(action for action in actions if "textmsg" in action.title)
    [edit] = repair.edit.document_changes[0].edits
    change = types.TextDocumentContentChangePartial(edit.range, edit.new_text)
    editor.text_document_did_change(
        types.DidChangeTextDocumentParams(types.VersionedTextDocumentIdentifier(2, uri), [change])
    )
    report = await editor.text_document_diagnostic_async(types.DocumentDiagnosticParams(named))
    assert not report.items

    hover = await editor.text_document_hover_async(types.HoverParams(named, types.Position(2, 4)))
    assert "movej" in hover.contents.value
    offers = await editor.text_document_completion_async(types.CompletionParams(named, types.Position(3, 4)))
    assert "textmsg" in [item.label for item in offers.items]
    renamed = await editor.text_document_rename_async(types.RenameParams(named, types.Position(1, 4), "high"))
    assert [edit.new_text for edit in renamed.document_changes[0].edits] == ["high", "high"]
    symbols = await editor.text_document_document_symbol_async(types.DocumentSymbolParams(named))
    assert [symbol.name for symbol in symbols] == ["cell"]


class Process:
    """A server as a process, with a client that only sends and reads."""

    def __init__(self, **options) -> None:
        pipe = subprocess.PIPE
        self.process = subprocess.Popen(SERVER, stdin=pipe, stdout=pipe, stderr=pipe, **options)

    def send(self, **message) -> None:
        body = json.dumps({"jsonrpc": "2.0", **message}).encode()
        self.process.stdin.write(b"Content-Length: %d\r\n\r\n%s" % (len(body), body))
        self.process.stdin.flush()

    def read(self) -> dict:
        length = int(self.process.stdout.readline().split(b":")[1])
        assert self.process.stdout.readline() == b"\r\n"
        return json.loads(self.process.stdout.read(length))

    def initialize(self, process_id=None) -> None:
        params = {"processId": process_id, "rootUri": None, "capabilities": {}}
        self.send(id=1, method="initialize", params=params)
        assert "result" in self.read()


@pytest.fixture
def server():
    made = Process()
    yield made
    made.process.kill()
    made.process.wait()
    for pipe in (made.process.stdin, made.process.stdout, made.process.stderr):
        pipe.close()


class TestEnd:
    def test_shutdown_and_exit(self, server):
        """Standard output has had nothing but messages then."""
        server.initialize()
        server.send(id=2, method="shutdown")
        assert server.read()["result"] is None
        server.send(method="exit")
        assert server.process.wait(10) == 0
        assert server.process.stdout.read() == b""

    def test_the_end_of_standard_input(self, server):
        """In the middle of a message."""
        server.process.stdin.write(b"Content-Length: 100\r\n\r\n{")
        server.process.stdin.close()
        assert server.process.wait(10) == 1

    def test_the_process_of_the_editor_is_gone(self, monkeypatch):
        """A parent that was killed need not have closed its end of the pipe."""
        monkeypatch.setattr(serve, "ALIVE_EVERY_S", 0.001)
        monkeypatch.setattr(serve, "is_alive", lambda number: number != 4711)

        async def ended(process_id):
            server = Server()
            server.process_id = process_id
            return await serve._until(asyncio.get_running_loop().create_future(), server)

        assert asyncio.run(ended(4711)) == 1
        with pytest.raises(TimeoutError):
            asyncio.run(asyncio.wait_for(ended(4712), 0.05))


def test_tcp():
    process = subprocess.Popen([*SERVER, "--tcp", "0"], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    try:
        ready = process.stdout.readline().decode()
        host, _, port = ready.removeprefix("ready on ").strip().partition(":")
        assert host == "127.0.0.1"
        with socket.create_connection((host, int(port))) as browser:
            browser.sendall(b"POST / HTTP/1.1\r\nContent-Length: 2\r\n\r\n{}")
            assert browser.recv(1) == b""
        with socket.create_connection((host, int(port))) as client, client.makefile("rwb") as stream:
            for message in (
                {"id": 1, "method": "initialize", "params": {"processId": None, "rootUri": None, "capabilities": {}}},
                {"id": 2, "method": "shutdown"},
                {"method": "exit"},
            ):
                body = json.dumps({"jsonrpc": "2.0", **message}).encode()
                stream.write(b"Content-Length: %d\r\n\r\n%s" % (len(body), body))
            stream.flush()
            answers = stream.read().decode()
        assert '"serverInfo"' in answers
        assert answers.endswith('{"jsonrpc":"2.0","id":2,"result":null}')
        assert process.wait(10) == 0
    finally:
        process.kill()
        process.communicate()


class TestCall:
    def test_a_port_is_a_number(self, capsys):
        assert main(["lsp", "--tcp", "70000"]) == 2
        assert "--tcp 70000: a port is a number up to 65535" in capsys.readouterr().err

    def test_without_the_extra_it_says_what_to_install(self):
        code = (
            "import sys; sys.modules.update(pygls=None, lsprotocol=None);"
            "from elitescript import extras; extras.installed_version = lambda name: None;"
            "from elitescript.cli.main import main; sys.exit(main(['lsp']))"
        )
        found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
        assert found.returncode == 2
        assert found.stderr.strip().endswith("not installed: pip install 'elitescript[lsp]'")


def test_a_process_is_alive_until_it_has_ended():
    child = subprocess.Popen([sys.executable, "-c", "input()"], stdin=subprocess.PIPE)
    assert is_alive(child.pid)
    child.communicate(b"\n")
    assert not is_alive(child.pid)
