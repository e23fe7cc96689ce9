"""Names of all scripts: what Python's tokenizer reads as one word is one word everywhere."""

import re
import sys
from unicodedata import normalize

import pytest

from elitescript.assist import formatting
from elitescript.assist.completion import completions
from elitescript.assist.document import Document
from elitescript.assist.formatting import format_edits, formatted
from elitescript.assist.hover import hover
from elitescript.assist.renaming import rename
from elitescript.cli.main import main
from elitescript.language.text.lexer import NAME, WORD_END, WORD_START, is_in_word
from tests.assist.reading import cut, marked

NAMES = ["pre\u0301", "e\u0301", "हिन्दी", "ที่", "นาม", "a\U000e0100", "a\u203fb", "\u2118x", "x\u00b7y", "数字"]


def test_the_pattern_takes_what_python_takes():
    name, word = re.compile(NAME), re.compile(r"\w")
    taken = [chr(code) for code in range(128, sys.maxunicode + 1) if ("a" + chr(code)).isidentifier()]
    assert [character for character in taken if not name.fullmatch("a" + character)] == []
    assert all(map(is_in_word, taken))
    not_taken = (chr(code) for code in range(128, sys.maxunicode + 1) if chr(code).isprintable())
    others = [c for c in not_taken if not (word.match(c) or is_in_word(c)) and name.fullmatch("a" + c)]
    assert others == []


@pytest.mark.parametrize("name", NAMES)
def test_a_name_is_one_word(name):
    assert name.isidentifier()
    assert re.fullmatch(NAME, name)
    assert re.findall(rf"{WORD_START}{name}{WORD_END}", f"{name}={name}+x{name}") == [name, name]


@pytest.mark.parametrize("name", NAMES)
def test_layout_keeps_names_whole(name):
    body = f"  {name}=1\n  textmsg({name}+2*{name},f'{{{name}}}')\n  def f({name}=3):\n    return {name}\n  end\n"
    text = f"def job():\n{body}end\n"
    expected = text.replace(f"  {name}=1", f"  {name} = 1").replace(f"{name}+2*{name},", f"{name} + 2 * {name}, ")
    assert formatted(text).text == expected


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("kind", ["def", "sec"])
def test_a_program_may_have_such_a_name(name, kind):
    document = Document("p.script", f"{kind} {name}():\n  sync()\nend\n")
    assert not document.parsed.has_errors
    assert document.parsed.name == normalize("NFKC", name)


@pytest.mark.parametrize("name", NAMES)
def test_editors_see_the_whole_name(name):
    text = f"def job():\n  {name} = 0.5\n  textmsg({name}¦)\nend\n"
    document, line, column = marked(text)
    explained = hover(document, line, column)
    assert explained is not None
    assert cut(document, explained.span) == f"3:{name}"
    assert normalize("NFKC", name) in {normalize("NFKC", item.label) for item in completions(document, line, column)}
    edits = rename(document, line, column, "mass").edits
    assert {(edit.line, edit.text) for edit in edits} == {(2, "mass"), (3, "mass")}


def test_what_would_run_in_another_way_is_not_written(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(formatting, "spaced", lambda *args: "x = 2")
    text = "def job():\n  x=1\nend\n"
    assert formatted(text).text == text
    assert formatted(text).changed_line == 2
    assert format_edits(Document("p.script", text)) == ()
    path = tmp_path / "p.script"
    path.write_text(text)
    assert main(["fmt", str(path)]) == 3
    assert path.read_text() == text
    assert "line 2 would run in another way" in capsys.readouterr().err


@pytest.mark.parametrize(
    "new",
    ["x = 1.0", "y = 1", "x = 1; y", "x = -1", "x = True", "x == 1", "x = (1,)", "", "if"],
)
def test_each_difference_is_seen(monkeypatch, new):
    monkeypatch.setattr(formatting, "spaced", lambda *args: new)
    assert formatted("def job():\n  x=1\n  sync()\nend\n").changed_line >= 1
