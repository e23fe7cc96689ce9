"""Findings are pushed to clients that do not ask: at once for a new text, after a pause while somebody types."""

from __future__ import annotations

import asyncio
import gc
from threading import Event

import pytest

from elitescript.assist import actions, outline
from elitescript.language.text.source import SourceFile
from elitescript.lint import engine
from elitescript.lint.engine import check_source
from elitescript.lsp import findings
from elitescript.messages.profile import profile
from tests.lsp.memory_client import URI, span

PUSHED = "textDocument/publishDiagnostics"
WRONG = 'def p():\n  textmesg("\U0001f916", nonsense)\n  x = 1\n  print "x"\nend\n'
RELATED = {"textDocument": {"publishDiagnostics": {"relatedInformation": True}}}


def pushed(client):
    return client.notification(PUSHED)


def test_they_are_those_of_check(bare):
    bare.initialize(RELATED)
    bare.open(WRONG)
    found = pushed(bare)
    expected = check_source(SourceFile("a.script", WRONG), profile())
    assert (found["uri"], found["version"]) == (URI, 1)
    assert [(one["code"], one["message"]) for one in found["diagnostics"]] == [
        (problem.code, problem.text) for problem in expected
    ]
    assert {one["source"] for one in found["diagnostics"]} == {"elitescript"}
    assert all(one["data"]["template"] and "values" in one["data"] for one in found["diagnostics"])
    assert {one["severity"] for one in found["diagnostics"] if one["code"].startswith("E3")} == {1}
    nonsense = next(one for one in found["diagnostics"] if "nonsense" in one["message"])
    assert nonsense["range"] == span(1, 17, 1, 25)
    textmesg = next(one for one in found["diagnostics"] if "textmesg" in one["message"])
    [hint] = [one["message"] for one in textmesg["relatedInformation"]]
    assert "textmsg" in hint


def test_the_hint_is_in_the_message_if_the_client_shows_no_related_places(bare):
    bare.initialize()
    bare.open(WRONG)
    textmesg = next(one for one in pushed(bare)["diagnostics"] if "textmesg" in one["message"])
    assert "relatedInformation" not in textmesg
    assert "\nhint: " in textmesg["message"]


def test_only_the_newest_version_is_pushed(bare):
    bare.initialize()
    bare.open(WRONG)
    bare.change({"text": "def p():\n  x = 1\nend\n"}, version=2)
    bare.change({"text": "def p():\n  y = 2\nend\n"}, version=3)
    found = pushed(bare)
    assert (found["version"], found["diagnostics"]) == (3, [])


def test_they_wait_while_somebody_types(bare, monkeypatch):
    monkeypatch.setattr(findings, "PAUSE_S", 3600.0)
    bare.initialize()
    bare.open(WRONG)
    assert pushed(bare)["version"] == 1
    bare.change({"text": "def p():\n  x = 1\nend\n"})
    assert bare.result("textDocument/foldingRange", {"textDocument": {"uri": URI}})
    assert not [message for message in bare.received if message.get("method") == PUSHED]


def test_a_closed_text_has_none_any_more(bare):
    bare.initialize()
    bare.open(WRONG)
    assert pushed(bare)["diagnostics"]
    bare.notify("textDocument/didClose", {"textDocument": {"uri": URI}})
    assert pushed(bare) == {"uri": URI, "diagnostics": []}


def test_asking_for_those_of_a_text_that_was_just_closed_is_no_mistake(bare):
    """VS Code does so, and would show the error of a mistake to the user."""
    bare.initialize({"textDocument": {"diagnostic": {}}})
    bare.open(WRONG)
    bare.notify("textDocument/didClose", {"textDocument": {"uri": URI}})
    assert bare.ask("textDocument/diagnostic", {"textDocument": {"uri": URI}})["error"]["code"] == -32801


def test_nothing_is_due_after_the_end(bare, monkeypatch):
    monkeypatch.setattr(findings, "PAUSE_S", 3600.0)
    bare.initialize()
    bare.open(WRONG)
    bare.change({"text": "x = 1\n"})
    bare.result("shutdown")
    assert bare.server._findings._timers == {}


def test_settings_that_change_are_a_reason_to_look_again(bare):
    bare.initialize()
    bare.open('def p():\n  print "x"\nend\n')
    assert {one["severity"] for one in pushed(bare)["diagnostics"]} == {2}
    bare.notify("workspace/didChangeConfiguration", {"settings": {"elitescript": {"strict": True}}})
    assert {one["severity"] for one in pushed(bare)["diagnostics"]} == {1}


@pytest.mark.parametrize("refreshes", [True, False])
def test_nothing_is_pushed_to_a_client_that_asks(bare, refreshes):
    refresh = {"diagnostics": {"refreshSupport": refreshes}}
    bare.initialize({"textDocument": {"diagnostic": {}}, "workspace": refresh})
    bare.open('def p():\n  print "x"\nend\n')
    first = bare.result("textDocument/diagnostic", {"textDocument": {"uri": URI}})
    bare.received.clear()
    bare.notify("workspace/didChangeConfiguration", {"settings": {"elitescript": {"strict": True}}})
    asked = {"textDocument": {"uri": URI}, "previousResultId": first["resultId"]}
    assert bare.result("textDocument/diagnostic", asked)["kind"] == "full"
    assert [message["method"] for message in bare.received if "method" in message] == (
        ["workspace/diagnostic/refresh"] if refreshes else []
    )


def test_all_safe_repairs_are_one_action(bare):
    bare.initialize()
    text = "def p():\n  local x = 1\n  local y = x\n  textmsg(y)\nend\n"
    bare.open(text)
    context = {"diagnostics": [], "only": ["source.fixAll"]}
    asked = {"textDocument": {"uri": URI}, "range": span(0, 0, 0, 0), "context": context}
    [action] = bare.result("textDocument/codeAction", asked)
    assert action["kind"] == "source.fixAll"
    changes = action["edit"]["changes"][URI]
    bare.change(*[{"range": one["range"], "text": one["newText"]} for one in reversed(changes)])
    assert bare.text() == text.replace("local ", "")


def test_the_thread_has_texts_of_its_own(bare, monkeypatch):
    """What is known of a text is found without locks, so two threads may not share it."""
    seen = []

    def seeing(result):
        def see(first, *_):
            seen.extend([first] if hasattr(first, "text") else first)
            return result

        return see

    monkeypatch.setattr(findings, "diagnostics", seeing(()))
    monkeypatch.setattr(actions, "code_actions", seeing(()))
    monkeypatch.setattr(outline, "workspace_symbols", seeing(()))
    bare.initialize()
    bare.open(WRONG)
    pushed(bare)
    named = {"textDocument": {"uri": URI}}
    bare.result("textDocument/diagnostic", named)
    bare.result("textDocument/codeAction", {**named, "range": span(0, 0, 0, 0), "context": {"diagnostics": []}})
    bare.result("workspace/diagnostic", {"previousResultIds": []})
    bare.result("workspace/symbol", {"query": ""})
    assert [document.text for document in seen] == [WRONG] * 5
    assert bare.server.texts.open[URI] not in seen
    assert len(set(map(id, seen))) == 1


IN_TURN = 'def p():\n  sleep("x" + "y")\n  x = nonsense\nend\n'
"""What `nonsense` is needs no values of expressions, what `sleep` gets does."""


@pytest.fixture
def gate(monkeypatch):
    """Returns an event for which the thread waits before it looks for all findings of a text."""
    monkeypatch.setattr(findings, "TOGETHER_S", 0.0)
    opened, look = Event(), findings.diagnostics

    def wait(document):
        assert opened.wait(20)
        return look(document)

    monkeypatch.setattr(findings, "diagnostics", wait)
    yield opened
    opened.set()


def codes_of(message):
    return [(one["code"], one["range"]["start"]["line"]) for one in message["diagnostics"]]


def test_what_needs_no_values_comes_first_and_all_in_a_second_message(bare, gate):
    bare.initialize()
    bare.open(IN_TURN)
    assert codes_of(pushed(bare)) == [("W201", 2)]
    gate.set()
    found = pushed(bare)
    assert (found["version"], codes_of(found)) == (1, [("E304", 1), ("W201", 2)])


def test_there_is_one_message_where_all_is_found_soon(bare, monkeypatch):
    monkeypatch.setattr(findings, "TOGETHER_S", 20.0)
    bare.initialize()
    bare.open(IN_TURN)
    assert codes_of(pushed(bare)) == [("E304", 1), ("W201", 2)]
    assert not [message for message in bare.received if message.get("method") == PUSHED]


def test_the_first_message_keeps_what_was_found_in_lines_that_have_not_changed(bare, gate):
    bare.initialize()
    gate.set()
    bare.open(IN_TURN)
    while codes_of(pushed(bare)) != [("E304", 1), ("W201", 2)]:
        pass
    gate.clear()
    bare.change({"range": span(0, 0, 0, 0), "text": "# moves\n"}, version=2)
    assert codes_of(pushed(bare)) == [("W201", 3), ("E304", 2)]
    bare.change({"range": span(2, 8, 2, 17), "text": "1"}, version=3)
    gate.set()
    assert codes_of(pushed(bare)) == [("W201", 3)]


def test_nothing_of_an_older_version_comes_after_a_newer_one(bare, gate):
    bare.initialize()
    bare.open(IN_TURN)
    assert pushed(bare)["version"] == 1
    bare.change({"range": span(2, 6, 2, 14), "text": "other"}, version=2)
    gate.set()
    found = [pushed(bare), pushed(bare)]
    assert [one["version"] for one in found] == [2, 2]
    assert [codes_of(one) for one in found] == [[("W201", 2)], [("E304", 1), ("W201", 2)]]


def test_what_is_found_in_an_older_version_is_given_up(bare, monkeypatch):
    """The first rule that needs values waits until the text has changed: no rule is asked behind it."""
    seen, reached, changed = [], Event(), Event()
    look = engine._rules

    def rules(program):
        for rule in look(program):
            if rule.needs_values and not changed.is_set():
                reached.set()
                assert changed.wait(20)
            seen.append((program.source.text.count("nonsense"), rule.needs_values))
            yield rule

    monkeypatch.setattr(engine, "_rules", rules)
    bare.initialize()
    bare.open(IN_TURN)
    bare.loop.run_until_complete(asyncio.to_thread(reached.wait, 20))
    bare.change({"text": "def p():\n  x = 1\nend\n"}, version=2)
    changed.set()
    while pushed(bare)["version"] != 2:
        pass
    assert [needs for count, needs in seen if count].count(True) == 1


def test_a_change_that_changes_nothing_gives_nothing_up(bare, gate):
    bare.initialize()
    bare.open(IN_TURN)
    assert pushed(bare)["version"] == 1
    bare.change(version=1)
    gate.set()
    while codes_of(pushed(bare)) != [("E304", 1), ("W201", 2)]:
        pass


@pytest.mark.parametrize("refreshes", [True, False])
def test_a_client_that_asks_gets_the_rest_when_it_can_be_told_to_ask_again(bare, gate, refreshes):
    bare.initialize({"textDocument": {"diagnostic": {}}, "workspace": {"diagnostics": {"refreshSupport": refreshes}}})
    bare.open(IN_TURN)
    named = {"textDocument": {"uri": URI}}
    if refreshes:
        first = bare.result("textDocument/diagnostic", named)
        assert [one["code"] for one in first["items"]] == ["W201"]
        gate.set()
        bare.reply(bare.until(lambda message: message.get("method") == "workspace/diagnostic/refresh"), None)
        found = bare.result("textDocument/diagnostic", named | {"previousResultId": first["resultId"]})
    else:
        gate.set()
        found = bare.result("textDocument/diagnostic", named)
    assert [one["code"] for one in found["items"]] == ["E304", "W201"]
    again = bare.result("textDocument/diagnostic", named | {"previousResultId": found["resultId"]})
    assert again["kind"] == "unchanged"


def test_a_cancelled_request_leaves_no_error_behind(bare, gate, log, monkeypatch):
    monkeypatch.setattr(findings, "TOGETHER_S", 20.0)
    reached, look = Event(), findings.diagnostics

    def reach(document):
        reached.set()
        return look(document)

    monkeypatch.setattr(findings, "diagnostics", reach)
    bare.initialize({"textDocument": {"diagnostic": {}}})
    bare.open(IN_TURN)
    asked = bare.request_message("textDocument/diagnostic", {"textDocument": {"uri": URI}})
    bare.send(asked)
    bare.loop.run_until_complete(asyncio.to_thread(reached.wait, 20))
    bare.notify("$/cancelRequest", {"id": asked["id"]})
    assert bare.answer(asked["id"])["error"]["code"] == -32800
    bare.change({"text": "def p():\n  x = 1\nend\n"}, version=2)
    gate.set()
    assert bare.result("textDocument/diagnostic", {"textDocument": {"uri": URI}})["items"] == []
    gc.collect()
    assert not log.getvalue()
