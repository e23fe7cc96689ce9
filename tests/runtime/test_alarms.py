import pytest

from elitescript.commands.catalogue import CATALOGUE
from elitescript.errors import ArgumentRangeError, ProgramError, ScriptError, ScriptStateError
from elitescript.language.text.source import SourceFile
from elitescript.lint.engine import check_source
from elitescript.messages.profile import profile
from elitescript.runtime.alarms import alarm_of, class_name_of, details_of, text_of
from tests.runtime.machine import run


def alarm_in(text, **options):
    (alarm,) = run(text, **options).alarms
    return alarm


class TestPlace:
    def test_it_is_the_innermost_line_of_script_text(self):
        alarm = alarm_in("def job():\n  def inner(x):\n    return [1][x]\n  inner(7)\nend\n")
        assert (alarm.line, alarm.source_line, alarm.class_name) == (3, "    return [1][x]", "IndexError")

    def test_the_column_counts_characters(self):
        alarm = alarm_in('def job():\n  x = "坐标" + str(1) + nichts\nend\n')
        assert alarm.source_line[alarm.column - 1 :] == "nichts"

    def test_a_call_of_a_command_points_to_the_call(self):
        alarm = alarm_in('def job():\n  y = 1 + sin("x")\nend\n')
        assert alarm.source_line[alarm.column - 1 :] == 'sin("x")'

    def test_frames_of_ours_and_of_the_standard_library_do_not_count(self):
        alarm = alarm_in("def job():\n  import queue\n  q = queue.Queue()\n\n  q.get_nowait()\nend\n")
        assert (alarm.line, alarm.class_name) == (5, "Empty")

    def test_a_callback_of_the_script_counts(self):
        alarm = alarm_in("def job():\n  f = lambda v: 1 / v\n  sorted([0], key=f)\nend\n")
        assert alarm.line == 2

    def test_a_line_that_the_pre_pass_changed_keeps_its_place(self):
        alarm = alarm_in('def job():\n  $ LINE: (4, "node")\n  if True:\n    boom()\n  end\nend\n')
        assert (alarm.line, alarm.column) == (4, 5)

    def test_a_text_that_the_program_made_is_placed_in_the_program_and_in_itself(self):
        alarm = alarm_in('def job():\n  exec("x = 1")\n  exec("x = 1\\ny = 2 / 0")\nend\n')
        assert (alarm.line, alarm.column) == (3, 3)
        assert alarm.text.endswith("(line 2 of the text that exec ran)")
        alarm = alarm_in('def job():\n  x = eval("1 / 0")\nend\n')
        assert alarm.line == 2
        assert "eval" in alarm.text


class TestWords:
    def test_a_command_s_refusal_brings_its_details(self):
        alarm = alarm_in("def job():\n  set_standard_digital_out(99, True)\nend\n")
        assert alarm.code == "R102"
        assert alarm.class_name == "ValueError"
        assert alarm.details["command"] == "set_standard_digital_out"
        assert alarm.details["value"] == 99
        assert "15" in alarm.details["limit"]

    @pytest.mark.parametrize(
        ("call", "words"),
        [
            ("stop_thread(blink)", "stop_thread: thread_id must be an int, not function blink"),
            ("stop_thread(sleep)", "stop_thread: thread_id must be an int, not function sleep"),
            ("movej(math)", "movej: q must be a list of 6 numbers, not module math"),
        ],
    )
    def test_functions_and_modules_go_by_their_names(self, call, words):
        alarm = alarm_in(f"def job():\n  import math\n  def blink():\n    sync()\n  end\n  {call}\nend\n")
        assert alarm.text.startswith(words)
        assert "<" not in alarm.text
        assert "<function" not in str(alarm.details)

    @pytest.mark.parametrize("call", ["movel(p + [0, 0, 0.1, 0, 0, 0])", "movej(p * 3)", "pose_add(p * 2, p)"])
    def test_lists_that_were_joined(self, call):
        alarm = alarm_in(f"def job():\n  p = [0, 0, 0, 0, 0, 0]\n  {call}\nend\n")
        assert alarm.details["hint"].startswith("`+` and `*` join and repeat lists")

    def test_other_lengths_are_not(self):
        assert "join" not in alarm_in("def job():\n  movel([0, 0, 0])\nend\n").details["hint"]

    def test_values_that_cannot_be_written_down_are_shown(self):
        alarm = alarm_in("def job():\n  sin(object())\nend\n")
        assert alarm.details["value"] == "<object object>"

    @pytest.mark.parametrize(("name", "meant"), [("slep", "sleep"), ("my_valeu", "my_value"), ("lenn", "len")])
    def test_an_unknown_name_comes_with_the_one_that_was_meant(self, name, meant):
        alarm = alarm_in(f"def job():\n  my_value = 1\n  {name}\nend\n")
        assert (alarm.class_name, alarm.text) == ("NameError", f"name '{name}' is not defined")
        assert alarm.details["hint"] == f"is `{meant}` meant?"

    def test_a_name_like_nothing_comes_without(self):
        assert alarm_in("zzqqxx()\n").details == {}

    def test_a_variable_without_a_value_is_not_an_unknown_name(self):
        alarm = alarm_in("def job():\n  def f():\n    sleep = sleep + 1\n  f()\nend\n")
        assert (alarm.class_name, alarm.text) == ("UnboundLocalError", "the variable `sleep` has no value yet here")

    @pytest.mark.parametrize("line", ["count = count + 1", "count += 1", "if count > 3:\n      count = 0\n    end"])
    def test_the_hint_of_a_variable_without_a_value_names_that_of_the_enclosing_program(self, line):
        alarm = alarm_in(f"def job():\n  count = 0\n  def f():\n    {line}\n  end\n  f()\nend\n")
        assert "`nonlocal count` at the start of `f`" in alarm.details["hint"]

    def test_without_one_around_it_the_hint_names_global(self):
        alarm = alarm_in("def job():\n  def f():\n    count = count + 1\n  end\n  f()\nend\n")
        assert "`global count`" in alarm.details["hint"]

    def test_a_command_of_a_newer_firmware_says_which(self):
        alarm = alarm_in("def job():\n  controller_timestamp()\nend\n", firmware="2.10")
        assert (alarm.code, alarm.class_name, alarm.line) == ("R105", "NameError", 2)
        assert "2.14" in alarm.text and "2.10" in alarm.text
        assert alarm.details["hint"] == "if the robot has it, choose --firmware 2.14"

    def test_so_does_its_bare_name_where_nothing_is_bound(self):
        error = NameError("name 'controller_timestamp' is not defined", name="controller_timestamp")
        alarm = alarm_of(
            error,
            clock=lambda: 1,
            thread="main",
            builtins={},
            known=(),
            sources={},
            catalogue=CATALOGUE,
            profile=profile("2.10"),
        )
        assert (alarm.code, alarm.line, alarm.column) == ("R105", 0, 0)

    def test_too_deep_a_recursion_is_an_alarm_like_others(self):
        alarm = alarm_in("def job():\n  def f(n):\n    return f(n + 1)\n  f(0)\nend\n")
        assert (alarm.class_name, alarm.line) == ("RecursionError", 3)

    def test_too_much_memory_is_an_alarm_like_others(self):
        alarm = alarm_in("def job():\n  x = [0] * (2 ** 60)\nend\n")
        assert (alarm.class_name, alarm.line) == ("MemoryError", 2)

    def test_a_mistake_in_eval_is_an_alarm_on_its_line(self):
        alarm = alarm_in('def job():\n  eval("1 +")\nend\n')
        assert (alarm.class_name, alarm.line) == ("SyntaxError", 2)

    def test_a_text_that_cannot_be_made_does_not_hide_the_alarm(self):
        alarm = alarm_in("""
            def job():
              class Odd(Exception):
                def __str__(self):
                  return 1 / 0
              raise Odd()
            end
        """)
        assert (alarm.class_name, alarm.text) == ("Odd", "<text of Odd not available>")

    def test_a_text_that_waits_does_not_hold_up_the_alarm_for_ever(self):
        bench = run("""
            def job():
              class Slow(Exception):
                def __str__(self):
                  sleep(1)
                  return "slow"
              raise Slow()
            end
        """)
        assert (bench.alarms[0].text, bench.alarms[0].tick) == ("slow", 250)


def test_a_program_that_extends_an_error_of_commands_does_not_break_the_alarm():
    alarm = alarm_in("""
        def job():
          try:
            sin("x")
          except TypeError as e:
            Base = type(e)
          class Odd(Base):
            pass
          odd = Odd("own text")
          odd.code = [1]
          odd.command = Odd
          odd.hint = {1: 2}
          raise odd
        end
    """)
    assert (alarm.code, alarm.class_name, alarm.text) == ("R100", "TypeError", "own text")
    assert all(type(value) is str for value in alarm.details.values())


def test_errors_of_commands_show_as_the_class_that_python_programmers_know():
    assert class_name_of(ArgumentRangeError("x")) == "ValueError"
    assert class_name_of(ScriptStateError("x")) == "RuntimeError"
    assert class_name_of(ScriptError("x")) == "ScriptError"
    assert class_name_of(KeyError("x")) == "KeyError"


def test_details_leave_out_what_is_not_known():
    error = ArgumentRangeError("x", command="movej", value=[1.0, 2], limit="6 elements", unit="rad")
    assert details_of(error) == {"command": "movej", "value": "[1.0, 2]", "limit": "6 elements", "unit": "rad"}


def test_problems_of_a_text_are_put_in_one_line():
    class Problem:
        text = "an empty block"

    assert text_of(ProgramError((Problem(), Problem()))) == "an empty block; an empty block"


@pytest.mark.parametrize(
    "body",
    [
        "moveJ([0, -1.57, 1.57, 0, 1.57, 0])",
        "slep(1)",
        "set_digital_out(1, True)",
        "x = true",
        "x = math.pi",
        "x = sleeep",
        "servoc([0, 0, 0, 0, 0, 0])",
        "x = zzqqxx",
        "def f():\n    hidden = 1\n  end\n  x = hidden",
        "def f(value):\n    return vlaue\n  end\n  f(1)",
        "counter = 1\n  def f():\n    return countr\n  end\n  f()",
    ],
)
def test_an_unknown_name_has_the_same_hint_in_the_check_and_in_the_alarm(body):
    text = f"def job():\n  {body}\nend\n"
    found = check_source(SourceFile("<test>", text), profile("2.14"))
    (problem,) = [problem for problem in found if problem.code in ("E301", "W201")]
    alarm = alarm_in(text)
    assert (alarm.line, alarm.column) == (problem.line, problem.column)
    assert alarm.details.get("hint", "") == problem.hint
