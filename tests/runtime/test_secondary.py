import pytest

from elitescript.errors import ScriptStateError
from elitescript.runtime.secondary import QUEUE_MAX
from tests.runtime.machine import Bench, compiled

ENDLESS = """
def main():
  global beats
  beats = 0
  while True:
    beats += 1
    sync()
  end
end
"""


def test_it_changes_globals_of_the_program():
    bench = Bench().start("""
        def main():
          global go
          go = False
          while not go:
            sync()
          textmsg("released")
        end
    """)
    bench.run(until=10)
    bench.secondary("sec release():\n  global go\n  go = True\nend\n").run()
    assert bench.log == ["released"]


def test_locals_of_the_program_are_out_of_reach():
    bench = Bench().start("def main():\n  hidden = 1\n  sleep(1)\nend\n")
    bench.run(until=10)
    bench.secondary("sec look():\n  textmsg(hidden)\nend\n").run()
    assert bench.warnings == ["[SEC] Exception: NameError: name 'hidden' is not defined"]
    assert bench.ends == ["finished"]


def test_its_name_and_its_locals_are_bound_nowhere():
    bench = Bench().start(ENDLESS)
    bench.secondary("sec look():\n  x = 1\n  textmsg(beats >= 0)\nend\n").run(until=3)
    assert bench.log == ["True"]
    assert list(bench.host.monitor()) == ["beats"]


def test_without_a_program_its_names_are_dropped_afterwards():
    bench = Bench()
    bench.secondary("sec one():\n  global x\n  x = 1\n  textmsg(x)\nend\n")
    bench.secondary("sec two():\n  textmsg(x)\nend\n")
    bench.run()
    assert bench.log == ["1"]
    assert bench.warnings == ["[SEC] Exception: NameError: name 'x' is not defined"]
    assert bench.host.is_idle


def test_several_run_one_after_the_other():
    bench = Bench()
    bench.secondary('sec one():\n  import threading\n  threading.Event().wait(0.1)\n  textmsg("one")\nend\n')
    bench.secondary('sec two():\n  textmsg("two")\nend\n')
    assert bench.run().log == ["one", "two"]


@pytest.mark.parametrize(
    "call",
    ["sleep(1)", "sync()", "pause()", "movej([0,0,0,0,0,0])", "start_thread(f, ())", "join_thread(1)",
     "import time\n  time.sleep(1)", "import threading\n  threading.Thread(target=f).start()"],
)  # fmt: skip
def test_calls_that_wait_are_refused(call):
    bench = Bench().start(ENDLESS)
    bench.secondary(f'sec slow():\n  def f():\n    pass\n  textmsg("a")\n  {call}\n  textmsg("b")\nend\n')
    bench.run(until=20)
    assert bench.log == ["a"]
    assert bench.warnings[0].startswith("[SEC] Exception: RuntimeError: ")
    assert bench.host.is_running and bench.machine.moves == {}


def test_one_that_does_not_end_is_ended_after_a_second():
    bench = Bench().start(ENDLESS)
    bench.run(until=10)
    bench.secondary("sec forever():\n  while True:\n    pass\nend\n").run(until=400)
    assert len(bench.warnings) == 1 and bench.warnings[0].startswith("[SEC] Exception: TimeoutError")
    assert [event.tick for event in bench.machine.events if event.text in bench.warnings] == [261]
    assert bench.host.is_running and bench.host._secondaries.is_idle


def test_one_that_waits_for_ever_is_ended_too_and_leaping_finds_it():
    bench = Bench()
    bench.secondary("sec forever():\n  import threading\n  threading.Event().wait()\nend\n").run()
    assert bench.ticks == [0, 250]
    assert bench.host.is_idle


def test_halt_in_it_stops_the_program():
    bench = Bench().start(ENDLESS)
    bench.run(until=5)
    bench.secondary('sec stop_all():\n  halt()\n  textmsg("never")\nend\n').run(until=20)
    assert (bench.ends, bench.log) == (["stopped"], [])
    assert bench.host.is_idle


def test_it_runs_beside_a_paused_program():
    bench = Bench().start(ENDLESS)
    bench.run(until=5)
    bench.host.pause()
    bench.run(until=8)
    bench.secondary('sec note():\n  textmsg("beside")\nend\n').run(until=20)
    assert bench.log == ["beside"]


def test_a_popup_never_holds_it_up():
    bench = Bench(confirms_popups=False)
    bench.secondary('sec ask():\n  popup("there?", blocking=True)\n  textmsg("went on")\nend\n').run()
    assert bench.log == ["went on"]
    assert not bench.popups[0].is_blocking


def test_the_end_of_the_program_leaves_those_that_wait():
    bench = Bench()
    bench.secondary("sec a():\n  import threading\n  threading.Event().wait()\nend\n")
    bench.secondary('sec b():\n  textmsg("later")\nend\n')
    bench.run(until=5)
    bench.host.stop("test")
    bench.run(until=300)
    assert (bench.log, len(bench.warnings), bench.host.is_idle) == (["later"], 1, True)


def test_too_many_are_refused():
    host = Bench().host
    unit = compiled("sec a():\n  pass\nend\n", kind="secondary")
    for _ in range(QUEUE_MAX):
        host.start_secondary(unit)
    with pytest.raises(ScriptStateError, match=str(QUEUE_MAX)):
        host.start_secondary(unit)


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ("  def f(a):\n    return a\n  f()\n", "TypeError: f() missing 1 required positional argument: 'a'"),
        ("  def f():\n    def h(b):\n      pass\n    h()\n  f()\n", "TypeError: h() missing 1 required"),
        ("  class A:\n    def g(self, a):\n      pass\n  A().g()\n", "TypeError: A.g() missing 1 required"),
        ("  f = lambda a: a\n  f()\n", "TypeError: <lambda>() missing 1 required"),
    ],
)
def test_a_warning_names_functions_by_their_own_names(body: str, words: str) -> None:
    bench = Bench().secondary(f"sec s():\n{body}end\n").run()
    assert bench.warnings[0].startswith(f"[SEC] Exception: {words}")
