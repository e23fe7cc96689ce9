"""Services at places of the example programs, also of texts that are cut there: nothing raises."""

from __future__ import annotations

from pathlib import Path

import pytest

from elitescript.assist.actions import code_actions
from elitescript.assist.completion import completions, resolved
from elitescript.assist.document import Document, Settings
from elitescript.assist.hints import inlay_hints
from elitescript.assist.hover import hover
from elitescript.assist.lenses import code_lenses
from elitescript.assist.signatures import signature_help
from elitescript.lint.program import Span
from elitescript.models.model import load_model

EXAMPLES = sorted((Path(__file__).parents[2] / "examples").glob("*.script"))
SETTINGS = Settings(arm=load_model("CS66"))


def visit(document: Document, line: int, column: int) -> None:
    for item in completions(document, line, column)[:3]:
        assert item.span.line == item.span.end_line
        resolved(item)
    hover(document, line, column)
    signature_help(document, line, column)
    code_actions(document, Span(line, column, line, column))


def visit_examples(paths: list[Path], step: int) -> None:
    for path in paths:
        text = path.read_text(encoding="utf-8")
        whole = Document(path.name, text, 0, SETTINGS)
        for offset in range(0, len(text) + 1, step):
            visit(whole, *whole.place(offset))
        for offset in range(0, len(text) + 1, 40 * step):
            rest = text[offset:].partition("\n")[2]
            for cut in (text[:offset], f"{text[:offset]}\n{rest}"):
                document = Document(path.name, cut, 0, SETTINGS)
                visit(document, *document.place(offset))
                code_lenses(document)
                inlay_hints(document, Span(1, 1, document.line_count, 1))


def test_many_places():
    visit_examples(EXAMPLES[::4], 53)


@pytest.mark.invariants
@pytest.mark.slow
@pytest.mark.timeout(300)
@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_every_place(path):
    visit_examples([path], 1)


ODD = ["", "\n", "\0", "\ud800", "\ufeff", "\t\r\n", "((((", "'", '"""', "#", "end", "def", "$ LINE: (1,", ")]}", "\\"]


@pytest.mark.parametrize("text", ODD)
def test_odd_texts(text):
    document = Document("odd.script", text)
    for line in (-1, 0, 1, 2, 99):
        for column in (-1, 0, 1, 2, 99):
            visit(document, line, column)
    assert inlay_hints(document, Span(0, 0, 99, 99)) == ()
    code_lenses(document)
