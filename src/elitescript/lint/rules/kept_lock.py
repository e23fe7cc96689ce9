"""A lock that is acquired and never released: what acquires it again waits for ever.

`with lock:` releases it on every way out.

    def job():
      import threading
      lock = threading.Lock()
      def count():
        lock.acquire()                            # W238: nothing releases `lock`
      end
      start_thread(count, ())
      with lock:
        textmsg("alone")
      end
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from typing import Final

from elitescript.lint.list_changes import Variable, variable_of
from elitescript.lint.placing import conditions, loops
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.said import said

_LOCKS: Final = frozenset(("threading.Lock", "threading.RLock"))
_LEAVING: Final = (ast.Return, ast.Raise)


@rule(code="W238", since="0.3", needs_all_lines=True)
def kept_lock(program: AnalysedProgram) -> Iterator[Finding]:
    """Report locks that nothing releases, and ways out of a function that leave one acquired."""
    locks = {variable for node in program.nodes(ast.Assign) for variable in _made(program, node)}
    if not locks:
        return
    acquired: dict[Variable, list[ast.Call]] = {}
    released: dict[Variable, list[ast.Call]] = {}
    for call in program.nodes(ast.Call):
        if isinstance(call.func, ast.Attribute) and isinstance(call.func.value, ast.Name):
            variable = variable_of(program, call.func.value)
            is_asked = call.func.attr == "acquire" and (call.args or call.keywords)
            if variable in locks and call.func.attr in ("acquire", "release") and not is_asked:
                (acquired if call.func.attr == "acquire" else released).setdefault(variable, []).append(call)
    for variable, calls in acquired.items():
        calls.sort(key=lambda call: call.lineno)
        if variable not in released and not _is_passed(program, variable):
            if not _is_wanted_again(program, variable, calls):
                continue
            text = said("nothing releases the lock `{name}`", name=variable[0])
            yield Finding(calls[0], text, said("write {name}.release(), or use `with {name}:`", name=variable[0]))
            continue
        for call in calls:
            yield from _left(program, call, variable, released.get(variable, []))


def _made(program: AnalysedProgram, node: ast.Assign) -> Iterator[Variable]:
    """Yield the variable that gets a new lock."""
    call, target = node.value, node.targets[0]
    if not isinstance(call, ast.Call) or not isinstance(target, ast.Name) or len(node.targets) != 1:
        return
    scope = program.symbols.scope_of(node)
    name = ast.unparse(call.func)
    first, _, rest = name.partition(".")
    whole = program.symbols.imported(first, scope)
    if (f"{whole}.{rest}" if rest else whole) in _LOCKS:
        yield variable_of(program, target)


def _is_passed(program: AnalysedProgram, variable: Variable) -> bool:
    """Return whether a lock is used otherwise than by its methods and `with`."""
    for read in program.symbols.reads_of(*variable):
        if not isinstance(program.symbols.parent(read), (ast.Attribute, ast.withitem)):
            return True
    return False


def _is_wanted_again(program: AnalysedProgram, variable: Variable, calls: list[ast.Call]) -> bool:
    """Return whether anything may wait for a lock that is acquired once already."""
    symbols = program.symbols
    uses = [read for read in symbols.reads_of(*variable) if isinstance(symbols.parent(read), ast.withitem)]
    return len(calls) + len(uses) > 1 or any(True for _ in loops(symbols, calls[0]))


def _left(program: AnalysedProgram, call: ast.Call, variable: Variable, released: list[ast.Call]) -> Iterator[Finding]:
    """Yield the first `return` between an `acquire` and all that releases it in the same function."""
    symbols = program.symbols
    scope = symbols.scope_of(call)
    later = [other for other in released if symbols.scope_of(other) is scope and other.lineno > call.lineno]
    if not later or conditions(symbols, call):
        return
    if any(isinstance(above, ast.Try) for other in later for above in symbols.ancestors(other)):
        return
    first = min(other.lineno for other in later)
    for kind in _LEAVING:
        for node in program.nodes(kind):
            if symbols.scope_of(node) is scope and call.lineno < node.lineno < first:
                text = said("the lock `{name}` of line {line} stays acquired here", name=variable[0], line=call.lineno)
                yield Finding(node, text, said("release it before, or use `with {name}:`", name=variable[0]))
                return
