"""The page of an audit gives both runs the text that their lines belong to."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import pytest

from elitescript.audit.page import recorded_source
from elitescript.language.text.source import SourceFile


@pytest.mark.parametrize(
    ("attachments", "text"), [({"cell.script": b"def a():\nend\n"}, "def a():\nend\n"), ({}, "def b():\nend\n")]
)
def test_recorded_lines_belong_to_the_recorded_program(attachments: dict[str, bytes], text: str):
    recording = SimpleNamespace(facts={"program": "cell.script"}, attachments=attachments)
    cell = SimpleNamespace(source=SourceFile("b.script", "def b():\nend\n"))
    audit = cast("Any", SimpleNamespace(recording=recording, cell=cell))
    assert recorded_source(audit).text == text
