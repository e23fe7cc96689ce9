"""The log that clients download."""

from __future__ import annotations

from elitescript.messages.enums import RobotMode, SafetyMode, TaskState
from elitescript.messages.events import (
    Alarm,
    Popup,
    Printed,
    RobotModeChanged,
    SafetyModeChanged,
    SignalChanged,
    TaskLoaded,
    TaskStateChanged,
    TextMessage,
    Warned,
)
from elitescript.services.ssh import controller_history
from elitescript.services.ssh.controller_history import ControllerHistory


def history() -> ControllerHistory:
    return ControllerHistory(lambda: 1_700_000_000.25)


def test_each_kind_of_event_is_a_row() -> None:
    log = history()
    for event in (
        RobotModeChanged(1, RobotMode.RUNNING),
        TaskLoaded(2, "a.task"),
        TaskStateChanged(3, TaskState.PLAYING, "a"),
        TextMessage(4, 'says "hello", twice', "main", 3),
        Popup(5, "press", "title", "warning", True, False, "main", 4),
        Warned(6, "slow", code="W201"),
        Alarm(7, "R101", "ScriptError", "no", 5, 1, "main"),
        SafetyModeChanged(8, SafetyMode.PROTECTIVE_STOP, "joint 2"),
        SafetyModeChanged(9, SafetyMode.NORMAL),
    ):
        log.take(event)
    stamp = "2023-11-14 22:13:20.250"
    assert log.text().decode().splitlines() == [
        "time,level,source,code,text",
        f"{stamp},info,robot,,robot mode RUNNING",
        f"{stamp},info,task,,loaded: a.task",
        f"{stamp},info,task,,playing: a",
        f'{stamp},info,script,,"says ""hello"", twice"',
        f"{stamp},warning,popup,,press",
        f"{stamp},warning,script,W201,slow",
        f"{stamp},error,script,R101,ScriptError in line 5: no",
        f"{stamp},error,safety,,safety mode PROTECTIVE_STOP: joint 2",
        f"{stamp},info,safety,,safety mode NORMAL",
    ]


def test_what_is_no_message_of_the_controller_is_not_in_it() -> None:
    log = history()
    log.take(SignalChanged(1, "standard_digital_out[0]", True))
    log.take(Printed(1, "x", "main", 1))
    assert log.text() == b"time,level,source,code,text\n"


def test_the_oldest_rows_go_and_texts_are_cut() -> None:
    log = history()
    for number in range(controller_history.ROWS_MAX + 2):
        log.take(TextMessage(1, f"{number} " + "x" * 1000, "main", 1))
    rows = log.text().decode().splitlines()
    assert len(rows) == controller_history.ROWS_MAX + 1
    assert ",2 xxx" in rows[1] and len(rows[1]) < 600


def test_text_that_no_encoding_has_is_written_all_the_same() -> None:
    log = history()
    log.take(TextMessage(1, "a\udc80\n", "main", 1))
    assert b"a?" in log.text()
