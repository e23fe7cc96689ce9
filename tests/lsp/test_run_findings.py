"""What the last run of a text has found is among its findings, marked as such, until it has run again."""

from __future__ import annotations

import re

import pytest

from elitescript.assist.document import Document
from elitescript.assist.last_run import LastRun, RunFinding
from elitescript.lsp import background
from elitescript.lsp.background import Outcome
from elitescript.lsp.findings import of_last_run, result_id
from elitescript.lsp.positions import UTF16, Positions
from elitescript.lsp.run_data import decoded, encoded
from elitescript.lsp.run_worker import outcome_of
from tests.lsp.memory_client import URI, span

PUSHED = "textDocument/publishDiagnostics"
SERVO = "def f():\n  q = get_actual_joint_positions()\n  q[0] = q[0] + 0.8\n  servoj(q, t=0.008)\nend\n"
SOUND = "def f():\n  sleep(0.1)\nend\n"
FOUND = RunFinding(4, 0, "warning", "W280", "the program ends early", "end with movej", 0.008, 1)
RAN = LastRun(SERVO, 1.0, findings=(FOUND,), ended="2026-01-02 03:04:05")


@pytest.mark.parametrize(
    ("text", "codes"),
    [
        (SERVO, ["W280"]),
        (SOUND, []),
        ("def f():\n  x = get_standard_digital_in(0) == 'on'\nend\n", []),
        ("def f():\n  n = len([])\n  for i in range(3):\n    sleep(0.1)\n  end\n  x = 1 / n\nend\n", ["R100"]),
    ],
)
def test_a_run_records_what_it_has_found_and_check_does_not_find(text, codes):
    last = decoded(outcome_of({"text": text, "name": "a.script", "folder": None}, is_jailed=False)["last"])
    assert [found.code for found in last.findings] == codes
    assert decoded(encoded(last)) == last


def shown(text: str, last: LastRun = RAN) -> list[tuple[int, int, str]]:
    found = of_last_run(last, Positions(Document("a.script", text), UTF16))
    return [(one.range.start.line, int(one.severity or 0), one.message) for one in found]


def test_it_is_marked_and_stands_at_its_line():
    (one,) = of_last_run(RAN, Positions(Document("a.script", SERVO), UTF16))
    assert (one.source, one.code, one.severity) == ("elitescript run", "W280", 2)
    assert one.message == ("last run, 2026-01-02 03:04:05: the program ends early (at 0.008 s)\nhint: end with movej")
    ends = (one.range.start, one.range.end)
    assert [(end.line, end.character) for end in ends] == [(3, 2), (3, 20)]


def test_in_a_text_that_has_changed_it_is_of_an_earlier_text_and_moves_with_its_line():
    ((line, severity, message),) = shown("# cell 3\n" + SERVO)
    assert (line, severity) == (4, 3)
    assert message.startswith("last run, 2026-01-02 03:04:05, of an earlier text: ")


def test_a_line_that_has_changed_has_none():
    assert shown(SERVO.replace("t=0.008", "t=0.016")) == []


def test_what_no_line_has_caused_stands_in_the_first():
    device = LastRun(SERVO, findings=(RunFinding(0, 0, "warning", "", "camera: no answer", "", 2.0, 3),), ended="now")
    assert shown(SERVO, device) == [(0, 2, "last run, now: camera: no answer (3 times, first at 2.000 s)")]


def test_the_number_of_a_result_changes_with_what_a_run_has_found():
    document = Document("a.script", SERVO)
    clean = LastRun(SERVO, ended="now")
    assert result_id(document, 1) == result_id(document, 1, clean) != result_id(document, 1, RAN)


class Runs:
    """Stands for the processes."""

    def __init__(self) -> None:
        self.findings: tuple[RunFinding, ...] = (FOUND,)

    async def __call__(self, request, wall_s):
        return Outcome({"state": "finished"}, LastRun(request["text"], 1.0, findings=self.findings), "")


@pytest.fixture
def runs(monkeypatch):
    made = Runs()
    monkeypatch.setattr(background, "run_in_process", made)
    monkeypatch.setattr(background, "QUIET_S", 3600.0)
    return made


def test_they_are_pushed_after_a_run_and_taken_back_by_a_clean_one(bare, runs):
    bare.initialize()
    bare.open(SERVO)
    assert bare.notification(PUSHED)["diagnostics"] == []
    run = {"command": "elitescript.server.run", "arguments": [URI]}
    bare.result("workspace/executeCommand", run)
    (found,) = bare.notification(PUSHED)["diagnostics"]
    assert (found["source"], found["range"]) == ("elitescript run", span(3, 2, 3, 20))
    assert re.match(r"last run, \d{4}-\d\d-\d\d \d\d:\d\d:\d\d: the program ends early", found["message"])
    runs.findings = ()
    bare.result("workspace/executeCommand", run)
    assert bare.notification(PUSHED)["diagnostics"] == []


def test_clients_that_ask_are_asked_to_ask_again(bare, runs):
    bare.initialize({"textDocument": {"diagnostic": {}}, "workspace": {"diagnostics": {"refreshSupport": True}}})
    bare.open(SERVO)
    asked = {"textDocument": {"uri": URI}}
    before = bare.result("textDocument/diagnostic", asked)
    assert before["items"] == []
    bare.result("workspace/executeCommand", {"command": "elitescript.server.run", "arguments": [URI]})
    bare.reply(bare.until(lambda message: message.get("method") == "workspace/diagnostic/refresh"), None)
    after = bare.result("textDocument/diagnostic", asked | {"previousResultId": before["resultId"]})
    assert [one["code"] for one in after["items"]] == ["W280"]
    again = bare.result("textDocument/diagnostic", asked | {"previousResultId": after["resultId"]})
    assert again["kind"] == "unchanged"
