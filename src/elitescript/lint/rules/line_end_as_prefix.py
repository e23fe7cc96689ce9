"""A line end as the mark in front of a text: `socket_read_string` takes the prefix first, then the suffix.

The reading then waits for a line end, and takes what comes after it.

    def job():
      socket_open("192.168.1.20", 5000, "camera")
      s = socket_read_string("camera", "\\n")            # W248: suffix="\\n" reads to the end of the line
      s = socket_read_string("camera", suffix="\\n")     # fine
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator

from elitescript.language.diagnostics import Edit, Fix
from elitescript.lint.called import CalledCommands
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.said import said


@rule(code="W248", since="0.3", needs_values=True)
def line_end_as_prefix(program: AnalysedProgram) -> Iterator[Finding]:
    """Report each such reading."""
    called = program.derived(CalledCommands)
    for found in called.of("socket_read_string"):
        node = found.given.get("prefix")
        if node is None or called.texts(found, "suffix", "") != ("",):
            continue
        texts = called.texts(found, "prefix", "")
        if texts and all(text and not text.strip("\r\n\t ") for text in texts):
            written = ast.unparse(node)
            text = said(
                "socket_read_string: the prefix {written} is a mark in front of the text, not behind it",
                written=written,
            )
            fix = None
            if node in found.call.args and len(found.call.args) == 2:
                fix = Fix(
                    said("write suffix={written}", written=written),
                    (Edit(*program.span(node), f"suffix={written}"),),
                    safe=False,
                )
            yield Finding(node, text, said("suffix={written} reads to the end of the line", written=written), fix)
