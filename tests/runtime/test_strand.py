import builtins
import sys
import warnings
from contextlib import nullcontext

import pytest

from elitescript.runtime.threads import strand as strand_module
from elitescript.runtime.threads.strand import (
    ENDED,
    SHORT_TABLE,
    STOP,
    TABLES_MAX,
    LineTables,
    Stopped,
    Strand,
    is_stop,
    is_unwinding,
)

SCRIPT = {"__builtins__": {}}["__builtins__"]


def make(body, builtins=None):
    return Strand(0, "work", body, SCRIPT if builtins is None else builtins)


def script_function(text, builtins, **names):
    """A function whose frames count as script code."""
    space = {"__builtins__": builtins, **names}
    exec(compile(text, "<script>", "exec"), space)
    return space["main"]


def test_it_keeps_its_place_between_two_turns():
    seen = []

    def body():
        seen.append(1)
        strand.suspend()
        seen.append(2)

    strand = make(body)
    strand.resume()
    assert (seen, strand.is_started, strand.is_finished) == ([1], True, False)
    strand.resume()
    assert (seen, strand.is_finished) == ([1, 2], True)


def test_it_can_give_way_inside_a_built_in_function():
    strand = make(lambda: seen.append(sorted([3, 1, 2], key=key)))
    seen = []

    def key(value):
        strand.suspend()
        return value

    for _ in range(4):
        assert seen == []
        strand.resume()
    assert seen == [[1, 2, 3]]


def test_its_line_is_the_innermost_one_of_script_text():
    builtins = {}
    text = "def main():\n  first()\n\n  second()\n"
    strand = make(lambda: main(), builtins)
    main = script_function(text, builtins, first=lambda: strand.suspend(), second=lambda: strand.suspend())
    assert strand.line == 0
    lines = []
    for _ in range(2):
        strand.activations += 1
        strand.resume()
        lines.append(strand.line)
    strand.activations += 1
    strand.resume()
    strand.state = ENDED
    assert (lines, strand.line) == ([2, 4], 0)


def test_its_line_is_known_while_it_runs():
    builtins = {}
    strand = make(lambda: main(), builtins)
    seen = []
    main = script_function("def main():\n\n  look()\n", builtins, look=lambda: seen.append(strand.line))
    strand.resume()
    assert seen == [3]


def test_what_the_script_has_called_is_found():
    builtins = {}
    strand = make(lambda: main(), builtins)

    def outer():
        inner()

    def inner():
        strand.suspend()

    main = script_function("def main():\n  outer()\n", builtins, outer=outer)
    strand.resume()
    assert strand.called_from_script().f_code.co_name == "outer"


@pytest.mark.parametrize("handler", [Exception, ValueError])
def test_a_stop_passes_handlers_of_exceptions(handler):
    with pytest.raises(Stopped):
        try:
            raise Stopped
        except handler:
            pass
    assert issubclass(Stopped, STOP)


def test_a_stop_is_told_from_other_exceptions():
    assert is_stop(Stopped())
    assert is_stop(STOP())
    assert not is_stop(KeyboardInterrupt())
    assert not is_stop(None)


def test_a_finally_block_that_a_stop_passes_is_unwinding():
    seen = []
    with pytest.raises(Stopped):
        try:
            raise Stopped
        finally:
            seen.append(is_unwinding())
            try:
                raise ValueError
            except ValueError:
                seen.append(is_unwinding())
    assert seen == [True, True]
    assert not is_unwinding()


def test_a_stop_that_was_swallowed_is_not_unwinding():
    # As text: Python 3.14 warns of such a `return` when it compiles the file.
    text = "def swallow():\n  try:\n    raise Stopped\n  finally:\n    return is_unwinding()\n"
    names = {"Stopped": Stopped, "is_unwinding": is_unwinding}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SyntaxWarning)
        exec(text, names)
    assert names["swallow"]() is True
    assert not is_unwinding()


def test_an_abandoned_stack_is_kept(monkeypatch):
    kept = []
    monkeypatch.setattr(strand_module, "_abandoned", kept)
    strand = make(lambda: strand.suspend())
    strand.resume()
    strand.abandon()
    assert strand.is_abandoned and len(kept) == 1
    strand.resume()


class TestLines:
    """The line of a frame is what Python says, whatever the length of the code."""

    TEXT = """def main():
  note()
  if note():
    x = [note(),

      note()] if note() else (
      note())
  for n in range(2):
    with keep(note()): note(); note()
  try:
    note(); fail()
  except ValueError:
    note()
  finally:
    y = {name: note()
      for name in "ab"}
"""

    def lines(self, text):
        """The lines that a table says and those that Python says, of all frames from which `note` is called."""
        tables, seen = LineTables(), []

        def note():
            frame = sys._getframe(1)
            seen.append((tables.line_of(frame), frame.f_lineno))
            return True

        def fail():
            raise ValueError

        script_function(text, vars(builtins), note=note, fail=fail, keep=nullcontext)()
        return seen

    @pytest.mark.parametrize("count", [1, 60])
    def test_they_are_those_of_python(self, count):
        body = "".join(self.TEXT.splitlines(keepends=True)[1:])
        seen = self.lines("def main():\n" + count * body)
        assert len(seen) == count * 15
        assert [said for said, _ in seen] == [line for _, line in seen]

    def test_a_frame_that_has_not_begun_is_in_its_first_line(self):
        text = "def main():\n  yield 1\n" + 200 * "  note(1, 2, 3)\n"
        made = script_function(text, {})()
        assert len(made.gi_code.co_linetable) > SHORT_TABLE
        assert LineTables().line_of(made.gi_frame) == made.gi_frame.f_lineno == 1

    def test_of_a_long_code_one_table_is_made_and_no_more_than_a_few_are_kept(self):
        tables = LineTables()
        made = [
            script_function("def main():\n  yield 1\n" + 200 * f"  note({n})\n", {})() for n in range(TABLES_MAX + 1)
        ]
        for generator in made:
            assert next(generator) == 1
        for _ in range(3):
            assert {tables.line_of(generator.gi_frame) for generator in made[:-1]} == {2}
        assert len(tables._tables) == TABLES_MAX
        assert tables.line_of(made[-1].gi_frame) == 2
        assert len(tables._tables) == 1
