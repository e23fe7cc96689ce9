"""The kernel from outside: inputs in, outputs out."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import get_args

import pytest

from elitescript.kernel import Kernel
from elitescript.kernel.handlers import HANDLERS
from elitescript.language.advice.unknown_names import OWN_PROGRAM
from elitescript.language.text.source import SourceFile
from elitescript.lint.engine import check_source
from elitescript.messages.enums import AnalogDomain, RobotMode, SafetyMode, TaskState
from elitescript.messages.events import Alarm, Popup, RobotModeChanged, TaskStateChanged, TextMessage, Warned
from elitescript.messages.inputs import (
    AddLog,
    ChannelOpened,
    ClosePopup,
    Do,
    Input,
    Reboot,
    RunUnit,
    SetRemote,
    ShowPopup,
)
from elitescript.messages.machine import (
    AskSafety,
    PauseTask,
    PowerOff,
    PowerOn,
    ReleaseBrakes,
    ResumeTask,
    SetAnalogDomain,
    SetSpeedScale,
    SetToolAnalogMode,
    StopTask,
    WritePortCoils,
    WritePortRegisters,
    WriteSignal,
)
from elitescript.messages.outcomes import Done, Refused, RegistersRead
from elitescript.messages.outputs import CloseChannel, Reply
from elitescript.messages.profile import profile
from elitescript.messages.snapshot import Snapshot
from elitescript.messages.state import RobotState
from elitescript.messages.timing import ticks_for
from tests.kernel.machine import FOREVER, READY, Session, program
from tests.messages.snapshot_fields import DISCRETE, FIELDS


class TestPower:
    def test_it_starts_without(self):
        assert Session().tick().snapshot.robot.robot_mode is RobotMode.POWER_OFF

    def test_it_goes_up_in_steps_that_take_their_time(self):
        session = Session()
        session.do(PowerOn())
        session.run(2.0)
        session.do(ReleaseBrakes())
        session.run(2.0)
        modes = [(event.tick, event.mode.name) for event in session.events if isinstance(event, RobotModeChanged)]
        assert modes == [(0, "POWER_ON"), (100, "BOOTING"), (300, "IDLE"), (751, "RUNNING")]

    def test_releasing_the_brakes_of_an_arm_without_power_does_both(self):
        session = Session()
        session.do(ReleaseBrakes())
        session.run(3.0)
        assert session.last.snapshot.robot.robot_mode is RobotMode.RUNNING

    def test_power_off_stops_the_program_and_the_arm(self):
        session = Session(READY)
        session.start("movej([1, -1.5, -1.5, -1.5, 1.5, 0], a=1, v=0.5)")
        session.run(1.0)
        session.do(PowerOff())
        session.run(2.0)
        robot = session.last.snapshot.robot
        assert (robot.robot_mode, robot.task_state) == (RobotMode.POWER_OFF, TaskState.STOPPED)
        assert not any(robot.qd_actual)

    def test_power_off_in_the_middle_of_powering_on(self):
        session = Session()
        session.do(ReleaseBrakes())
        session.run(0.6)
        session.do(PowerOff())
        session.run(3.0)
        assert session.last.snapshot.robot.robot_mode is RobotMode.POWER_OFF

    def test_a_refusal_says_what_to_do(self):
        session = Session()
        session.do(WriteSignal("emergency_stop", 0, True))
        output = session.do(PowerOn())
        (warning,) = [event for event in output.events if isinstance(event, Warned)]
        assert "release it" in warning.text

    def test_an_arm_that_is_being_switched_off_is_not_switched_on(self):
        session = Session(READY)
        session.start("movej([1, -1.5, -1.5, -1.5, 1.5, 0], a=1, v=0.5)")
        session.run(1.0)
        session.do(PowerOff())
        session.do(PowerOn())
        session.run(2.0)
        assert session.last.snapshot.robot.robot_mode is RobotMode.POWER_OFF
        assert "being switched off" in session.of(Warned)[0].text

    def test_nothing_flows_without_power(self):
        snapshot = Session().tick().snapshot
        assert not any((*snapshot.joint_voltages, *snapshot.joint_currents, snapshot.robot_current))

    def test_a_motion_without_power_is_an_alarm_that_says_what_to_do(self):
        session = Session()
        session.start("movej([1, -1.5, -1.5, -1.5, 1.5, 0])")
        (alarm,) = session.of(Alarm)
        assert (alarm.code, alarm.line) == ("R115", 2)
        assert "release the brakes" in alarm.details["hint"]

    def test_a_program_without_power_runs_and_may_stop_what_does_not_move(self):
        session = Session()
        session.start("stopj(8)", "end_freedrive_mode()", "end_force_mode()", "textmsg('on')")
        assert session.texts == ["on"]

    @pytest.mark.parametrize(
        ("call", "duration_s"),
        [
            ("servoj([0, -1.5, -1.5, -1.5, 1.5, 0], t=0.02)", 0.02),
            ("servoj([0, -1.5, -1.5, -1.5, 1.5, 0])", 0.004),
            ("speedj([0.1, 0, 0, 0, 0, 0], 1, 0.5)", 0.5),
            ("speedl([0.1, 0, 0, 0, 0, 0], 1, 0.5)", 0.5),
            ("speedl([0.1, 0, 0, 0, 0, 0], 1)", 0.004),
        ],
    )
    @pytest.mark.parametrize("mode", ["off", "idle"])
    def test_a_stream_without_power_takes_its_time_and_moves_nothing(self, call, duration_s, mode):
        session = Session()
        if mode == "idle":
            session.do(PowerOn())
            session.run(2.0)
        before = session.tick().snapshot.robot.q_actual
        session.start(f"{call}\n  textmsg('back')\n  {call}")
        session.run(duration_s + 0.1)
        assert session.of(TextMessage)[0].tick - session.of(TaskStateChanged)[0].tick == ticks_for(duration_s)
        assert session.of(Alarm) == []
        (warning,) = session.of(Warned)
        assert warning.line == 2
        assert "servoj, speedj and speedl return after their time and move nothing" in warning.text
        assert "release the brakes" in warning.hint
        assert session.last.snapshot.robot.q_actual == before

    def test_a_stream_from_before_moves_once_there_is_power(self):
        session = Session()
        session.start("while True:\n    speedj([0.1, 0, 0, 0, 0, 0], 1, 0.02)\n  end")
        session.run(0.2)
        session.do(PowerOn())
        session.do(ReleaseBrakes())
        session.run(4.0)
        assert session.of(Alarm) == []
        assert len(session.of(Warned)) == 1
        assert session.last.snapshot.robot.q_actual[0] > 0.05

    def test_a_stream_that_is_stopped_without_power_ends(self):
        session = Session()
        session.start("speedj([0.1, 0, 0, 0, 0, 0], 1, 60)")
        session.run(0.02)
        session.do(StopTask())
        session.tick()
        assert session.last.snapshot.robot.task_state is TaskState.STOPPED

    def test_a_program_from_before_moves_once_there_is_power(self):
        session = Session()
        session.start(
            "while get_standard_digital_in(0) == False:\n    sync()\n  end\n  movej([1, -1.5, -1.5, -1.5, 1.5, 0])"
        )
        session.do(ReleaseBrakes())
        session.run(3.0)
        session.do(WriteSignal("standard_digital_in", 0, True))
        session.run(6.0)
        assert session.last.snapshot.robot.q_actual[0] == pytest.approx(1.0)


def own_hint(event: Warned) -> str:
    """The hint that `check` gives for the file."""
    return event.hint.removeprefix(OWN_PROGRAM).strip(" ()")


class TestUnits:
    def test_a_program_replaces_the_running_one_in_the_same_tick(self):
        session = Session(READY)
        session.start(FOREVER, name="first")
        output = session.start("textmsg('second')", name="second")
        assert [event.text for event in output.events if isinstance(event, TextMessage)] == ["second"]

    def test_the_arm_brakes_when_its_program_is_replaced(self):
        session = Session(READY)
        session.start("movej([1, -1.5, -1.5, -1.5, 1.5, 0], a=1, v=0.5)")
        session.run(1.0)
        session.start("stopj(8)", "textmsg('still')")
        session.run(1.0)
        assert session.texts == ["still"]
        assert not session.last.snapshot.robot.is_moving

    def test_a_broken_program_is_an_alarm_and_leaves_the_running_one_alone(self):
        session = Session()
        session.start(FOREVER)
        session.send(RunUnit("primary#1", "program", "def bad():\n  x = 1 +\nend\n"))
        (alarm,) = session.of(Alarm)
        assert (alarm.class_name, alarm.line, alarm.column > 0) == ("SyntaxError", 2, True)
        assert session.last.snapshot.robot.task_state is TaskState.PLAYING

    def test_a_line_runs_like_a_program(self):
        session = Session()
        session.send(RunUnit("primary#1", "line", "textmsg('line')"))
        assert session.texts == ["line"]

    def test_a_line_that_calls_what_does_not_exist_leaves_the_running_program_alone(self):
        session = Session()
        session.start(FOREVER)
        session.send(RunUnit("primary#1", "line", "job()"))
        (alarm,) = session.of(Alarm)
        assert alarm.class_name == "NameError"
        assert session.last.snapshot.robot.task_state is TaskState.PLAYING

    def test_a_secondary_program_runs_beside_the_program(self):
        session = Session()
        session.start("global go\n  go = False\n  while not go:\n    sync()\n  end\n  textmsg('released')")
        session.send(RunUnit("primary#1", "secondary", "sec s():\n  global go\n  go = True\nend\n"))
        session.run(0.1)
        assert session.texts == ["released"]

    def test_a_broken_secondary_program_is_a_warning(self):
        session = Session()
        session.send(RunUnit("primary#1", "secondary", "sec s():\n  x = 1 +\nend\n"))
        (warning,) = session.of(Warned)
        assert warning.text.startswith("[SEC] Exception: SyntaxError")
        assert warning.is_exception

    def test_every_error_of_a_broken_secondary_program_has_the_prefix(self):
        session = Session()
        session.send(RunUnit("primary#1", "secondary", "sec s():\n  x = 1 +\n  y = = 2\nend\n"))
        first, second = session.of(Warned)
        assert (first.line, second.line) == (2, 3)
        assert second.text.startswith("[SEC] Exception: SyntaxError: ")
        assert first.is_exception and second.is_exception

    def test_what_the_compiler_warns_of_names_its_line_once(self):
        session = Session()
        session.send(RunUnit("primary#1", "program", 'def p():\n  print "a"\nend\n'))
        (warning,) = session.of(Warned)
        assert warning.line == 2
        assert (warning.code, warning.column, warning.severity) == ("E106", 3, "warning")
        assert "line" not in warning.text

    def test_what_else_does_not_compile_is_told_as_an_error(self):
        session = Session()
        session.send(RunUnit("primary#1", "program", "def p():\n  x = 0777\n  f = 1 <> 2\nend\n"))
        (warning,) = session.of(Warned)
        assert (warning.line, warning.column, warning.severity) == (3, 9, "error")
        assert (warning.code, warning.text, warning.hint) == ("E111", "`<>` is Python 2", "write != for 'is not equal'")

    @pytest.mark.parametrize("kind", ["program", "secondary"])
    def test_what_check_finds_is_told_in_the_same_words(self, kind):
        word = "sec" if kind == "secondary" else "def"
        text = f"{word} p():\n  sleeep = 1\n  set_standard_digital_out(99, True)\n  texmsg(1)\nend\n"
        session = Session()
        session.send(RunUnit("primary#1", kind, text))
        told = [
            (
                event.code,
                event.severity,
                event.line,
                event.column,
                event.text,
                own_hint(event) if event.hint.startswith(OWN_PROGRAM) else event.hint,
            )
            for event in session.of(Warned)
            if event.code
        ]
        # What stands beside a program in the file of its author is not there when it is sent.
        said = [event.hint.startswith(OWN_PROGRAM) for event in session.of(Warned) if event.code == "E301"]
        assert said == [kind == "program"]
        found = check_source(SourceFile("<p>", text), profile("2.14"))
        assert told == [(one.code, str(one.severity), one.line, one.column, one.text, one.hint) for one in found]
        assert {"E305", "E301"} <= {event[0] for event in told}

    def test_an_import_beside_a_program_that_is_sent_is_no_import_of_it(self):
        session = Session()
        session.send(RunUnit("primary#1", "program", "def p():\n  textmsg(math.pi)\nend\n"))
        hints = [event.hint for event in session.of(Warned) if event.code == "W201"]
        hints += [str(event.details["hint"]) for event in session.of(Alarm)]
        assert set(hints) == {f"write `import math` before it, inside its `def`: {OWN_PROGRAM}"}

    def test_findings_beyond_twenty_are_counted(self):
        session = Session()
        lines = "".join(f"  texmsg({number})\n" for number in range(23))
        session.send(RunUnit("primary#1", "program", f"def p():\n{lines}end\n"))
        *findings, last = session.of(Warned)
        assert len(findings) == 20
        assert last.text == "3 more findings: `elitescript check` shows all of them"

    def test_strictness_refuses_what_check_calls_an_error(self):
        session = Session(replace(READY, strict=True))
        session.send(RunUnit("primary#1", "program", "def p():\n  textmsg('runs')\n  texmsg(1)\nend\n"))
        (alarm,) = session.of(Alarm)
        assert (alarm.code, alarm.line, alarm.details) == ("E301", 3, {"hint": f"{OWN_PROGRAM} (is `textmsg` meant?)"})
        assert session.texts == []

    def test_a_program_in_protective_stop_is_refused_with_its_reason(self):
        session = Session(READY)
        session.do(AskSafety("stop_protectively", "a test"))
        session.start("textmsg('runs')")
        assert session.texts == []
        assert session.of(Alarm)[0].code == "R140"


class TestTheTask:
    def test_it_can_be_paused_resumed_and_stopped(self):
        session = Session()
        session.start(FOREVER)
        states = []
        for request in (PauseTask(), ResumeTask(), StopTask()):
            session.do(request)
            states.append(session.last.snapshot.robot.task_state.name)
        assert states == ["PAUSED", "PLAYING", "STOPPED"]

    def test_stopping_what_does_not_run_is_harmless(self):
        assert Session().do(StopTask()).events == ()

    def test_its_name_is_shown_while_it_runs(self):
        session = Session()
        session.start(FOREVER, name="job")
        assert session.last.snapshot.task.running == "job"
        session.do(StopTask())
        assert session.last.snapshot.task.running == ""


class TestSafety:
    def test_a_request_that_wants_an_answer_gets_one(self):
        session = Session(READY)
        asked = [
            (SetSpeedScale(0.5), Done()),
            (SetSpeedScale(2.0), Refused("cannot set the speed to 2: the speed percentage must be in [0, 1], got 2")),
            (WriteSignal("standard_digital_in", 3, True), Done()),
            (
                WriteSignal("standard_analog_in", 0, 99.0),
                Refused(
                    "cannot set standard_analog_in[0] to 99.0: "
                    "standard_analog_in[0] must be in [0, 10] V (voltage domain), got 99"
                ),
            ),
            (
                WriteSignal("standard_digital_in", 16, True),
                Refused("cannot set standard_digital_in[16] to True: there is no signal standard_digital_in[16]"),
            ),
            (StopTask(), Done()),
            (PauseTask(), Refused("cannot pause: no task is running")),
            (ResumeTask(), Refused("cannot resume: no task is paused")),
        ]
        for number, (request, _) in enumerate(asked):
            session.send(Do(f"ctl#1/{number}", request, is_answered=True))
            assert [reply.origin for reply in session.last.replies] == [f"ctl#1/{number}"]
        assert session.outcomes == [outcome for _, outcome in asked]

    def test_a_request_that_wants_none_gets_none(self):
        session = Session(READY)
        session.do(SetSpeedScale(0.5))
        session.do(SetSpeedScale(2.0))
        assert session.outcomes == []
        assert [event.text for event in session.of(Warned)] == [
            "cannot set the speed to 2: the speed percentage must be in [0, 1], got 2"
        ]

    def test_an_open_safeguard_keeps_a_task_from_going_on_and_says_so(self):
        session = Session(READY)
        session.start(FOREVER)
        session.do(PauseTask())
        session.do(WriteSignal("safeguard_stop", 0, True))
        session.send(Do("ctl#1/1", ResumeTask(), is_answered=True))
        assert session.outcomes == [
            Refused("cannot resume task: the safeguard is open; close it (signal safeguard_stop to False)")
        ]

    def test_an_emergency_stop_is_no_protective_stop(self):
        session = Session(READY)
        session.do(WriteSignal("emergency_stop", 0, True))
        session.send(Do("ctl#1/1", AskSafety("unlock_protective_stop"), is_answered=True))
        [outcome] = session.outcomes
        assert "there is no protective stop to unlock; the emergency stop is pressed; release it" in outcome.reason

    def test_unlocking_is_answered_to_whoever_asked(self):
        session = Session(READY)
        session.do(AskSafety("stop_protectively", "a test"))
        session.run(1.0)
        early = session.send(Do("dashboard#2/7", AskSafety("unlock_protective_stop"), is_answered=True))
        session.run(5.0)
        late = session.send(Do("dashboard#2/8", AskSafety("unlock_protective_stop"), is_answered=True))
        assert isinstance(early.replies[0].outcome, Refused)
        assert late.replies == (Reply("dashboard#2/8", Done()),)
        assert late.snapshot.robot.safety_mode is SafetyMode.NORMAL

    def test_a_restart_of_the_safety_system_takes_the_power_in_every_state(self):
        session = Session(READY)
        session.do(AskSafety("restart_safety"))
        session.run(0.5)
        robot = session.last.snapshot.robot
        assert (robot.safety_mode, robot.robot_mode) == (SafetyMode.NORMAL, RobotMode.POWER_OFF)

    def test_an_unknown_action_or_point_is_a_warning(self):
        session = Session()
        session.do(AskSafety("dance"))
        session.do(WriteSignal("standard_digital_in", 16, True))
        session.do(WriteSignal("no_such", 0, True))
        session.do(SetSpeedScale(2.0))
        assert len(session.of(Warned)) == 4


class TestWindows:
    def test_a_blocking_popup_waits_until_it_is_closed(self):
        session = Session()
        session.start("popup('sure?', blocking=True)", "textmsg('confirmed')")
        session.run(1.0)
        assert (session.texts, session.last.snapshot.popup) == ([], "sure?")
        session.send(ClosePopup("dashboard#1"))
        assert (session.texts, session.last.snapshot.popup) == (["confirmed"], "")

    def test_a_blocking_popup_goes_with_its_program(self):
        session = Session()
        session.start("popup('sure?', blocking=True)")
        session.do(StopTask())
        assert session.tick().snapshot.popup == ""

    def test_one_can_be_shown_and_closed_from_outside(self):
        session = Session()
        shown = session.send(ShowPopup("dashboard#1", "hello"))
        assert (shown.snapshot.popup, [event.text for event in shown.events]) == ("hello", ["hello"])
        assert isinstance(shown.events[0], Popup)
        assert session.send(ClosePopup("dashboard#1")).snapshot.popup == ""

    def test_a_line_can_be_added_to_the_log(self):
        session = Session()
        session.send(AddLog("dashboard#1", "shift begins"))
        assert session.texts == ["shift begins"]


class TestTheController:
    def test_every_kind_of_input_is_handled(self):
        assert set(get_args(Input)) == set(HANDLERS)

    def test_remote_control_is_switched(self):
        session = Session()
        assert session.tick().snapshot.is_remote
        assert not session.send(SetRemote("ctl", False)).snapshot.is_remote

    def test_a_reboot_ends_everything(self):
        session = Session(READY)
        session.do(AskSafety("stop_protectively", "a test"))
        session.send(ShowPopup("ctl", "hello"))
        session.run(0.1)
        session.send(Reboot("ctl"))
        session.run(0.1)
        snapshot = session.last.snapshot
        assert (snapshot.robot.robot_mode, snapshot.robot.safety_mode) == (RobotMode.POWER_OFF, SafetyMode.NORMAL)
        assert snapshot.popup == ""

    def test_serial_ports_outlive_a_program_and_end_with_a_reboot(self):
        session = Session(READY)
        session.start("tool_serial_config(True, 9600, 0, 1)", name="a")
        session.send(ChannelOpened(1, True))
        session.run(0.1)
        assert session.last.requests == ()
        session.start("textmsg(tool_serial_mode())", name="b")
        assert session.texts == ["RS485"]
        assert CloseChannel(1) in session.send(Reboot("ctl")).requests

    def test_the_same_inputs_give_the_same_outputs(self):
        def outputs():
            session = Session(READY)
            session.start("textmsg(random())", "movej([1, -1.5, -1.5, -1.5, 1.5, 0], v=0.5)", name="a")
            found = [session.tick() for _ in range(200)]
            return [session.first, *found, session.send(program(FOREVER)), session.do(PauseTask()), session.tick()]

        assert outputs() == outputs()


class TestModbus:
    def test_a_write_is_answered_and_done(self):
        session = Session()
        output = session.send(Do("modbus#1/1", WritePortRegisters(256, (7, 8)), is_answered=True))
        assert output.replies == (Reply("modbus#1/1", Done()),)
        assert output.snapshot.signals["general_register"][:3] == (7, 8, 0)

    def test_a_write_shows_what_is_asked_for_right_after_it(self):
        session = Session()
        session.send(
            Do("modbus#1/1", WritePortRegisters(256, (7,), 255, 3), is_answered=True),
            Do("modbus#2/1", WritePortRegisters(256, (65535,), 256, 1), is_answered=True),
        )
        assert session.outcomes == [RegistersRead((0, 7, 0)), RegistersRead((65535,))]

    def test_a_write_that_makes_no_sense_is_refused_as_a_whole(self):
        session = Session()
        output = session.send(Do("modbus#1/1", WritePortRegisters(15, (1, 13)), is_answered=True))
        (outcome,) = session.outcomes
        assert "register 16: the tool voltage is 0, 12 or 24 V, got 13" in outcome.reason
        assert len(session.of(Warned)) == 1
        assert output.snapshot.domains["tool_analog_out"] == (1,)

    def test_nobody_is_answered_who_does_not_ask(self):
        output = Session().send(Do("ctl", WritePortCoils(60, (True,))), Do("ctl", WritePortCoils(0, (True,))))
        assert output.replies == ()
        assert output.snapshot.signals["general_coil"][0] is True

    def test_a_program_and_a_client_shake_hands(self):
        session = Session(READY)
        session.start("while not read_port_bit(60):", "  sync()", "end", "write_port_register(257, 5)")
        session.run(0.1)
        assert session.last.snapshot.signals["general_register"][1] == 0
        session.do(WritePortCoils(60, (True,)))
        session.run(0.02)
        assert session.last.snapshot.signals["general_register"][1] == 5


class TestSnapshot:
    """The machine as its ports show it is a call of its own, which changes nothing."""

    PROGRAM = (
        "set_standard_digital_out(1, True)",
        "movej([0.2, -1.4, -1.7, -1.6, 1.57, 0], a=1.4, v=1.05)",
        "movel(pose_trans(get_actual_tcp_pose(), [0, 0, 0.02, 0, 0, 0]), a=1.2, v=0.25)",
        "textmsg(get_tcp_force(), get_actual_joint_positions())",
        "sleep(0.2)",
    )

    def test_a_tick_without_it_says_the_same(self):
        always, seldom = Kernel(READY), Kernel(READY)
        for tick in range(1500):
            inputs = [program(*self.PROGRAM)] if tick == 3 else ()
            output, result = always.tick_and_snapshot(inputs), seldom.tick(inputs)
            assert result.with_snapshot(output.snapshot) == output
            if tick % 97 == 0:
                assert seldom.snapshot() == output.snapshot

    def test_shows_the_tick_that_has_run_as_often_as_it_is_called(self):
        kernel = Kernel(READY)
        assert (kernel.next_tick, kernel.tick().tick, kernel.next_tick) == (0, 0, 1)
        assert kernel.snapshot() == kernel.snapshot()
        assert (kernel.snapshot().robot.tick, kernel.next_tick, kernel.tick().tick) == (0, 1, 1)

    def test_every_field_is_of_its_tick_or_discrete(self):
        names = {field.name for kind in (Snapshot, RobotState) for field in fields(kind)} - {"robot"}
        of_their_tick = {name for in_part in FIELDS.values() for name in in_part}
        assert names == of_their_tick | DISCRETE
        assert not of_their_tick & DISCRETE

    def test_while_the_discrete_state_is_the_same_so_are_its_fields(self):
        changes = [
            Do("x", PowerOff()),
            Do("x", PowerOn()),
            Do("x", ReleaseBrakes()),
            program("sleep(0.1)", 'popup("read me", "title")', "sleep(0.1)", "set_tcp([0, 0, 0.1, 0, 0, 0])"),
            Do("x", PauseTask()),
            Do("x", ResumeTask()),
            ClosePopup("x"),
            program("set_payload(1, [0, 0, 0.1])", "sleep(0.1)", "set_gravity([0, 0, -9.7])", "sleep(0.1)"),
            program("set_tool_voltage(24)", "sleep(0.1)", "set_tool_digital_mode(1)", "sleep(0.1)"),
            program("freedrive_mode()", "sleep(0.2)", "end_freedrive_mode()"),
            Do("x", WriteSignal("external_wrench", 0, 30.0)),
            # The arm comes to rest later, without an event.
            program("freedrive_mode()", "sleep(0.1)", "end_freedrive_mode()", "sleep(0.1)"),
            Do("x", WriteSignal("external_wrench", 0, 0.0)),
            Do("x", SetSpeedScale(0.3)),
            SetRemote("x", False),
            Do("x", WriteSignal("standard_analog_in", 0, 3.5)),
            Do("x", SetAnalogDomain("standard_analog_in", 0, AnalogDomain.CURRENT)),
            Do("x", SetToolAnalogMode(1)),
            Do("x", AskSafety("stop_protectively", "a test")),
            Do("x", AskSafety("unlock_protective_stop", "a test")),
            Reboot("x"),
        ]
        kernel = Kernel(READY)
        steps = kept = 0
        state: tuple[object, ...] = ()
        shown: dict[str, object] = {}
        for tick in range(100 * (len(changes) + 1)):
            number, rest = divmod(tick, 100)
            kernel.tick([changes[number - 1]] if number and not rest else ())
            snapshot, now = kernel.snapshot(), kernel.discrete_state()
            made_anew = kernel._snapshot_builder().discrete_state()
            assert now[: len(made_anew)] == made_anew
            kept += now is state
            before = shown
            shown = {
                name: getattr(snapshot, name, None) if hasattr(snapshot, name) else getattr(snapshot.robot, name)
                for name in DISCRETE
            }
            if now == state:
                assert shown == before, [name for name in DISCRETE if shown[name] != before.get(name)]
            steps += now != state
            state = now
        assert steps > len(changes)
        # While nothing happens it is not made anew.
        assert kept > 0.9 * 100 * len(changes)


class TestFindings:
    """What `check` finds in programs of clients, in the log."""

    TEXT = "def job():\n  def never():\n    a(subprocess)\n    b(subprocess)\n    c(other)\n  end\nend\n"

    def told(self, session: Session) -> list[tuple[str, int]]:
        return [(event.text, event.line) for event in session.of(Warned) if event.code == "W201"]

    def test_equal_ones_are_told_once_with_their_lines(self):
        session = Session(READY)
        session.send(RunUnit("primary#1", "program", self.TEXT))
        assert self.told(session) == [
            ("the name `subprocess` is not defined (also in line 4)", 3),
            ("the name `other` is not defined", 5),
        ]

    def test_those_of_a_text_that_comes_again_are_not_told_again(self):
        session = Session(READY)
        for number in range(5):
            session.send(RunUnit(f"primary#{number}", "program", self.TEXT))
            session.run(0.02)
        assert len(self.told(session)) == 2
        session.send(RunUnit("primary#9", "program", self.TEXT.replace("c(other)", "c(others)")))
        assert len(self.told(session)) == 4

    def test_what_does_not_compile_is_refused_each_time(self):
        session = Session(READY)
        for _ in range(3):
            session.send(RunUnit("primary#1", "program", "def job():\n  x = = 1\nend\n"))
        assert len(session.of(Alarm)) == 3
