"""Names of files in a text."""

from __future__ import annotations

import pytest

from elitescript.assist.document import Document
from elitescript.assist.links import document_links


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("load_micro_line_file('seam.txt', 0)\n", ["1:23 task seam.txt"]),
        ("load_micro_line_file(file_name=name)\n", []),
        ('with open(get_task_path() + "points.txt") as f:\n  pass\nend\n', ["1:30 task points.txt"]),
        ("def open(x): pass\nopen('a.txt')\n", []),
        (
            "# Run  elitescript run cells/a.script --world cells/b.toml, é\nx = 'c.toml'\n",
            ["1:24 named cells/a.script", "1:47 named cells/b.toml"],
        ),
        ("# see http://example.org/a.toml and script.\n", []),
        ("", []),
    ],
)
def test_links(text: str, expected: list[str]) -> None:
    document = Document("cell.script", text)
    found = document_links(document)
    assert [f"{link.span.line}:{link.span.column} {link.kind} {link.path}" for link in found] == expected
    for link in found:
        assert document.line(link.span.line)[link.span.column - 1 : link.span.end_column - 1] == link.path
