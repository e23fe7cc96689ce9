"""The verdict of an audit: its differences and the findings of the simulated program and its run, in one list."""

from __future__ import annotations

import pytest

from elitescript.audit import page as audit_pages
from elitescript.audit.auditing import Audit, audit
from tests.audit.recording_runs import record_run

MOVE = "def f():\n  movej([0.3, -1.3, -1.9, -1.5, 1.57, 0], a=1.4, v=1.0)\n  sleep(0.2)\nend\n"
PULSE = MOVE.replace("  sleep", "  set_standard_digital_out(0, True)\n  set_standard_digital_out(0, False)\n  sleep")
TEXT = MOVE.replace("  sleep", '  if get_standard_digital_in(0) == "on":\n    halt()\n  end\n  sleep')


def of(program: str, recorded: str = "", **settings: float) -> Audit:
    return audit(record_run(recorded or program, **settings), program)


def rows(found: Audit) -> list[tuple[str, str, str, int]]:
    return [(its.source, its.severity, its.code, its.line) for its in found.findings]


@pytest.mark.parametrize(
    ("program", "recorded", "verdict", "found"),
    [
        (MOVE, MOVE, "agrees", []),
        (PULSE, PULSE, "agrees, 1 warning", [("run", "warning", "W288", 4)]),
        (TEXT, TEXT, "agrees, 1 warning", [("check", "warning", "W240", 3)]),
        (MOVE, MOVE.replace("v=1.0", "v=0.2"), "differs, 1 warning", [("audit", "warning", "", 2)]),
        (
            TEXT,
            TEXT.replace("v=1.0", "v=0.2"),
            "differs, 2 warnings",
            [("audit", "warning", "", 2), ("check", "warning", "W240", 3)],
        ),
    ],
)
def test_list_and_verdict(program: str, recorded: str, verdict: str, found: list[tuple[str, str, str, int]]):
    made = of(program, recorded)
    assert rows(made) == found
    assert str(made).splitlines()[-1] == f"verdict: {verdict}"
    assert made.json()["verdict"]["words"] == verdict
    assert [row["code"] for row in made.json()["findings"]] == [code for _, _, code, _ in found]
    assert made.json()["verdict"]["warning"] == len(found)


def test_what_text_and_run_show_stands_before_the_verdict_and_differences_do_not_stand_twice():
    lines = str(of(TEXT, TEXT.replace("v=1.0", "v=0.2"))).splitlines()
    head = lines.index("found in the simulated program and its run:")
    assert lines[head + 1].startswith("  line 3, column 6: warning W240: ")
    assert len(lines) == head + 3


def test_a_part_of_a_run_is_no_clean_verdict():
    made = of(MOVE, until_s=0.5)
    assert (made.agrees, made.is_complete) == (True, False)
    assert str(made).splitlines()[-1] == "verdict: agrees as far as it is recorded, 1 warning"


def test_the_page_has_the_same_list_in_the_time_of_its_rows(monkeypatch):
    pages = []
    monkeypatch.setattr(audit_pages, "page_of", lambda *recordings: pages.append(recordings))
    made = of(PULSE)
    audit_pages.audit_page(made, "run.mcap")
    ((simulated, _),) = pages
    assert [(its.code, its.t) for its in simulated.findings] == [("W288", simulated.rows[0].t + made.findings[0].t)]
