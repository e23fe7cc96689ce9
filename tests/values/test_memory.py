"""What is known of the version before is used for the next one: it gives the same values, and less is evaluated."""

from __future__ import annotations

import ast
from random import Random

import pytest

from elitescript.assist.document import Document
from elitescript.language.diagnostics import Edit, Outdated
from elitescript.values.description import Shape, Value
from tests.invariants.cases import first_of
from tests.values.random_programs import Drawn

TEXT = """def job():
  global count
  count = 0
  def pick(height, speed):
    movel([0.4, 0, height, 3.14, 0, 0], v=speed)
    return height + 1
  end
  def place(height):
    x = 5
    parts = [height, 2]
    parts[0] = 3
    return pick(height, 0.2)
  end
  def reset():
    global count
    count = 7
  end
  def watch():
    while count < 3:
      sync()
    end
    return count
  end
  pick(0.1, 0.5)
  y = place(0.2)
  reset()
  textmsg(watch(), y)
end
"""


def next_version(document: Document, text: str) -> Document:
    """Return a document with a text, made by an edit of what differs."""
    rows = document.text.split("\n")
    last = len(rows), len(rows[-1]) + 1
    return document.edited([Edit(1, 1, *last, text)], document.version + 1)


def evaluated(*texts: str) -> list[str]:
    """Return the functions that are evaluated of the last of some versions, each once."""
    document = Document("a.script", texts[0])
    document.twin().program.values.of(ast.Constant(0))
    for text in texts[1:]:
        document = next_version(document, text)
        found = document.twin().program.values.evaluated_functions
        agree(document, text)
    return sorted(set(found))


def described(value: Value) -> object:
    """Return a description as plain data."""
    shape = value.shape
    parts: object = None
    if isinstance(shape, Shape):
        items = None if shape.items is None else [described(item) for item in shape.items]
        parts = (items, None if items is not None else described(shape.element), shape.least, shape.most)
    constants = None if value.constants is None else sorted(map(repr, value.constants))
    refs = None if value.refs is None else len(value.refs)
    return (value.kinds, value.low, value.high, constants, value.role, value.may, value.must, parts, refs)


def agree(document: Document, text: str) -> None:
    """Compare the values and findings of a version with those of the same text alone."""
    twin, alone = document.twin(), Document("a.script", text)
    assert ast.dump(twin.parsed.tree, include_attributes=True) == ast.dump(alone.parsed.tree, include_attributes=True)
    values, expected = twin.program.values, alone.program.values
    assert values.is_known == expected.is_known
    for node, other in zip(ast.walk(twin.parsed.tree), ast.walk(alone.parsed.tree), strict=True):
        if isinstance(node, ast.expr) and isinstance(other, ast.expr):
            assert described(values.of(node)) == described(expected.of(other)), (ast.unparse(node), node.lineno)
    assert twin.problems == alone.problems


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("x = 5", "x = 6", ["job", "place"]),
        ("x = 5", "x = 5  # five", ["job", "place"]),
        ("  def reset", "\n\n  def reset", []),
        ("parts[0] = 3", "parts[0] = 4", ["job", "place"]),
        # What `pick` returns is another expression.
        ("v=speed", "v=speed * 2", ["job", "pick", "place"]),
        ("height + 1", "height + 2", ["job", "pick", "place"]),
        ("pick(height, 0.2)", "pick(height, 0.3)", ["job", "pick", "place"]),
        ("count = 7", "count = 8", ["job", "reset", "watch"]),
        ("pick(0.1, 0.5)", "pick(0.1, 0.6)", ["job", "pick"]),
        ("textmsg(", "textmsg(1, ", ["job"]),
        ("  count = 0", "  count = 0\n  x = 2", ["job"]),
        ("def job():\n", "# a robot\ndef job():\n", []),
    ],
)
def test_only_functions_whose_text_or_inputs_have_changed_are_evaluated(old, new, expected):
    assert TEXT.count(old) == 1
    assert evaluated(TEXT, TEXT.replace(old, new)) == expected
    # And back again.
    assert evaluated(TEXT, TEXT.replace(old, new), TEXT) == expected


def test_nothing_is_evaluated_of_a_text_that_stays():
    assert evaluated(TEXT, TEXT) == []


def test_all_is_evaluated_of_a_text_with_classes():
    text = TEXT.replace("  pick(0.1", "  class A:\n    x = 1\n  end\n  pick(0.1")
    assert evaluated(text, text) == ["job", "pick", "place", "reset", "watch"]


def test_a_version_that_was_given_up_spoils_nothing():
    document = Document("a.script", TEXT)
    document.twin().program.values.of(ast.Constant(0))
    document = next_version(document, TEXT.replace("count = 7", "count = 8"))
    twin = document.twin()
    twin.is_outdated = True
    with pytest.raises(Outdated):
        twin.program.values.of(ast.Constant(0))
    after = TEXT.replace("x = 5", "x = 6")
    document = next_version(document, after)
    assert sorted(set(document.twin().program.values.evaluated_functions)) == ["job", "place", "reset"]
    agree(document, after)


def changed(rng: Random, text: str) -> str:
    """Return a text with a line changed, moved, left out or put in."""
    rows = text.split("\n")
    at = rng.randrange(1, max(2, len(rows) - 2))
    what = rng.randrange(5)
    if what == 0:
        rows.insert(at, "")
    elif what == 1:
        rows[at] = "".join(str(rng.randint(0, 9)) if char.isdigit() else char for char in rows[at])
    elif what == 2:
        indentation = rows[at][: len(rows[at]) - len(rows[at].lstrip())]
        rows.insert(at, f"{indentation}{rng.choice('abcuv')} = {rng.choice(['1', 'a', '[1, 2]', 'u', 'b + 1'])}")
    elif what == 3 and not rows[at].rstrip().endswith(":") and rows[at].strip() not in ("end", ""):
        del rows[at]
    else:
        rows[at] += "  # here"
    return "\n".join(rows)


@pytest.mark.parametrize("seed", first_of(range(1000), 8))
def test_values_of_changed_texts_are_those_of_the_text_alone(seed):
    rng = Random(seed)
    text = Drawn(rng).text() if seed % 3 else TEXT
    document = Document("a.script", text)
    document.twin().program.values.of(ast.Constant(0))
    for _ in range(6):
        text = changed(rng, text)
        document = next_version(document, text)
        if document.parsed.is_complete:
            agree(document, text)
