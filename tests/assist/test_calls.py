"""Who calls whom, and who starts whom as a thread."""

from __future__ import annotations

from elitescript.assist.calls import Call, incoming, outgoing, prepare
from elitescript.assist.document import Document
from tests.assist.reading import cut, marked

PROGRAM = """\
def job():
  def low(n):
    return n
  end
  def high():
    x = [low(i) for i in (1, 2)]
    return low(1) + (lambda: low(2))()
  end
  class Box:
    def get(self): return high()
  end
  start_thread(high, ())
  high()
  Box().get()
  movej([0, 0, 0, 0, 0, 0])
end
"""


def rows(document: Document, calls: tuple[Call, ...]) -> list[str]:
    return [
        f"{call.item.kind} {call.item.name}: {' '.join(cut(document, span) for span in call.spans)}"
        + (" thread" if call.is_thread_start else "")
        for call in calls
    ]


def test_calls_and_starts() -> None:
    document = Document("cell.script", PROGRAM)
    (low,) = prepare(document, 2, 7)
    (high,) = prepare(document, 13, 4)
    (job,) = prepare(document, 1, 5)
    (get,) = prepare(document, 14, 10)
    assert (high.name, high.kind, high.name_span[:2], high.span[2]) == ("high", "thread", (5, 7), 8)
    assert rows(document, incoming(document, low)) == ["thread high: 6:low 7:low 7:low"]
    assert rows(document, incoming(document, high)) == [
        "method get: 10:high",
        "program job: 12:high thread",
        "program job: 13:high",
    ]
    assert rows(document, outgoing(document, high)) == ["function low: 6:low 7:low 7:low"]
    assert rows(document, outgoing(document, job)) == [
        "thread high: 12:high thread",
        "thread high: 13:high",
        "method get: 14:get",
    ]
    assert rows(document, outgoing(document, get)) == ["thread high: 10:high"]
    assert incoming(document, job) == ()


def test_a_script_calls_by_its_file_name() -> None:
    document = Document("file:///tasks/cell.script", "def f():\n  pass\nend\nf()\n")
    (f,) = prepare(document, 1, 5)
    assert rows(document, incoming(document, f)) == ["program cell.script: 4:f"]
    (script,) = [call.item for call in incoming(document, f)]
    assert rows(document, outgoing(document, script)) == ["function f: 4:f"]
    assert incoming(document, script) == ()


def test_what_is_no_function_is_no_item() -> None:
    for text in ("¦movej(q)\n", "¦x = 1\n", "¦\n", "class ¦A:\n  v = 1\nend\n"):
        assert prepare(*marked(text)) == ()
