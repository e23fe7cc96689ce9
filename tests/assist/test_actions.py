"""Repairs at marked places, and what they make of the text."""

from __future__ import annotations

import pytest

from elitescript.assist.actions import ActionKind, code_actions, fix_all
from elitescript.assist.document import Document
from elitescript.language.diagnostics import Fix
from elitescript.language.text.source import apply_fixes
from elitescript.lint.fixing import repaired
from elitescript.lint.program import Span
from elitescript.messages.profile import DEFAULT_FIRMWARE, PROFILES
from tests.assist.reading import marked

HEAD, TAIL = "def job():\n", "end\n"

# Lines of a body with a cursor, title of an action, the lines afterwards.
TABLE = [
    ("  x = tru¦e\n  textmsg(x)\n", "Write True", "  x = True\n  textmsg(x)\n"),
    ("  print ¦'a'\n", "Write print(...)", "  print('a')\n"),
    ("  syn¦c\n", "Call it", "  sync()\n"),
    ("  textmsg¦\uff08“好。”\uff0c1\uff09\n", "Write plain signs", '  textmsg("好。",1)\n'),
    ("  sync\n  syn¦c\n", "Repair all 2 of W215", "  sync()\n  sync()\n"),
    ("  mowej¦([0, 0, 0, 0, 0, 1])\n", "Write movej", "  movej([0, 0, 0, 0, 0, 1])\n"),
    ("  speed = 1\n  sleep(sped¦)\n", "Write speed", "  speed = 1\n  sleep(speed)\n"),
    ("  sleep(time_out¦=1)\n", "Ignore E303 in line 2", "  sleep(time_out=1)  # check: ignore[E303]\n"),
    ("  socket_close(socket_nam¦=1)\n", "Write socket_name", "  socket_close(socket_name=1)\n"),
    ("  x = mat¦h.pi\n  textmsg(x)\n", "Import math", "  import math\n  x = math.pi\n  textmsg(x)\n"),
    ("  movej([0, ¦-90, 90, 0, 0, 0])\n", "Write d2r(-90) and so on", "  movej([0, d2r(-90), d2r(90), 0, 0, 0])\n"),
    ("  HOME = [0, -90, 0, 0, 0, 0]\n  movej(¦HOME)\n",
     "Write d2r(-90)", "  HOME = [0, d2r(-90), 0, 0, 0, 0]\n  movej(HOME)\n"),
    ("  movel([¦400, 0, 300, 3.14, 0, 0])\n", "Write 0.4 and so on", "  movel([0.4, 0, 0.3, 3.14, 0, 0])\n"),
    ("  movel([0.4, 0, 0.3, ¦180, 0, 0])\n", "Write d2r(180)", "  movel([0.4, 0, 0.3, d2r(180), 0, 0])\n"),
    ("  movel([0.4, 0, 0.3, 3.14, 0, 0], v=¦250)\n", "Write 0.25", "  movel([0.4, 0, 0.3, 3.14, 0, 0], v=0.25)\n"),
    ("  movej([0, 0, 0, 0, 0, 1], v=¦90)\n", "Write d2r(90)", "  movej([0, 0, 0, 0, 0, 1], v=d2r(90))\n"),
    ("  set_tcp([0, 0, ¦150, 0, 0, 0])\n", "Write 0.15", "  set_tcp([0, 0, 0.15, 0, 0, 0])\n"),
    ("  global level\n  level = 0\n  def fill():\n    lev¦el = 1\n  end\n  fill()\n",
     "Declare `level` global in `fill`",
     "  global level\n  level = 0\n  def fill():\n    global level\n    level = 1\n  end\n  fill()\n"),
    ("  def fill():\n    level = 1\n  end\n  fill()\n  textmsg(lev¦el)\n", "Declare `level` global in `fill`",
     "  def fill():\n    global level\n    level = 1\n  end\n  fill()\n  textmsg(level)\n"),
    ("  if get_flag(0)¦:\n    sync()\n", "Close the `if` with `end`", "  if get_flag(0):\n    sync()\n  end\n"),
    ("  x¦ = y1\n  textmsg(x)\n", "Ignore W201 in line 2", "  x = y1  # check: ignore[W201]\n  textmsg(x)\n"),
    ("  x = y1 # why\n  textmsg(¦x, z1)\n",
     "Ignore W201 in line 3", "  x = y1 # why\n  textmsg(x, z1)  # check: ignore[W201]\n"),
    ("  x = ¦y1 # why\n  textmsg(x)\n",
     "Ignore W201 in line 2", "  x = y1 # why  # check: ignore[W201]\n  textmsg(x)\n"),
    ("  x = ¦y1 # check: ignore[W230]\n  textmsg(x)\n",
     "Ignore W201 in line 2", "  x = y1 # check: ignore[W230, W201]\n  textmsg(x)\n"),
    ("  x = ¦'''\n  ''' + y1\n  textmsg(x)\n", None, ""),
    ("  movej(¦\n", None, ""),
]  # fmt: skip


def actions(lines: str):
    document, line, column = marked(HEAD + lines + TAIL)
    return document, {action.title: action for action in code_actions(document, Span(line, column, line, column))}


@pytest.mark.parametrize(("lines", "title", "after"), TABLE)
def test_what_is_offered_and_what_it_makes(lines, title, after):
    document, found = actions(lines)
    if title is None:
        assert found == {}
        return
    assert title in found
    assert apply_fixes(document.text, [Fix("", found[title].edits, True)]) == HEAD + after + TAIL


@pytest.mark.parametrize("lines", [lines for lines, title, _ in TABLE if title and title.startswith("Ignore")])
def test_what_is_ignored_is_not_found_again(lines):
    document, found = actions(lines)
    action = next(action for title, action in found.items() if title.startswith("Ignore"))
    after = Document("cell.script", apply_fixes(document.text, [Fix("", action.edits, True)]))
    gone = {(problem.code, problem.line) for problem in action.problems}
    assert gone
    assert gone.isdisjoint((problem.code, problem.line) for problem in after.problems)


def test_what_keeps_a_program_from_starting_cannot_be_ignored():
    _, found = actions("  x = ¦\n")
    assert not any(title.startswith("Ignore") for title in found)


def test_a_certain_repair_is_preferred_and_comes_first():
    _, found = actions("  syn¦c\n")
    first = next(iter(found.values()))
    assert (first.title, first.is_preferred) == ("Call it", True)
    _, found = actions("  movel([¦400, 0, 300, 3.14, 0, 0])\n")
    assert not any(action.is_preferred for action in found.values())


def test_a_finding_elsewhere_on_the_line_counts_for_a_cursor_but_not_for_a_selection():
    document, found = actions("  ¦x = true\n  textmsg(x)\n")
    assert "Write True" in found
    assert code_actions(document, Span(2, 1, 2, 3)) == ()


class TestFixAll:
    TEXT = "def job():\n  print 'a'\n  x = true\n  if x <> 1:\n    sync\n  end\nend\n"

    def test_it_makes_what_check_makes(self):
        document = Document("cell.script", self.TEXT)
        action = fix_all(document)
        assert action is not None
        after = apply_fixes(self.TEXT, [Fix("", action.edits, True)])
        assert after == repaired("cell.script", self.TEXT, PROFILES[DEFAULT_FIRMWARE])[0]
        assert "print('a')" in after
        assert (action.title, action.kind) == ("Make 4 safe repairs", ActionKind.FIX_ALL)

    def test_line_ends_and_mark_stay(self):
        text = "\ufeff" + self.TEXT.replace("\n", "\r\n")
        action = fix_all(Document("cell.script", text))
        assert action is not None
        after = apply_fixes(text, [Fix("", action.edits, True)])
        assert after == repaired("cell.script", text, PROFILES[DEFAULT_FIRMWARE])[0]

    def test_there_is_none_without_safe_repairs(self):
        assert fix_all(Document("cell.script", "def job():\n  movl(1)\nend\n")) is None
