"""Small texts in lines: units, names of arguments, times and blends of the last run."""

from __future__ import annotations

import pytest

from elitescript.assist.document import Document
from elitescript.assist.hints import LABEL_MAX, HintKind, inlay_hints
from elitescript.assist.last_run import LastRun, LineTime, ShortenedBlend
from elitescript.lint.program import Span

TEXT = """def job():
  HOME = [0, -1.5707963, 1.5707963, 0, 0.7853982, 0]
  STRAIGHT = [0, 0, 0, 0, 0, 0]
  TURNED = [0, d2r(-90), 0, 0, 0, 0]
  PLACE = [0.4, 0, 0.3, 3.14, 0, 0]
  movej(HOME)
  movej(STRAIGHT)
  movej(TURNED)
  movej([1, 0, 0, 0, 0, 0])
  movel(PLACE, 1.2, 0.25, r=0.05)
  def f(a, b, c):
    movej(a)
  end
  c = 3
  f(1, 2, c)
end
"""
ALL = Span(1, 1, 99, 1)
RAN = LastRun(
    TEXT,
    duration_s=10.0,
    moves={6: LineTime(1, 1.25), 9: LineTime(4, 5.0), 10: LineTime(1, 0.5)},
    blends={10: ShortenedBlend(0.05, 0.02)},
)


def shown(text: str = TEXT, span: Span = ALL, **options) -> list[str]:
    document = Document("cell.script", text)
    hints = inlay_hints(document, span, **options)
    return [f"{hint.line}:{hint.column} {hint.kind} {hint.label}" for hint in hints]


UNITS = ["2:53 unit 0, -90, 90, 0, 45, 0 deg", "9:27 unit 57.3, 0, 0, 0, 0, 0 deg"]
ARGUMENTS = [
    *("10:9 argument p=", "10:16 argument a=", "10:21 argument v="),
    *("15:5 argument a=", "15:8 argument b="),
]
TIMES = ["6:14 time 1.25 s", "9:28 time 4 x, 5 s", "10:34 time 0.5 s"]
BLENDS = ["10:33 blend -> 0.02 m"]


def test_without_a_run():
    assert shown() == [*UNITS, *ARGUMENTS]


@pytest.mark.parametrize(
    ("joints", "label"),
    [
        ("0.4, -1.3, -1.9, -1.5, 1.57, 0.1", "22.9, -74.5, -108.9, -85.9, 90, 5.7 deg"),
        ("-2.41, -2.32, -1.92, -2.53, -2.57, -3.11", "-138, -133, -110, -145, -147, -178 deg"),
    ],
)
def test_degrees_are_rounded_so_that_editors_show_them_whole(joints, label):
    assert (
        shown(f"def job():\n  HOME = [{joints}]\n  movej(HOME)\nend\n", kinds=[HintKind.UNIT])[0].partition(" unit ")[2]
        == label
    )
    assert len(label) <= LABEL_MAX


@pytest.mark.parametrize(
    ("kind", "expected"),
    [
        (HintKind.UNIT, UNITS),
        (HintKind.ARGUMENT, ARGUMENTS),
        (HintKind.TIME, TIMES),
        (HintKind.BLEND, BLENDS),
    ],
)
def test_each_kind_can_be_had_alone(kind, expected):
    assert shown(last_run=RAN, kinds=[kind]) == expected


def test_none_of_them():
    assert shown(last_run=RAN, kinds=[]) == []


def test_only_the_range_is_looked_at():
    assert shown(span=Span(9, 1, 9, 1), last_run=RAN) == [UNITS[1], TIMES[1]]


def test_lines_that_moved_keep_their_times_and_changed_ones_lose_them():
    text = "# new\n" + TEXT.replace("movej([1, 0, 0, 0, 0, 0])", "movej([2, 0, 0, 0, 0, 0])")
    assert shown(text, last_run=RAN, kinds=[HintKind.TIME]) == ["11:34 time 0.5 s"]
    text = TEXT.replace("movel(PLACE, 1.2, 0.25", "movel(PLACE, 1.2, 0.5")
    assert shown(text, last_run=RAN, kinds=[HintKind.TIME]) == ["6:14 time 1.25 s", "9:28 time 4 x, 5 s"]


def test_a_tooltip_says_what_the_share_is():
    hint = inlay_hints(Document("cell.script", TEXT), ALL, RAN, [HintKind.TIME])[1]
    assert hint.tooltip == "time of the moves of this line in the last run; 1.25 s each on average; 50 % of the run"


def test_a_broken_text_keeps_the_hints_of_its_other_lines():
    text = TEXT.replace("  c = 3\n", "  c = (\n")
    assert UNITS[1] in shown(text)
