"""Every message gets the answer that the protocol has for it, and no message stops the server."""

from __future__ import annotations

import json

import pytest

from elitescript.lsp import server as server_module
from elitescript.lsp.feature import Feature
from tests.lsp.memory_client import URI, at, change_params, span

HOVER = "textDocument/hover"


def hover_message(number, line=0):
    return {"id": number, "method": HOVER, "params": at(line, 0)}


class TestMalformed:
    @pytest.mark.parametrize(
        ("body", "code", "number"),
        [
            (b"", -32700, None),
            (b"{", -32700, None),
            (b"\xff\xfe", -32700, None),
            (b"[" * 100_000, -32700, None),
            (b"[]", -32600, None),
            (b"3", -32600, None),
            (b'{"id": 7, "method": "shutdown"}', -32600, 7),
            (b'{"jsonrpc": "1.0", "id": 7, "method": "shutdown"}', -32600, 7),
            (b'{"jsonrpc": "2.0", "id": 7}', -32600, 7),
            (b'{"jsonrpc": "2.0", "id": 7, "method": 5}', -32600, 7),
            (b'{"jsonrpc": "2.0", "id": [7], "method": "shutdown"}', -32600, None),
            (b'{"jsonrpc": "2.0", "id": true, "method": "shutdown"}', -32600, None),
            (b'{"jsonrpc": "2.0", "id": 7, "method": "textDocument/nonsense"}', -32601, 7),
            (b'{"jsonrpc": "2.0", "id": 7, "method": "textDocument/hover"}', -32602, 7),
            (b'{"jsonrpc": "2.0", "id": 7, "method": "textDocument/hover", "params": 5}', -32602, 7),
            (b'{"jsonrpc": "2.0", "id": 7, "method": "textDocument/hover", "params": {"textDocument": {}}}', -32602, 7),
            (b'{"jsonrpc": "2.0", "id": 7, "method": "$/nonsense"}', -32601, 7),
            (b'{"jsonrpc": "2.0", "id": 7, "method": "textDocument/didOpen", "params": {}}', -32601, 7),
        ],
    )
    def test_it_gets_the_error_of_the_protocol(self, client, body, code, number):
        client.received.clear()
        client.raw(body)
        [answer] = client.received
        assert (answer["error"]["code"], answer["id"]) == (code, number)
        client.open("x = 1\n")
        assert "error" not in client.ask(HOVER, at(0, 0))

    @pytest.mark.parametrize(
        "message",
        [
            {"method": "textDocument/didChange", "params": change_params({"text": "x"})},
            {"method": "textDocument/didChange", "params": {"textDocument": 5}},
            {"method": "textDocument/nonsense"},
            {"method": "$/nonsense", "params": {}},
            {"method": "$/cancelRequest", "params": {"id": 99}},
            {"method": "$/cancelRequest"},
            {"method": "window/workDoneProgress/cancel", "params": {"token": "no such"}},
            {"id": 12, "result": None},
            {"id": "no such", "error": {"code": 1, "message": "x"}},
        ],
    )
    def test_a_notification_or_an_answer_to_nothing_gets_none(self, client, message):
        client.received.clear()
        client.send(message)
        assert client.received == []
        client.open("x = 1\n")
        assert "error" not in client.ask(HOVER, at(0, 0))

    def test_a_place_that_is_no_number_is_refused(self, client):
        client.open("x = 1\n")
        for wrong in ("x", None, -1):
            params = {"textDocument": {"uri": URI}, "position": {"line": wrong, "character": 0}}
            assert client.ask(HOVER, params)["error"]["code"] == -32602, wrong

    def test_a_text_that_is_not_open_is_named(self, client):
        error = client.ask(HOVER, at(0, 0, "file:///other.script"))["error"]
        assert error["code"] == -32602
        assert "file:///other.script" in error["message"]


class TestBeginAndEnd:
    def test_before_initialize_requests_are_refused_and_notifications_left_out(self, bare):
        bare.open("x = 1\n")
        assert bare.ask(HOVER, at(0, 0))["error"]["code"] == -32002
        bare.initialize()
        assert bare.server.texts.open == {}

    def test_initialize_comes_once(self, client):
        assert client.ask("initialize", {"processId": None, "rootUri": None, "capabilities": {}})["error"]["code"] == (
            -32600
        )

    def test_after_shutdown_requests_are_refused(self, client):
        client.open("x = 1\n")
        assert client.result("shutdown") is None
        assert client.ask(HOVER, at(0, 0))["error"]["code"] == -32600

    @pytest.mark.parametrize("params", [None, {}, []])
    def test_shutdown_then_exit_is_code_0(self, client, params):
        assert client.result("shutdown", params) is None
        client.notify("exit")
        assert client.exit_code == 0

    def test_exit_alone_is_code_1(self, client):
        client.notify("exit")
        assert client.exit_code == 1

    def test_an_id_may_be_a_text(self, client):
        client.send({"id": "one", "method": "shutdown"})
        assert client.answer("one")["result"] is None

    def test_an_id_of_a_request_under_way_is_refused(self, client):
        client.open("x = 1\n")
        client.received.clear()
        client.send(hover_message(5), hover_message(5))
        assert sorted(json.dumps(client.answer(5).get("error", {}).get("code")) for _ in range(2)) == ["-32600", "null"]


class TestOrder:
    def test_a_request_is_answered_for_the_text_at_its_place(self, client):
        client.open("def p():\n  x = 1\nend\n")
        other = {"method": "textDocument/didChange", "params": change_params({"text": ""}, uri="file:///b.script")}
        client.open("", "file:///b.script")
        client.send(hover_message(1), other)
        assert "result" in client.answer(1)

    def test_a_cancelled_request_is_not_worked_at(self, client, monkeypatch):
        asked = []
        feature = Feature(lambda server, document, params: asked.append(params.position.line))
        monkeypatch.setitem(client.server.protocol.fm.features, HOVER, _answering(client, feature))
        client.open("x = 1\ny = 2\n")
        client.send(hover_message(1), hover_message(2, 1), {"method": "$/cancelRequest", "params": {"id": 1}})
        assert client.answer(1)["error"]["code"] == -32800
        assert client.answer(2)["result"] is None
        assert asked == [1]

    def test_a_request_about_a_text_that_has_changed_is_not_worked_at(self, client, monkeypatch):
        asked = []
        feature = Feature(lambda server, document, params: asked.append(params.position.line))
        monkeypatch.setitem(client.server.protocol.fm.features, HOVER, _answering(client, feature))
        client.open("x = 1\n")
        changed = {"method": "textDocument/didChange", "params": change_params({"text": "x = 2\n"})}
        client.send(hover_message(1), changed, hover_message(2))
        assert client.answer(1)["error"]["code"] == -32801
        assert client.answer(2)["result"] is None
        assert asked == [0]

    @pytest.mark.parametrize(
        ("late", "code"),
        [
            ({"method": "$/cancelRequest", "params": {"id": 1}}, -32800),
            ({"method": "textDocument/didChange", "params": change_params({"text": "x = 2\n"})}, -32801),
            ({"method": "textDocument/didClose", "params": {"textDocument": {"uri": URI}}}, -32801),
        ],
    )
    def test_what_comes_while_it_is_worked_at_counts_too(self, client, monkeypatch, late, code):
        """As from a thread that reads: the message waits in the loop when the answer is ready."""

        def slow(server, document, params):
            body = json.dumps({"jsonrpc": "2.0", **late}).encode()
            client.loop.call_soon_threadsafe(client.server.connection.receive, body)
            return {"contents": "too late"}

        monkeypatch.setitem(client.server.protocol.fm.features, HOVER, _answering(client, Feature(slow)))
        client.open("x = 1\n")
        client.send(hover_message(1))
        assert client.answer(1)["error"]["code"] == code
        assert not [message for message in client.received if message.get("id") == 1]

    def test_a_slow_request_can_be_cancelled_and_holds_no_other_up(self, client, monkeypatch):
        import asyncio

        async def endless(document, params):
            await asyncio.Event().wait()

        monkeypatch.setitem(client.server.connection.slow, "textDocument/diagnostic", endless)
        client.open("x = 1\n")
        client.send({"id": 1, "method": "textDocument/diagnostic", "params": {"textDocument": {"uri": URI}}})
        client.send(hover_message(2))
        assert "result" in client.answer(2)
        client.send({"method": "$/cancelRequest", "params": {"id": 1}})
        assert client.answer(1)["error"]["code"] == -32800


class TestMistakesOfTheServer:
    def test_an_exception_is_an_answer_and_is_logged(self, client, monkeypatch, log):
        def broken(server, document, params):
            raise ZeroDivisionError("oh")

        monkeypatch.setitem(client.server.protocol.fm.features, HOVER, _answering(client, Feature(broken)))
        client.open("x = 1\n")
        error = client.ask(HOVER, at(0, 0))["error"]
        assert error["code"] == -32603
        assert "ZeroDivisionError: oh" in error["message"]
        assert "textDocument/hover failed" in log.getvalue()
        assert "error" not in client.ask("textDocument/foldingRange", {"textDocument": {"uri": URI}})

    def test_an_exception_of_a_slow_request_too(self, client, monkeypatch, log):
        async def broken(document, params):
            raise ZeroDivisionError("oh")

        monkeypatch.setitem(client.server.connection.slow, "textDocument/diagnostic", broken)
        client.open("x = 1\n")
        assert client.ask("textDocument/diagnostic", {"textDocument": {"uri": URI}})["error"]["code"] == -32603
        assert "textDocument/diagnostic failed" in log.getvalue()

    def test_an_exception_on_a_notification_is_logged(self, client, monkeypatch, log):
        def broken(params):
            raise ZeroDivisionError("oh")

        monkeypatch.setitem(client.server.connection.notices, "textDocument/didSave", broken)
        client.received.clear()
        client.notify("textDocument/didSave", {"textDocument": {"uri": URI}})
        assert client.received == []
        assert "could not be handled" in log.getvalue()


def _answering(client, feature):
    return lambda document, params: server_module._answer(client.server, HOVER, feature, document, params)


def test_ranges_far_outside_are_no_mistake(client):
    client.open("x = 1\n")
    params = {"textDocument": {"uri": URI}, "range": span(5, 5, 900_000, 4_000_000)}
    assert client.result("textDocument/inlayHint", params) == []
