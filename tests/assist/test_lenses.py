"""Lines above programs and functions."""

from __future__ import annotations

from elitescript.assist.document import Document
from elitescript.assist.last_run import LastRun, LineTime
from elitescript.assist.lenses import code_lenses

TEXT = """# A program.
def job():
  def work(n):
    sleep(n)
    movej(HOME)
  end
  def never():
    sync()
  end
  work(1)
  start_thread(work, (2,))
end
"""


def shown(text: str, last_run: LastRun | None = None) -> list[str]:
    lenses = code_lenses(Document("cell.script", text), last_run)
    return [f"{lens.span.line}:{lens.span.column} {lens.title}|{lens.command}" for lens in lenses]


PROGRAM = ["2:1 Run|elitescript.run", "2:1 Debug|elitescript.debug", "2:1 Show path|elitescript.showPath"]


def test_a_program_can_be_run():
    assert shown(TEXT) == [*PROGRAM, "3:3 used 2 times|", "7:3 not used|"]


def test_a_script_without_def_can_be_run():
    assert shown("\nmovej(q)\n")[0] == "2:1 Run|elitescript.run"


def test_an_empty_text_cannot():
    assert shown("\n# nothing\n") == []


def test_the_last_run_shows_calls_and_the_share_of_the_time():
    run = LastRun(TEXT, duration_s=10.0, lines={4: LineTime(2, 1.0), 5: LineTime(2, 6.0), 10: LineTime(1, 3.0)})
    assert shown(TEXT, run)[3:] == ["3:3 used 2 times; 2 calls, 70 % of the time|", "7:3 not used|"]
    assert shown("# new\n" + TEXT, run)[3:] == ["4:3 used 2 times; 2 calls, 70 % of the time|", "8:3 not used|"]


def test_a_function_does_not_count_the_time_of_those_inside_it():
    text = "def job():\n  def outer():\n    def inner():\n      sleep(1)\n    end\n    inner()\n  end\n  outer()\nend\n"
    run = LastRun(text, duration_s=4.0, lines={4: LineTime(0, 1.0), 6: LineTime(0, 2.0)})
    assert shown(text, run)[3:] == ["2:3 used once; 50 % of the time|", "3:5 used once; 25 % of the time|"]


def test_a_broken_text_still_can_be_run():
    assert shown("def job():\n  movej(\nend\n")[0] == "1:1 Run|elitescript.run"
