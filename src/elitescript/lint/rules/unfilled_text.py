"""A text with places that nothing fills: `{name}` without the `f` in front, `%d` without the `%` behind.

`textmsg` writes what it gets one after the other.

    def job():
      n = 3
      textmsg("part {n}")                         # W276: f"part {n}"
      textmsg("part %d of %d", n, 5)              # W276: "part %d of %d" % (n, 5)
      textmsg("part ", n, " of ", 5)              # fine
    end
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from typing import Final

from elitescript.language.diagnostics import Edit, Fix
from elitescript.language.symbols import Resolution
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.said import said

_NAMED: Final = re.compile(r"\{([A-Za-z_]\w*)(?:\[\d+\])?(?::[^{}]*)?\}")
_PERCENT: Final = re.compile(r"%(?:[-+0 #]*\d*(?:\.\d+)?)[dfisgxe](?![A-Za-z])")
_NUMBERED: Final = re.compile(r"\{\d*\}")
_SHOWING: Final = frozenset(("textmsg", "popup", "print"))
_SENDING: Final = frozenset(("socket_send_line", "socket_send_string", "serial_write"))


@rule(code="W276", since="0.3")
def unfilled_text(program: AnalysedProgram) -> Iterator[Finding]:
    """Report texts that are shown or sent like this."""
    for call in program.nodes(ast.Call):
        if not isinstance(call.func, ast.Name) or call.func.id not in _SHOWING | _SENDING or not call.args:
            continue
        for text in call.args:
            if isinstance(text, ast.Constant) and isinstance(text.value, str):
                yield from _named(program, text, text.value)
        first = call.args[0]
        if call.func.id in _SHOWING and isinstance(first, ast.Constant) and isinstance(first.value, str):
            yield from _behind(call, first, first.value)


def _named(program: AnalysedProgram, node: ast.Constant, text: str) -> Iterator[Finding]:
    """Yield a text with the name of a variable in braces."""
    scope = program.symbols.scope_of(node)
    for name in _NAMED.findall(text):
        if scope.resolve(name) is not Resolution.BUILTIN:
            line, column, _, _ = program.span(node)
            fix = None
            if program.source.line(line)[column - 1 : column] in ("'", '"'):
                fix = Fix("write f in front of it", (Edit(line, column, line, column, "f"),), safe=False)
            words = said("the text has `{{{name}}}` in it, not the value of `{name}`", name=name)
            yield Finding(node, words, "write f in front of the quotation mark", fix)
            return


def _behind(call: ast.Call, node: ast.Constant, text: str) -> Iterator[Finding]:
    """Yield a text with places, and the values for them as further arguments."""
    number = len(call.args) - 1
    if not number or any(isinstance(part, ast.Starred) for part in call.args):
        return
    for pattern, way in ((_PERCENT, "%"), (_NUMBERED, "format")):
        found = pattern.findall(text.replace("%%", ""))
        if len(found) == number:
            words = said(
                "{command} writes its arguments one after the other, and `{place}` stays as it is",
                command=call.func.id if isinstance(call.func, ast.Name) else "",
                place=found[0],
            )
            values = ", ".join(ast.unparse(part) for part in call.args[1:])
            shown = ast.unparse(node)
            meant = f"{shown} % ({values})" if way == "%" else f"{shown}.format({values})"
            yield Finding(node, words, said("write {meant}", meant=meant))
            return
