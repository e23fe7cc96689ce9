"""An assignment that makes a variable of its own where that of the enclosing program is meant.

Nothing reads the new variable, and the one that the enclosing program waits for keeps its value.

    def job():
      ready = False
      def watch():
        ready = True             # W258: write `nonlocal ready` above
      end
      start_thread(watch, ())
      while not ready:
        sync()
      end
    end
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from elitescript.language.scopes import Scope
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.said import said

_ASSIGNMENTS: Final = ("assign", "augmented", "annotated", "walrus")
_SHORTEST: Final = 2
"""Characters of a name that hardly stands for a thing of its own; `i` is a counter."""


@rule(code="W258", since="0.3", needs_all_lines=True)
def hidden_variable(program: AnalysedProgram) -> Iterator[Finding]:
    """Report the first assignment of each such variable."""
    are_read: dict[tuple[str, Scope], bool] = {}
    for scope in program.symbols.scopes:
        if scope.kind != "function" or scope.parent is None:
            continue
        for name, bindings in scope.bindings.items():
            if len(name) < _SHORTEST or name.startswith("_") or name in program.symbols.global_names:
                continue
            first = bindings[0]
            if first.kind not in _ASSIGNMENTS or not scope.has_local(name) or name in scope.parameters:
                continue
            home = scope.parent.home(name)
            if home is None or home.kind == "class" or program.symbols.reads_of(name, scope):
                continue
            if (name, home) not in are_read:
                are_read[name, home] = _is_read_by_others(name, home, program)
            if not are_read[name, home]:
                continue
            from elitescript.lint.insertions import declare

            where = f"`{home.name}`" if home.name else "the program"
            text = said(
                "`{name}` is a variable of its own here, and nothing reads it; that of {where} keeps its value",
                name=name,
                where=where,
            )
            hint = said("write `nonlocal {name}` at the start of the function `{scope}`", name=name, scope=scope.name)
            yield Finding(program.name_span(first.node, name), text, hint, declare(program, "nonlocal", name, scope))


def _is_read_by_others(name: str, home: Scope, program: AnalysedProgram) -> bool:
    """Return whether something reads the variable of the enclosing program, which is no function or loop of its own."""
    kinds = {binding.kind for binding in home.bindings.get(name, ())}
    if not kinds & {*_ASSIGNMENTS, "parameter"} or kinds & {"for", "def", "import"}:
        return False
    return bool(program.symbols.reads_of(name, home))
