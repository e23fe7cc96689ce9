from elitescript.runtime.program import SOURCES_MAX
from tests.runtime.machine import Bench, run


class TestMonitor:
    def test_it_shows_program_globals_in_the_order_of_their_first_assignment(self):
        bench = run("""
            def a():
              global first, second, never
              local = 1
              second = [1.5]
              first = "x"
              def f():
                global third
                third = None
              f()
              first = "y"
            end
        """)
        assert list(bench.host.monitor().items()) == [("second", [1.5]), ("first", "y"), ("third", None)]

    def test_it_leaves_out_functions_classes_and_modules(self):
        bench = run("""
            def a():
              global f, C, math, alias, obj, call, n
              import math
              def f():
                pass
              class C:
                pass
              alias = sleep
              obj = C()
              call = len
              n = 1
            end
        """)
        assert list(bench.host.monitor()) == ["obj", "n"]

    def test_presets_come_first(self):
        bench = run("def a():\n  global x, y\n  y = x + 1\nend\n", presets={"x": 4, "unused": 0})
        assert bench.host.monitor() == {"x": 4, "unused": 0, "y": 5}

    def test_names_of_the_standard_library_do_not_get_in(self):
        bench = run("import math, queue\nglobal x\nx = math.pi\n")
        assert list(bench.host.monitor()) == ["x"]

    def test_it_can_be_read_while_the_program_runs(self):
        bench = Bench().start("def a():\n  global n\n  n = 0\n  while True:\n    n += 1\n    sync()\nend\n")
        assert bench.host.monitor() == {}
        bench.run(until=9)
        assert bench.host.monitor() == {"n": 10}


def test_what_a_global_statement_in_a_thread_makes_is_everybody_s():
    bench = run(
        "def a():\n  def t():\n    global g\n    g = 5\n  join_thread(start_thread(t, ()))\n  textmsg(g)\nend\n"
    )
    assert bench.log == ["5"]


def test_the_body_is_a_function_body():
    bench = run("""
        x = 1
        def f():
          global x
          x = 2
        f()
        textmsg(x)
    """)
    assert (bench.log, bench.host.monitor()) == (["1"], {"x": 2})


def test_many_texts_of_exec_are_not_all_kept():
    bench = Bench().start(f'for n in range({SOURCES_MAX + 50}):\n  exec("x = 1")\n').run()
    assert bench.ends == ["finished"]
    assert len(bench.host._program._sources) <= SOURCES_MAX


def test_a_program_does_not_see_what_the_one_before_left():
    bench = Bench().start("global x\nx = 1\nimport json\njson.JSONEncoder.y = 2\n").run()
    bench.start("import json\ntextmsg(hasattr(json.JSONEncoder, 'y'))\ntextmsg(x)\n").run()
    assert bench.log == ["False"]
    assert bench.alarms[0].class_name == "NameError"
