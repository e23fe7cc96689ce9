"""Programs run in processes of their own: when it is quiet, the newest text, and never for long."""

from __future__ import annotations

import asyncio
from pathlib import Path
from urllib.request import url2pathname

import pytest

from elitescript.assist.last_run import LastRun
from elitescript.lsp import background
from elitescript.lsp.background import Outcome, run_in_process
from elitescript.lsp.connection import RequestFailed
from tests.lsp.memory_client import URI, span

PROGRAM = "def p():\n  movej([0, -1.5, 0, -1.57, 0, 0])\n  textmsg(1)\nend\n"
HINTS = {"textDocument": {"uri": URI}, "range": span(0, 0, 9, 0)}


class Runs:
    """Stands for the processes: says what was asked, and ends when it is told to."""

    def __init__(self) -> None:
        self.asked: list[dict] = []
        self.killed = 0
        self.release = asyncio.Event()

    async def __call__(self, request, wall_s):
        self.asked.append(request)
        try:
            await self.release.wait()
        except asyncio.CancelledError:
            self.killed += 1
            raise
        return Outcome({"state": "finished"}, LastRun(request["text"], 1.0), "")


@pytest.fixture
def runs(bare, monkeypatch):
    monkeypatch.setattr(background, "QUIET_S", 0.0)
    monkeypatch.setattr(background, "SHOWN_AFTER_S", 0.0)
    made = Runs()
    monkeypatch.setattr(background, "run_in_process", made)
    return made


def passes(client, turns=8):
    """Let the loop go on, as long as nothing has to be waited for."""

    async def go_on():
        for _ in range(turns):
            await asyncio.sleep(0)

    client.loop.run_until_complete(go_on())


def until(client, condition):
    async def wait():
        while not condition():
            await asyncio.sleep(0.001)

    client.loop.run_until_complete(asyncio.wait_for(wait(), 20))


class TestWhen:
    def test_a_text_runs_when_it_is_quiet(self, bare, runs):
        bare.initialize({"workspace": {"inlayHint": {"refreshSupport": True}, "codeLens": {"refreshSupport": True}}})
        bare.open(PROGRAM)
        until(bare, lambda: runs.asked)
        runs.release.set()
        for method in ("workspace/inlayHint/refresh", "workspace/codeLens/refresh"):
            bare.reply(bare.until(lambda message, method=method: message.get("method") == method), None)
        assert bare.server.last_run(URI).text == PROGRAM

    def test_not_while_somebody_types(self, bare, runs, monkeypatch):
        monkeypatch.setattr(background, "QUIET_S", 3600.0)
        bare.initialize()
        bare.open(PROGRAM)
        passes(bare)
        assert runs.asked == []

    def test_the_run_of_an_older_text_is_killed(self, bare, runs):
        bare.initialize()
        bare.open(PROGRAM)
        until(bare, lambda: runs.asked)
        bare.change({"range": span(2, 10, 2, 11), "text": "2"})
        until(bare, lambda: len(runs.asked) == 2)
        runs.release.set()
        until(bare, lambda: bare.server.last_run(URI))
        assert runs.killed == 1
        assert bare.server.last_run(URI).text == PROGRAM.replace("(1)", "(2)")

    @pytest.mark.parametrize("how", ["close", "shutdown", "settings"])
    def test_it_ends_with_its_text(self, bare, runs, how):
        bare.initialize()
        bare.open(PROGRAM)
        until(bare, lambda: runs.asked)
        if how == "close":
            bare.notify("textDocument/didClose", {"textDocument": {"uri": URI}})
        elif how == "settings":
            bare.notify("workspace/didChangeConfiguration", {"settings": {"hints.run": False}})
        else:
            bare.result("shutdown")
        until(bare, lambda: runs.killed)
        passes(bare)
        assert len(runs.asked) == 1

    def test_one_runs_at_a_time(self, bare, runs):
        bare.initialize()
        bare.open(PROGRAM)
        bare.open(PROGRAM, "file:///b.script")
        until(bare, lambda: runs.asked)
        passes(bare)
        assert len(runs.asked) == 1
        runs.release.set()
        until(bare, lambda: len(runs.asked) == 2)

    def test_the_setting_turns_it_off(self, bare, runs):
        bare.initialize(initializationOptions={"hints": {"run": False}})
        bare.open(PROGRAM)
        passes(bare)
        assert runs.asked == []

    def test_it_has_the_settings_of_its_folder(self, bare, runs):
        bare.initialize(initializationOptions={"robot": "CS63", "firmware": "2.10", "strict": True})
        bare.open(PROGRAM)
        until(bare, lambda: runs.asked)
        assert runs.asked[0]["options"] == {"model": "CS63", "firmware": "2.10", "strict": True}
        assert runs.asked[0]["folder"] == str(Path("/cells/one"))


class TestProgress:
    def test_it_is_shown_and_can_be_cancelled(self, bare, runs):
        bare.initialize({"window": {"workDoneProgress": True}})
        bare.open(PROGRAM)
        created = bare.until(lambda message: message.get("method") == "window/workDoneProgress/create")
        bare.reply(created, None)
        begun = bare.notification("$/progress")
        token = created["params"]["token"]
        assert begun == {"token": token, "value": {"kind": "begin", "title": "Run a.script", "cancellable": True}}
        bare.notify("window/workDoneProgress/cancel", {"token": token})
        assert bare.notification("$/progress") == {"token": token, "value": {"kind": "end"}}
        until(bare, lambda: runs.killed == 1)

    def test_a_run_on_request_that_is_cancelled_says_so(self, bare, runs, monkeypatch):
        monkeypatch.setattr(background, "QUIET_S", 3600.0)
        bare.initialize({"window": {"workDoneProgress": True}})
        bare.open(PROGRAM)
        asked = bare.request_message(
            "workspace/executeCommand", {"command": "elitescript.server.run", "arguments": [URI]}
        )
        bare.send(asked)
        created = bare.until(lambda message: message.get("method") == "window/workDoneProgress/create")
        bare.reply(created, None)
        bare.notification("$/progress")
        bare.notify("window/workDoneProgress/cancel", {"token": created["params"]["token"]})
        assert bare.answer(asked["id"])["error"]["code"] == -32803

    def test_a_closed_text_ends_a_run_on_request_and_its_progress(self, bare, runs, monkeypatch):
        monkeypatch.setattr(background, "QUIET_S", 3600.0)
        bare.initialize({"window": {"workDoneProgress": True}})
        bare.open(PROGRAM)
        asked = bare.request_message(
            "workspace/executeCommand", {"command": "elitescript.server.run", "arguments": [URI]}
        )
        bare.send(asked)
        created = bare.until(lambda message: message.get("method") == "window/workDoneProgress/create")
        bare.reply(created, None)
        bare.notification("$/progress")
        bare.notify("textDocument/didClose", {"textDocument": {"uri": URI}})
        assert bare.notification("$/progress")["value"] == {"kind": "end"}
        assert bare.answer(asked["id"])["error"]["code"] == -32803
        assert runs.killed == 1

    def test_a_late_answer_to_a_request_that_was_given_up_is_nothing(self, bare, runs, log):
        bare.initialize({"window": {"workDoneProgress": True}})
        bare.open(PROGRAM)
        created = bare.until(lambda message: message.get("method") == "window/workDoneProgress/create")
        bare.notify("textDocument/didClose", {"textDocument": {"uri": URI}})
        until(bare, lambda: runs.killed)
        passes(bare)
        bare.reply(created, None)
        assert log.getvalue() == ""
        assert created["id"] not in bare.server.connection._request_futures

    def test_a_cancelled_request_kills_its_run(self, bare, runs, monkeypatch):
        monkeypatch.setattr(background, "QUIET_S", 3600.0)
        bare.initialize()
        bare.open(PROGRAM)
        asked = bare.request_message(
            "workspace/executeCommand", {"command": "elitescript.server.run", "arguments": [URI]}
        )
        bare.send(asked)
        until(bare, lambda: runs.asked)
        bare.notify("$/cancelRequest", {"id": asked["id"]})
        assert bare.answer(asked["id"])["error"]["code"] == -32800
        until(bare, lambda: runs.killed == 1)


def test_the_commands_run_in_a_real_process(bare, tmp_path):
    uri = (tmp_path / "cell.script").as_uri()
    bare.initialize()
    bare.open(PROGRAM, uri)
    ask = "workspace/executeCommand"
    report = bare.result(ask, {"command": "elitescript.server.plot", "arguments": [uri]})
    assert (report["state"], report["log"], report["alarms"]) == ("finished", ["1"], [])
    page = Path(url2pathname(report["page"].removeprefix("file://")))
    assert page.name == "cell.plot.html"
    assert page.read_text(encoding="utf-8").startswith("<!DOCTYPE html>")
    asked = {"textDocument": {"uri": uri}, "range": span(0, 0, 9, 0)}
    assert any(hint["label"].endswith(" s") for hint in bare.result("textDocument/inlayHint", asked))
    bare.result("shutdown")
    assert not page.exists()


def test_a_process_that_hangs_is_killed():
    """A number of a hundred million digits is one call of Python, which nothing but a signal ends."""
    request = {"text": "def p():\n  x = 10 ** 100000000 // 7\nend\n", "name": "a.script"}
    with pytest.raises(RequestFailed, match=r"more than 0\.5 s"):
        asyncio.run(run_in_process(request, 0.5))
