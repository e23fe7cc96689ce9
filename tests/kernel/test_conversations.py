"""Interpreter mode and the query port through a kernel."""

from __future__ import annotations

from dataclasses import replace

import pytest

from elitescript.kernel import RobotOptions
from elitescript.messages.enums import TaskState
from elitescript.messages.events import Alarm
from elitescript.messages.inputs import Interpret, InterpreterWord, Query, RunUnit
from elitescript.messages.machine import PauseTask, ResumeTask, StopTask
from elitescript.messages.outcomes import Outcome, QueryFailed, ShownValue
from elitescript.messages.outputs import Reply
from elitescript.protocol.interpreter import reply_text
from tests.kernel.machine import FOREVER, READY, Session

HOST = ("global g", "g = 1", "x = 10", "interpreter_mode()", "textmsg('left ', g, ' ', x)")


class Talk(Session):
    """A session with a program in interpreter mode."""

    def __init__(self, *lines: str, config: RobotOptions = READY) -> None:
        super().__init__(config)
        if lines:
            self.start(*lines)

    def say(self, *lines: str) -> list[str]:
        """Send lines in one tick; return what is answered in this tick and the next."""
        before = len(self.replies)
        self.send(*(Interpret("interpreter#1", line) for line in lines))
        self.tick()
        return self.replies[before:]

    def word(self, word: str) -> str:
        """Send a word; return its answer."""
        return "".join(reply_text(reply.outcome) for reply in self.send(InterpreterWord("interpreter#1", word)).replies)


class TestSkipping:
    def test_what_has_not_begun_is_thrown_away_at_once(self):
        talk = Talk(*HOST)
        talk.say("sleep(0.1)", "g = 5", "g = 6")
        assert talk.word("stateunexecuted") == "state: 2: stateunexecuted"
        assert talk.word("skipbuffer") == ""
        assert talk.word("stateunexecuted") == "state: 0: stateunexecuted"
        assert talk.word("statelastcleared") == "state: 3: statelastcleared"
        assert talk.word("statelastexecuted") == "state: 1: statelastexecuted"
        assert talk.say("end_interpreter()") == ["ack: 4: end_interpreter()"]
        talk.run(0.2)
        assert talk.texts == ["left 1 10"]

    def test_it_makes_room(self):
        talk = Talk("sleep(100)", config=RobotOptions(firmware="2.10"))
        talk.send(*(Interpret("interpreter#1", "0") for _ in range(2001)))
        talk.run(1.0)
        talk.word("skipbuffer")
        assert talk.say("0") == ["ack: 2001: 0"]

    def test_the_statement_that_runs_is_not_touched(self):
        talk = Talk(*HOST)
        talk.say("sleep(0.1); g = 7", "g = 8")
        talk.word("skipbuffer")
        talk.say("end_interpreter()")
        talk.run(0.2)
        assert talk.texts == ["left 7 10"]

    def test_what_waits_behind_a_clearing_statement_is_answered_and_thrown_away_too(self):
        talk = Talk(*HOST)
        talk.say("sleep(0.1)", "clear_interpreter()")
        assert talk.say("textmsg('held')", "1 +", "clear_interpreter()", "textmsg('held')") == []
        talk.word("skipbuffer")
        assert [reply.partition(":line")[0] for reply in talk.replies[-4:]] == [
            "ack: 3: textmsg('held')",
            "discard: Compile error",
            "ack: 4: clear_interpreter()",
            "ack: 5: textmsg('held')",
        ]
        assert talk.say("textmsg('later')") == ["ack: 6: textmsg('later')"]
        talk.run(0.2)
        assert talk.texts == ["later"]

    def test_also_when_that_one_runs_already(self):
        talk = Talk(*HOST)
        talk.say("sleep(0.1); clear_interpreter()", "textmsg('held')")
        talk.word("skipbuffer")
        assert talk.say("textmsg('later')") == []
        talk.run(0.2)
        assert talk.replies[-2:] == ["ack: 2: textmsg('held')", "ack: 3: textmsg('later')"]
        assert talk.texts == ["later"]

    def test_without_a_program_there_is_nothing_to_skip(self):
        talk = Talk()
        assert talk.word("skipbuffer") == ""
        assert talk.word("statelastcleared") == "state: 0: statelastcleared"


class TestMany:
    def test_statements_are_taken_a_few_in_a_tick_and_in_their_order(self):
        talk = Talk("interpreter_mode()")
        talk.send(*(Interpret("interpreter#1", f"textmsg({number})") for number in range(500)))
        assert 0 < len(talk.replies) < 100
        talk.run(0.5)
        assert talk.replies == [f"ack: {number + 1}: textmsg({number})" for number in range(500)]
        assert talk.texts == [str(number) for number in range(500)]

    def test_a_word_is_obeyed_after_the_statements_before_it(self):
        talk = Talk("interpreter_mode()")
        talk.send(
            *(Interpret("interpreter#1", "sync()") for _ in range(200)),
            InterpreterWord("interpreter#1", "statelastinterpreted"),
        )
        talk.run(0.5)
        assert talk.replies[-1] == "state: 200: statelastinterpreted"

    def test_aborting_does_not_wait(self):
        talk = Talk("movej([0.2, -1.5, -1.5, -1.5, 1.5, 0], a=0.1, v=0.1)", "textmsg('aborted')")
        talk.send(
            *(Interpret("interpreter#1", "sync()") for _ in range(5000)), InterpreterWord("interpreter#1", "abort")
        )
        talk.run(0.2)
        assert talk.texts == ["aborted"]

    def test_those_that_are_too_many_are_discarded_at_once(self):
        talk = Talk("interpreter_mode()")
        talk.send(*(Interpret("interpreter#1", f"sleep({number})") for number in range(9000)))
        assert "discard: Too many interpreted messages: sleep(8999)" in talk.replies

    def test_queries_are_taken_a_few_in_a_tick_and_all_are_answered(self):
        talk = Talk()
        talk.send(*(Query(f"query#1/{number}", "1 + 1") for number in range(300)))
        assert 0 < len(talk.outcomes) < 30
        talk.run(1.0)
        assert talk.outcomes == [ShownValue("2")] * 300

    def test_queries_that_are_too_many_fail_at_once(self):
        talk = Talk()
        talk.send(*(Query(f"query#1/{number}", "1 + 1") for number in range(2000)))
        failed = QueryFailed(is_compiled=True, why="1000 requests wait already")
        assert Reply("query#1/1999", failed) in talk.last.replies


class TestStatements:
    def test_they_read_and_change_globals_and_the_variables_of_the_caller(self):
        talk = Talk(*HOST)
        talk.say("g = g + 1", "x = x + g", "end_interpreter()")
        assert talk.texts == ["left 2 12"]

    def test_what_is_new_is_seen_by_later_statements_until_it_is_cleared(self):
        talk = Talk(*HOST)
        talk.say("y = 5", "textmsg(y)", "clear_interpreter()", "textmsg(y)")
        assert talk.texts == ["5"]
        assert talk.of(Alarm)[0].class_name == "NameError"

    def test_new_names_are_no_globals_of_the_program(self):
        talk = Talk("global g", "g = 1", "interpreter_mode(clearOnEnd=False)", "sync()")
        assert talk.say("global z; z = 1")[0].startswith("discard: Compile error:line 1, column 1, ")

    def test_a_function_uses_globals_and_other_functions(self):
        talk = Talk(*HOST)
        talk.say("def a(n): ; global g ; g = n ; end", "def b(): ; a(7) ; end", "b()", "end_interpreter()")
        assert talk.texts == ["left 7 10"]

    def test_the_program_can_call_an_injected_function_while_it_exists(self):
        kept = Talk("interpreter_mode(clearOnEnd=False)", "f()")
        kept.say("def f(): ; textmsg('called') ; end", "end_interpreter()")
        gone = Talk("interpreter_mode()", "f()")
        gone.say("def f(): ; textmsg('called') ; end", "end_interpreter()")
        assert (kept.texts, gone.texts) == (["called"], [])
        assert gone.of(Alarm)[0].class_name == "NameError"

    def test_a_failing_statement_is_an_alarm_of_the_program_at_the_call(self):
        talk = Talk(*HOST)
        talk.say("1 / 0")
        (alarm,) = talk.of(Alarm)
        assert (alarm.class_name, alarm.line) == ("ZeroDivisionError", 5)
        assert "statement of interpreter mode" in alarm.text

    def test_a_program_that_catches_what_a_statement_raises_goes_on_without_the_session(self):
        talk = Talk("try:", "  interpreter_mode()", "except ZeroDivisionError:", "  textmsg('caught')", "sleep(1)")
        assert talk.say("1 / 0", "g = 3") == ["ack: 1: 1 / 0", "ack: 2: g = 3", "discard: Cleaned up after end: g = 3"]
        assert talk.texts == ["caught"]
        assert talk.word("state") == "state: 0: stopped: state"

    def test_what_waits_behind_a_failing_statement_is_discarded_and_so_is_what_comes_after(self):
        talk = Talk(*HOST)
        assert talk.say("1 / 0", "g = 3")[-1] == "discard: Cleaned up after end: g = 3"
        assert talk.say("g = 4") == ["discard: Task is in an invalid state: g = 4"]

    @pytest.mark.parametrize("line", ["start_thread(f, ())", "def a():", "end", "return 1", "f.__globals__"])
    def test_what_cannot_be_a_statement_is_discarded(self, line):
        assert Talk(*HOST).say(line)[0].startswith("discard: Compile error:")

    def test_one_moves_the_arm_and_the_next_waits_for_it(self):
        talk = Talk(*HOST)
        talk.say("movej([0.2, -1.5, -1.5, -1.5, 1.5, 0])", "textmsg('there')")
        assert talk.texts == []
        talk.run(5.0)
        assert talk.texts == ["there"]
        assert talk.last.snapshot.robot.q_actual[0] == pytest.approx(0.2)

    def test_many_take_several_ticks(self):
        talk = Talk("global g", "g = 1", "sleep(1)", "interpreter_mode(clearQueueOnEnter=False)")
        talk.send(*(Interpret("interpreter#1", "g = g + 1") for _ in range(120)))
        talk.run(0.9)
        counts = [talk.word("stateunexecuted").split(": ")[1] for _ in range(50)]
        assert list(dict.fromkeys(counts)) == ["120", "70", "20", "0"]


class TestQueue:
    def test_what_came_before_the_session_is_cleared_when_it_begins(self):
        talk = Talk("sleep(1)", "interpreter_mode()")
        assert talk.say("textmsg(1)") == ["ack: 1: textmsg(1)"]
        talk.run(1.0)
        assert talk.replies[-1] == "discard: Cleaned up before interpretation: textmsg(1)"

    def test_or_runs(self):
        talk = Talk("sleep(1)", "interpreter_mode(clearQueueOnEnter=False)")
        talk.say("textmsg(1)")
        talk.run(1.0)
        assert talk.texts == ["1"]

    def test_what_waits_at_the_end_is_cleared(self):
        talk = Talk(*HOST)
        assert talk.say("end_interpreter()", "g = 3")[-1] == "discard: Cleaned up after end: g = 3"
        assert talk.texts == ["left 1 10"]

    def test_what_waits_when_somebody_else_clears_is_discarded(self):
        talk = Talk(*HOST)
        talk.say("sleep(1)", "g = 3")
        talk.send(RunUnit("primary#1", "secondary", "sec s():\n  clear_interpreter()\nend\n"))
        assert talk.replies[-1] == "discard: Cleaned up: g = 3"

    def test_a_second_clearing_holds_back_what_follows_it(self):
        talk = Talk(*HOST)
        talk.say("sleep(0.1); clear_interpreter()", "sleep(0.1); clear_interpreter()", "g = 3")
        talk.run(0.15)
        assert talk.replies[-1] == "ack: 2: sleep(0.1); clear_interpreter()"
        talk.run(0.15)
        assert talk.replies[-1] == "ack: 3: g = 3"

    def test_a_line_that_is_no_text_is_discarded_in_its_turn(self):
        talk = Talk(*HOST)
        talk.send(Interpret("a", "g = 2"), Interpret("a", "?", "the line is not UTF-8 at byte 0"), Interpret("a", "g"))
        assert talk.replies == [
            "ack: 1: g = 2",
            "discard: Compile error:the line is not UTF-8 at byte 0 : ?",
            "ack: 2: g",
        ]

    def test_nothing_is_answered_between_a_clearing_and_its_execution(self):
        talk = Talk(*HOST)
        assert talk.say("sleep(1)", "clear_interpreter()", "g = 3") == [
            "ack: 1: sleep(1)",
            "ack: 2: clear_interpreter()",
        ]
        talk.run(1.1)
        assert talk.replies[-1] == "ack: 3: g = 3"

    def test_it_is_bounded(self):
        talk = Talk("sleep(100)", config=RobotOptions(firmware="2.10"))
        talk.send(*(Interpret("interpreter#1", "0") for _ in range(2001)))
        talk.run(1.0)
        assert talk.replies[-1] == "discard: Too many interpreted messages: 0"
        assert talk.replies[-2] == "ack: 2000: 0"

    def test_numbers_begin_anew_with_each_program(self):
        talk = Talk(*HOST)
        talk.say("g = 2")
        talk.start(*HOST)
        assert talk.say("g = 2") == ["ack: 1: g = 2"]

    def test_the_end_of_the_program_answers_what_waits(self):
        talk = Talk(*HOST)
        talk.say("sleep(5)", "g = 2", "clear_interpreter()", "g = 3")
        talk.do(StopTask())
        assert talk.replies[-3:] == [
            "discard: Cleaned up after end: g = 2",
            "discard: Cleaned up after end: clear_interpreter()",
            "discard: Task is in an invalid state: g = 3",
        ]


class TestSessions:
    def test_pause_and_resume_act_on_it(self):
        talk = Talk(*HOST)
        talk.do(PauseTask())
        talk.say("textmsg('on')")
        talk.run(0.1)
        assert talk.texts == []
        talk.do(ResumeTask())
        talk.tick()
        assert talk.texts == ["on"]

    def test_a_thread_can_end_it(self):
        talk = Talk("def t():\n    sleep(0.5)\n    end_interpreter()\n  end", "start_thread(t, ())", *HOST)
        talk.run(1.0)
        assert talk.texts == ["left 1 10"]

    def test_it_cannot_be_nested(self):
        talk = Talk(*HOST)
        talk.say("interpreter_mode()")
        assert talk.of(Alarm)[0].code == "R115"

    def test_another_session_may_follow(self):
        talk = Talk("interpreter_mode()", "interpreter_mode()", "textmsg('over')")
        assert talk.say("end_interpreter()") == ["ack: 1: end_interpreter()"]
        talk.say("end_interpreter()")
        assert talk.texts == ["over"]


class TestWords:
    def test_state(self):
        talk = Talk()
        assert talk.word("state") == "state: 0: stopped: state"
        talk.start(*HOST)
        assert talk.word("state") == "state: 0: running: state"

    @pytest.mark.parametrize(
        ("motion", "is_aborted"),
        [
            ("movej([1, -1.5, -1.5, -1.5, 1.5, 0], v=0.1)", True),
            ("movel(pose_trans(get_target_tcp_pose(), [0, 0, -0.1, 0, 0, 0]), v=0.02)", True),
            ("p = get_target_tcp_pose(); movec(pose_trans(p, [0.02, 0.02, 0, 0, 0, 0]), "
             "pose_trans(p, [0, 0.04, 0, 0, 0, 0]), v=0.01)", False),
            ("movep(pose_trans(get_target_tcp_pose(), [0, 0, -0.1, 0, 0, 0]), v=0.02)", False),
            ("sleep(3)", False),
        ],
    )  # fmt: skip
    def test_abort_ends_movej_and_movel_and_nothing_else(self, motion, is_aborted):
        talk = Talk("movej([0, -1.3, -1.6, -1.6, 1.5, 0])", *HOST)
        talk.run(4.0)
        assert talk.say(motion, "textmsg('next')")[-1] == "ack: 2: textmsg('next')"
        talk.run(0.5)
        assert talk.word("stateunexecuted") == "state: 1: stateunexecuted"
        talk.word("abort")
        talk.run(1.0)
        assert (talk.texts, talk.of(Alarm)) == ((["next"] if is_aborted else []), [])

    def test_abort_ends_the_move_and_the_program_goes_on(self):
        talk = Talk("movej([1, -1.5, -1.5, -1.5, 1.5, 0], v=0.1)", "textmsg('on')")
        talk.run(1.0)
        talk.word("abort")
        talk.run(1.0)
        assert talk.texts == ["on"]
        assert talk.last.snapshot.robot.q_actual[0] < 0.5

    def test_cleared_statements_are_numbered(self):
        talk = Talk(*HOST)
        talk.say("g = 2", "clear_interpreter()")
        assert talk.word("statelastcleared") == "state: 2: statelastcleared"

    def test_so_are_those_that_the_begin_of_a_session_clears(self):
        talk = Talk("sleep(0.1)", "interpreter_mode()")
        talk.say("g = 2", "g = 3")
        assert talk.word("statelastcleared") == "state: 0: statelastcleared"
        talk.run(0.1)
        assert talk.word("statelastcleared") == "state: 2: statelastcleared"

    def test_so_are_those_that_its_end_clears(self):
        talk = Talk("interpreter_mode()", "sleep(1)")
        talk.say("g = 2", "end_interpreter()", "g = 3")
        assert talk.word("statelastcleared") == "state: 3: statelastcleared"


class TestQueries:
    def ask(self, session: Session, text: str) -> list[Outcome]:
        before = len(session.outcomes)
        session.send(Query("query#1/1", text))
        session.run(0.2)
        return session.outcomes[before:]

    @pytest.mark.parametrize(
        ("text", "reply"),
        [
            ("1 + 2", ShownValue("3")),
            ("get_standard_digital_in(0)", ShownValue("False")),
            ("[get_steptime(), 'a']", ShownValue("[0.004, 'a']")),
            ("no_such_name", QueryFailed(is_compiled=True)),
            ("sleep(1)", QueryFailed(is_compiled=True)),
            ("movej([0, 0, 0, 0, 0, 0])", QueryFailed(is_compiled=True)),
            ("[0 for i in iter(int, 1)]", QueryFailed(is_compiled=True)),
            ("halt()", QueryFailed(is_compiled=True)),
            ("1 +", QueryFailed(is_compiled=False)),
            ("x = 1", QueryFailed(is_compiled=False)),
        ],
    )
    def test_each_gets_one_answer(self, text, reply):
        (outcome,) = self.ask(Session(), text)
        assert replace(outcome, why="") == reply if isinstance(outcome, QueryFailed) else outcome == reply

    @pytest.mark.parametrize(
        ("text", "why"),
        [
            ("no_such_name", "NameError: name 'no_such_name' is not defined"),
            ("sleep(1)", "sleep"),
            ("[0 for i in iter(int, 1)]", "it was stopped: it ended itself, or took more than 0.1 s of robot time"),
            ("'x' * 70000", "the value has 70002 characters, 65536 are allowed"),
            ("halt()", "it was stopped: it ended itself"),
            ("1 / 0", "ZeroDivisionError: "),
            ("1 +", "something is missing behind `+`"),
            ("x = 1", "expression"),
        ],
    )
    def test_a_failure_has_its_reason(self, text, why):
        (outcome,) = self.ask(Session(), text)
        assert isinstance(outcome, QueryFailed)
        assert why in outcome.why

    def test_it_is_answered_in_the_tick_in_which_it_came(self):
        assert Session().send(Query("query#1/1", "1")).replies == (Reply("query#1/1", ShownValue("1")),)

    def test_it_reads_the_globals_of_the_running_program_and_does_not_disturb_it(self):
        session = Session()
        session.start("global g", "g = [1, 2]", FOREVER)
        assert self.ask(session, "g") == [ShownValue("[1, 2]")]
        self.ask(session, "(h := 1)")
        assert [type(outcome) for outcome in self.ask(session, "h")] == [QueryFailed]
        assert session.last.snapshot.robot.task_state is TaskState.PLAYING
