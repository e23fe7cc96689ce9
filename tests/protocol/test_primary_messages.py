"""Robot messages of the primary port, and which events become which."""

from __future__ import annotations

import random
from typing import get_args

import pytest

from elitescript.messages.enums import RobotMode, SafetyMode, TaskState
from elitescript.messages.events import (
    Alarm,
    Event,
    LineMarked,
    MotionEnded,
    Popup,
    Printed,
    RobotModeChanged,
    SafetyModeChanged,
    SignalChanged,
    TaskStateChanged,
    TextMessage,
    Warned,
)
from elitescript.protocol.primary import messages as primary_messages
from elitescript.protocol.primary.messages import (
    ERROR,
    FATAL,
    KINDS,
    MAX_TEXT_BYTES,
    SOURCE_CONTROLLER,
    SOURCE_SAFETY,
    VITAL_MAX,
    WAITING_MAX,
    WARNING,
    RobotMessage,
    RobotMessageQueue,
    error_message,
    exception_message,
    message_of,
    version_message,
)
from tests.protocol import primary_client as client
from tests.protocol.snapshots import description

ALARM = Alarm(250, "R100", "NameError", "name 'abcd' is not defined", 2, 5, "main")


def shown(event) -> dict:
    note = message_of(event)
    assert note is not None
    return client.robot_message(note.data)


class TestScriptException:
    def test_alarm_has_line_column_and_the_name_of_its_class(self):
        assert shown(ALARM) == {
            "timestamp": 1_000_000,
            "source": SOURCE_CONTROLLER,
            "kind": 10,
            "line": 2,
            "column": 5,
            "text": "NameError: name 'abcd' is not defined",
        }

    def test_bytes_are_the_known_ones(self):
        head = bytes.fromhex("0000001a 14 000000000000fa00 68 0a 00000007 ffffffff")
        assert exception_message(16, 7, -1, "ab").data == head + b"ab\0"

    def test_the_terminator_can_be_left_out(self):
        note = message_of(ALARM, terminator=b"")
        assert note is not None
        assert note.data.endswith(b"is not defined")


class TestRobotError:
    def test_bytes_are_the_known_ones(self):
        head = bytes.fromhex("00000022 14 0000000000000fa0 63 06 00000000 00000000 00000002 00000005")
        assert error_message(1, ERROR, "ab", SOURCE_SAFETY).data == head + b"ab\0"

    def test_exception_of_a_secondary_program_is_a_warning(self):
        message = shown(Warned(1, "[SEC] Exception: ValueError: no", "sec a", 3, is_exception=True))
        assert (message["kind"], message["level"], message["data_type"]) == (6, WARNING, 5)
        assert message["text"] == "[SEC] Exception: ValueError: no"

    def test_advice_on_a_line_of_a_program_is_a_text_and_no_error(self) -> None:
        advice = message_of(Warned(1, "the blend radius is shortened", "main", 3))
        assert advice is not None and not advice.is_vital
        assert advice.data[14] == 0
        assert advice.data[15:] == b"warning: line 3: the blend radius is shortened\0"
        refusal = message_of(Warned(1, "power on: refused"))
        assert refusal is not None and refusal.data[14] == 6

    @pytest.mark.parametrize(
        ("mode", "level", "text"),
        [
            (SafetyMode.PROTECTIVE_STOP, ERROR, "Protective stop: collision"),
            (SafetyMode.ROBOT_EMERGENCY_STOP, ERROR, "Robot emergency stop: collision"),
            (SafetyMode.SAFEGUARD_STOP, WARNING, "Safeguard stop: collision"),
            (SafetyMode.FAULT, FATAL, "Fault: collision"),
        ],
    )
    def test_stop_of_the_safety_system_comes_from_it(self, mode, level, text):
        message = shown(SafetyModeChanged(1, mode, "collision"))
        assert (message["source"], message["kind"], message["level"]) == (SOURCE_SAFETY, 6, level)
        assert message["text"] == text

    def test_stop_without_a_reason_is_its_name(self):
        assert shown(SafetyModeChanged(1, SafetyMode.VIOLATION))["text"] == "Violation"

    @pytest.mark.parametrize("mode", [SafetyMode.NORMAL, SafetyMode.REDUCED, SafetyMode.RECOVERY])
    def test_modes_in_which_the_arm_may_move_are_no_errors(self, mode):
        assert message_of(SafetyModeChanged(1, mode)) is None


class TestOtherKinds:
    def test_text_message(self):
        message = shown(TextMessage(1, "Grüße 你好", "main", 4))
        assert (message["kind"], message["text"]) == (0, "Grüße 你好")

    def test_a_warning_is_a_robot_error_of_that_level(self):
        message = shown(Warned(1, "the blend is too large"))
        assert (message["kind"], message["level"], message["text"]) == (6, 1, "the blend is too large")

    @pytest.mark.parametrize(
        ("level", "blocking", "flags"),
        [
            ("info", False, (0, 0, False, False, False)),
            ("warning", True, (0, 0, True, False, True)),
            ("error", False, (0, 0, False, True, False)),
        ],
    )
    def test_popup(self, level, blocking, flags):
        message = shown(Popup(1, "Part missing", "Feeder", level, blocking, False, "main", 3))
        assert (message["kind"], message["flags"]) == (2, flags)
        assert (message["title"], message["text"]) == ("Feeder", "Part missing")

    @pytest.mark.parametrize(
        ("state", "title"),
        [
            (TaskState.PLAYING, "PROGRAM_XXX_STARTED"),
            (TaskState.PAUSED, "PROGRAM_XXX_PAUSED"),
            (TaskState.STOPPED, "PROGRAM_XXX_STOPPED"),
        ],
    )
    def test_key_message_tells_of_the_program(self, state, title):
        message = shown(TaskStateChanged(1, state, "pick"))
        assert (message["kind"], message["title"], message["text"]) == (7, title, "pick")

    def test_version(self):
        message = client.robot_message(version_message(0, description()).data)
        assert (message["kind"], message["version"]) == (3, (2, 14, 2, 7))

    @pytest.mark.parametrize(
        "event",
        [
            Printed(1, "x", "main", 1),
            SignalChanged(1, "flag[0]", True),
            MotionEnded(1, True),
            RobotModeChanged(1, RobotMode.IDLE),
            LineMarked(1, 2, "a"),
            TaskStateChanged(1, TaskState.UNKNOWN, ""),
        ],
    )
    def test_clients_do_not_hear_of_the_rest(self, event):
        assert message_of(event) is None


class TestTexts:
    def test_a_long_text_is_cut_between_characters_and_says_so(self):
        message = shown(TextMessage(1, "é" * MAX_TEXT_BYTES, "main", 1))
        assert message["text"] == "é" * ((MAX_TEXT_BYTES - 3) // 2) + "..."

    def test_a_text_of_the_greatest_length_is_whole(self):
        assert shown(TextMessage(1, "x" * MAX_TEXT_BYTES, "main", 1))["text"] == "x" * MAX_TEXT_BYTES

    def test_a_long_title_fits_its_length_byte(self):
        message = shown(Popup(1, "text", "t" * 300, "info", False, False, "main", 1))
        assert (message["title"], message["text"]) == ("t" * 252 + "...", "text")

    @pytest.mark.parametrize("text", ["", "\udc80", "a\0b", "line\nline"])
    def test_any_text_can_be_sent(self, text):
        assert shown(TextMessage(1, text, "main", 1))["text"] == text.replace("\udc80", r"\udc80")


class TestTable:
    def test_numbers_differ(self):
        assert len({kind.number for kind in KINDS}) == len(KINDS)

    def test_only_what_clients_parse_is_documented(self):
        assert {kind.number for kind in KINDS if kind.evidence == "documented"} == {6, 10}

    def test_every_translated_event_exists(self):
        assert set(primary_messages._TRANSLATIONS) <= set(get_args(Event))

    def test_errors_and_starts_and_ends_are_vital_and_texts_are_not(self):
        vital = [ALARM, Warned(1, "[SEC] Exception: x", is_exception=True), SafetyModeChanged(1, SafetyMode.FAULT)]
        vital.append(TaskStateChanged(1, TaskState.PLAYING, "x"))
        others = [TextMessage(1, "x", "main", 1), Warned(1, "x")]
        notes = [message_of(event) for event in vital + others]
        assert [note is not None and note.is_vital for note in notes] == [True] * 4 + [False] * 2


class TestNoteQueue:
    def note(self, data: bytes, is_vital: bool = False) -> RobotMessage:
        return RobotMessage(data, is_vital)

    def drained(self, queue: RobotMessageQueue) -> list[bytes]:
        return [queue.take() for _ in range(len(queue))]

    def test_keeps_the_order(self):
        queue = RobotMessageQueue()
        for number in range(20):
            queue.put(self.note(bytes([number]), is_vital=number % 3 == 0), 0)
        assert self.drained(queue) == [bytes([number]) for number in range(20)]

    def test_goes_on_behind_a_gap_once_there_is_room(self):
        queue = RobotMessageQueue()
        for _ in range(WAITING_MAX + 7):
            queue.put(self.note(b"a"), 3)
        for _ in range(2):
            queue.take()
        queue.put(self.note(b"b"), 4)
        *before, gap, last = self.drained(queue)
        assert (len(before), last) == (WAITING_MAX - 2, b"b")
        assert b"warning: 7 robot messages are missing here" in gap
        assert queue.left_out == 7

    def test_nothing_is_left_out_without_being_counted(self):
        for seed in range(20):
            chance = random.Random(seed)
            queue, put, taken, missing = RobotMessageQueue(), 0, 0, 0
            for _ in range(4000):
                if chance.random() < 0.8 or not queue:
                    queue.put(self.note(b"x", is_vital=chance.random() < 0.3), 0)
                    put += 1
                elif (data := queue.take()) == b"x":
                    taken += 1
                else:
                    missing += int(data.split(b"warning: ")[1].split()[0])
                assert len(queue) <= VITAL_MAX + 1
            for data in self.drained(queue):
                if data == b"x":
                    taken += 1
                else:
                    missing += int(data.split(b"warning: ")[1].split()[0])
            assert put == taken + missing
            assert missing == queue.left_out > 0
