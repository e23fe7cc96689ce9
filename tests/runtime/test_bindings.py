import builtins

import pytest

from elitescript.commands.catalogue import CATALOGUE
from elitescript.language.hooks import HOOKS
from elitescript.runtime.names.bindings import is_known
from tests.runtime.machine import Bench, run


def test_every_hook_of_the_compiler_is_there():
    bench = Bench().start("pass\n")
    assert set(HOOKS) <= set(bench.host._program.builtins)


def test_every_command_is_there_under_its_name():
    bindings = run("pass\n").host._program.bindings
    for name in CATALOGUE.names():
        assert name not in bindings.names
        bindings.bind_name(name)
        assert bindings.names[name].__name__ == name
        assert is_known(name)


def test_commands_come_before_built_ins_of_the_same_name():
    bindings = run("pass\n").host._program.bindings
    for name in bindings.known():
        bindings.bind_name(name)
    assert {name for name in dir(builtins) if CATALOGUE.get(name) is not None} == {"pow"}
    assert bindings.names["pow"] is not pow


def test_only_what_a_program_names_is_made():
    bench = run("""
        def a():
          def f():
            class C:
              x = [get_steptime() for _ in range(1)]
            return lambda: str_len("")
          eval("str_cat('a', 'b')")
          exec("str_at('a', 0)")
        end
    """)
    assert bench.alarms == []
    made = {name for name in bench.host._program.builtins if CATALOGUE.get(name) is not None}
    assert made == {"get_steptime", "str_len", "str_cat", "str_at"}


@pytest.mark.parametrize(
    "name", ["getattr", "dir", "input", "print", "textmsg", "globals", "iter", "KeyboardInterrupt"]
)
def test_what_a_program_hangs_on_a_function_is_gone_with_it(name):
    bench = Bench().start(f"{name}.note = 1\ntextmsg({name}.note)\n").run()
    bench.start(f"textmsg(hasattr({name}, 'note'))\n").run()
    assert bench.log == ["1", "False"]


def test_names_that_exist_are_suggested_although_nothing_has_used_them():
    (alarm,) = run("textmgs('x')\n").alarms
    assert alarm.details["hint"] == "is `textmsg` meant?"


class TestBuiltIns:
    @pytest.mark.parametrize(
        ("expression", "value"),
        [
            ("sum(map(abs, [-1, 2]))", "3"),
            ("sorted({3, 1}, reverse=True)", "[3, 1]"),
            ("list(zip('ab', range(2)))", "[('a', 0), ('b', 1)]"),
            ("isinstance(3, int) and not isinstance(3, str)", "True"),
            ("type(3) == int", "True"),
            ("type([]).__name__", "list"),
            ("isinstance(int, type)", "True"),
            ("long(7) + 1", "8"),
            ("unichr(65)", "A"),
            ("bytes([65, 66]).decode()", "AB"),
            ("getattr(3, 'real')", "3"),
            ("hasattr([], 'append')", "True"),
            ("callable(sleep)", "True"),
            ("round(2.675, 2)", "2.67"),
            ("issubclass(PermissionError, OSError)", "True"),
            ("repr(print)", "<function print>"),
            ("copy.deepcopy([[1]])", "[[1]]"),
            ("elicopy.copy((1, 2))", "(1, 2)"),
            ("list(iter([1, 2]))", "[1, 2]"),
            ("dir('')[:1]", "['capitalize']"),
            ("eval('1 + 2 * 3')", "7"),
            ("eval('a + b', {'a': 1, 'b': 2})", "3"),
            ("eval('a + b', {'a': 1}, {'b': 5})", "6"),
            ("'{:.2f}'.format(1)", "1.00"),
        ],
    )
    def test_they_do_what_python_s_do(self, expression, value):
        assert run(f"textmsg({expression})\n").log == [value]

    def test_a_program_can_hide_one_for_itself(self):
        bench = run("def a():\n  len = lambda x: 42\n  def f(list):\n    return len(list)\n  textmsg(f([]))\nend\n")
        assert bench.log == ["42"]
        assert run("textmsg(len([1]))\n").log == ["1"]

    def test_input_has_no_terminal(self):
        (alarm,) = run("input('name? ')\n").alarms
        assert (alarm.class_name, alarm.line) == ("RuntimeError", 1)

    def test_what_is_refused_says_what_to_use(self):
        (alarm,) = run("x = globals()\n").alarms
        assert alarm.class_name == "PermissionError"
        assert alarm.details["command"] == "globals" and alarm.details["hint"]

    def test_eval_sees_variables_of_the_function_and_program_globals(self):
        bench = run("""
            def a():
              global g
              g = 10
              local = 1
              def f(x):
                inner = 100
                return eval("x + inner + local * 0 + g")
              textmsg(eval("local + g"))
              textmsg(f(1000)) if False else textmsg(eval("(lambda k: k + g)(5)"))
              g = 20
              textmsg(eval("[local + n for n in range(2)]"))
            end
        """)
        assert bench.log == ["11", "15", "[1, 2]"]

    def test_eval_cannot_loop_for_ever_unnoticed(self):
        bench = Bench(work_per_tick=100).start('x = eval("[n for n in range(100000)]")\n')
        bench.run(until=5)
        assert bench.host.is_running

    def test_exec_shares_the_globals(self):
        bench = run("def a():\n  exec('global made\\nmade = 3')\n  textmsg(made)\nend\n")
        assert (bench.log, bench.host.monitor()) == (["3"], {"made": 3})

    def test_iterators_that_never_end_come_to_checkpoints(self):
        bench = Bench(work_per_tick=200).start("x = list(iter(int, 1))\n")
        bench.run(until=20)
        assert bench.host.is_running


class TestPrint:
    @pytest.mark.parametrize(
        ("statement", "lines"),
        [
            ("print(1, 'a', None)", ["1 a None"]),
            ("print()", [""]),
            ("print('a', 'b', sep='-')", ["a-b"]),
            ("print('a', end=''); print('b')", ["ab"]),
            ("print('a\\nb')", ["a\nb"]),
            ("import sys; sys.stdout.write('x\\n')", ["x"]),
            ("import sys; print('x', file=sys.stderr, flush=True)", ["x"]),
        ],
    )
    def test_it_writes_one_event_for_a_line(self, statement, lines):
        assert run(f"def a():\n  {statement}\nend\n").printed == lines

    def test_it_says_where(self):
        bench = run("def a():\n\n  print('x')\nend\n")
        (event,) = bench.machine.events
        assert (event.line, event.thread, event.tick) == (3, "main", 0)


class TestCommands:
    def test_errors_can_be_caught_by_their_built_in_class(self):
        bench = run("""
            def a():
              try:
                sin("x")
              except TypeError as e:
                textmsg("type")
              end
              try:
                set_flag(99, True)
              except ValueError as e:
                textmsg("range ", e)
              end
            end
        """)
        assert bench.log[0] == "type"
        assert bench.log[1].startswith("range set_flag: n must be")

    def test_keywords_work(self):
        assert run("textmsg(s2='b', s1='a')\n").log == ["ab"]

    def test_a_newer_one_says_which_firmware_it_needs_and_can_be_caught(self):
        text = "def a():\n  try:\n    halt()\n  except NameError as e:\n    textmsg(e)\n  end\nend\n"
        assert "2.14" in run(text, firmware="2.10").log[0]
        assert run(text, firmware="2.14").ends == ["stopped"]

    def test_marks_are_noted_in_front_of_a_node_and_behind_it(self):
        bench = run('def a():\n  $ LINE: (3, "begin")\n  $ LINE: (3, "begin", "after")\n  labelmsg(4, "old")\nend\n')
        assert bench.marks == [(3, "begin"), (3, "begin"), (4, "old")]
