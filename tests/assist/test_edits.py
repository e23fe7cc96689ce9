"""Random edits: the document after them is the document of the same text, in every answer; and nothing raises.

The text is kept a second time by a model that knows nothing of documents.
"""

from __future__ import annotations

import ast
import json
import re
from itertools import pairwise
from pathlib import Path
from random import Random
from typing import Any

import pytest

from elitescript.assist import calls, diagnostics, folding, links, outline, references, renaming, selection, tokens
from elitescript.assist.document import Document
from elitescript.language.diagnostics import Edit
from elitescript.lint.engine import check_source
from elitescript.lint.program import Span
from tests.assist.random_scopes import random_scopes
from tests.invariants.cases import CASES
from tests.language.random_programs import random_program

ROOT = Path(__file__).parents[2]
EXAMPLES = tuple(path.read_text(encoding="utf-8") for path in sorted((ROOT / "examples").glob("*.script")))
CALLS = tuple(
    item["call"]
    for item in json.loads((ROOT / "tests/data/command_examples.json").read_text(encoding="utf-8"))["examples"]
)
BOM = "\ufeff"
BITS = (
    *(
        "\n",
        "\r\n",
        "\r",
        "\r\n\r",
        "  ",
        "\t",
        "x",
        "é",
        "😀",
        "👩‍🔧",
        "步骤",
        "\0",
        "\ud800",
        "\u2028",
        "\f",
        "\ufeff",
    ),
    *("(", ")", "[", "]", "'", '"', "'''", "\\", "#", ":", ",", ";", "=", "$", "@", "`", "{", "}"),
    *(
        "end\n",
        "\nend\n",
        "def f():\n  a = 1\nend\n",
        "sec s():\n",
        "class K:\n  a = 1\n",
        "thread t():\n",
        "else:\n",
        "try:\n",
    ),
    *(
        '$ LINE: (1, "main")\n',
        "global a\n",
        "start_thread(f, ())\n",
        "# region\n",
        "# endregion\n",
        "import math\n",
        "f(a=1)",
    ),
    *(
        "movej([0, 0, 0, 0, 0, 0])\n",
        "socket_open('1.2.3.4', 80, 'cam')\n",
        "f'{a:>{b}}'",
        "lambda a: a",
        "[a for a in b]",
    ),
)


def applied(text: str, edit: Edit) -> str:
    """Return the text after an edit: a model of lines with their ends."""
    mark, body = (BOM, text[1:]) if text.startswith(BOM) else ("", text)
    rows = re.findall(r"[^\r\n]*(?:\r\n|\r|\n)|[^\r\n]+\Z|\Z", body)
    if len(rows) > 1 and rows[-1] == "" and not rows[-2].endswith(("\r", "\n")):
        rows.pop()

    def offset(line: int, column: int) -> int:
        line = max(1, min(line, len(rows)))
        return sum(map(len, rows[: line - 1])) + max(0, min(column - 1, len(rows[line - 1].rstrip("\r\n"))))

    start = offset(edit.line, edit.column)
    end = max(start, offset(edit.end_line, edit.end_column))
    return mark + body[:start] + edit.text + body[end:]


def random_edit(rng: Random, document: Document) -> Edit:
    line = rng.randrange(0, document.line_count + 3)
    column = rng.randrange(1, len(document.line(line)) + 4)
    kind = rng.randrange(4)
    end_line = line if kind else min(line + rng.randrange(4), document.line_count + 2)
    end_column = column + rng.choice((0, 0, 1, 5)) if end_line == line else rng.randrange(1, 20)
    return Edit(line, column, end_line, end_column, rng.choice(BITS) if kind != 1 else "")


def answers(document: Document, rng: Random) -> list[Any]:
    """Return what every service says of a document, at some of its places."""
    symbols = outline.document_symbols(document)
    found: list[Any] = [
        diagnostics.diagnostics(document),
        symbols,
        outline.workspace_symbols([document], rng.choice(("", "a", "jb"))),
        folding.folding_ranges(document),
        tokens.semantic_tokens(document),
        tokens.semantic_tokens(document, Span(2, 1, 5, 1)),
        links.document_links(document),
    ]
    places = [(rng.randrange(0, document.line_count + 2), rng.randrange(1, 30)) for _ in range(2)]
    named = document.names.occurrences
    places += [item.span[:2] for item in rng.sample(named, min(3, len(named)))]
    found.append(selection.selection_ranges(document, places))
    for line, column in places:
        found.append(references.definition(document, line, column))
        found.append(references.references(document, line, column, include_definition=rng.random() < 0.5))
        found.append(references.highlights(document, line, column))
        found.append(renaming.prepare_rename(document, line, column))
        found.append(renaming.rename(document, line, column, rng.choice(("fresh", "a", "f", "end", "😀"))))
        for item in calls.prepare(document, line, column):
            found += [item, calls.incoming(document, item), calls.outgoing(document, item)]
    return found


def spans_in(value: Any) -> list[Span]:
    """Return all ranges in an answer."""
    if isinstance(value, (Span, Edit)):
        return [Span(*value[:4])]
    if isinstance(value, diagnostics.Problem):
        return [place.span for place in value.related]
    if isinstance(value, tokens.Token):
        return [Span(value.line, value.column, value.line, value.column + value.length)]
    if isinstance(value, folding.Fold):
        return [Span(value.line, 1, value.end_line, 1)]
    if isinstance(value, (list, tuple)):
        return [span for item in value for span in spans_in(item)]
    fields = getattr(type(value), "__record_fields__", ())
    return [span for field in fields for span in spans_in(getattr(value, field))]


def check_places(document: Document, found: Any) -> None:
    for token, following in pairwise(tokens.semantic_tokens(document)):
        assert (token.line, token.column + token.length) <= following[:2]
    for span in spans_in(found):
        assert 1 <= span.line <= span.end_line <= document.line_count, span
        assert span[:2] <= span[2:], span
        assert 1 <= span.column <= len(document.line(span.line)) + 1, span
        assert 1 <= span.end_column <= len(document.line(span.end_line)) + 1, span


def functions(rng: Random) -> str:
    """Return a program whose functions are trees that the next version may use again."""
    rows = ["def cell():", *rng.choice(([], ["  a = 1"], ["  global a", "  # first"]))]
    for number in range(rng.randrange(2, 5)):
        more = rng.choice(([], ["    # b", ""]))
        rows += [f"  def f{number % 3}(a=1):", "    b = a + 1", *more, "    return b", "  end"]
    return "\n".join([*rows, *rng.choice(([], ["  f0(a=2)"])), "end", ""])


def first_text(rng: Random) -> str:
    text = rng.choice((random_program, random_scopes))(rng)
    chance = rng.random()
    if chance < 0.2:
        text = rng.choice(EXAMPLES)[:1500]
    elif chance < 0.5:
        text = functions(rng)
    text = text.replace("\n", rng.choice(("\n", "\n", "\r\n", "\r")))
    return (BOM if rng.random() < 0.2 else "") + text


def tree_of(document: Document) -> tuple[Any, ...]:
    return ast.dump(document.parsed.tree, include_attributes=True), document.parsed.diagnostics


def edit_and_compare(seed: int, edits: int) -> None:
    rng = Random(seed)
    text = first_text(rng)
    document = Document("cell.script", text, 0)
    for version in range(1, edits + 1):
        group = [random_edit(rng, document)]
        text = applied(text, group[0])
        document = document.edited(group, version)
        assert document.text == text
        assert document.version == version
        # It is asked for in each version, since the next one uses what does not change again.
        assert tree_of(document) == tree_of(Document("cell.script", text, 0))
        line, column = rng.randrange(1, document.line_count + 1), rng.randrange(1, 40)
        assert document.place(document.offset(line, column)) == (line, min(column, len(document.line(line)) + 1))
    found = answers(document, Random(seed))
    assert found == answers(Document("cell.script", text, 0), Random(seed))
    check_places(document, found)


def mutilate(seed: int) -> None:
    """Delete parts of a real program, and ask everything."""
    rng = Random(seed)
    text = (
        rng.choice(EXAMPLES) if rng.random() < 0.5 else "def job():\n  " + "\n  ".join(rng.sample(CALLS, 5)) + "\nend\n"
    )
    for _ in range(rng.randrange(1, 6)):
        start = rng.randrange(len(text) + 1)
        text = text[:start] + text[start + rng.choice((1, 3, 20, 200)) :]
    document = Document("cell.script", text)
    check_places(document, answers(document, rng))
    # The findings come from what the document has read for other answers too.
    assert document.problems == check_source(document.source, document.settings.profile)


def test_edits_lead_to_the_document_of_the_same_text() -> None:
    for seed in range(CASES // 2):
        edit_and_compare(seed, 5)


def test_mutilated_programs_get_an_answer() -> None:
    for seed in range(CASES // 4):
        mutilate(seed)


@pytest.mark.invariants
@pytest.mark.slow
@pytest.mark.timeout(1200)
def test_ten_thousand_edits_and_a_thousand_mutilations() -> None:
    for seed in range(2_000):
        edit_and_compare(1_000_000 + seed, 5)
    for seed in range(1_000):
        mutilate(1_000_000 + seed)
