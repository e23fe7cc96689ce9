"""An `import` of a module that programs do not get.

Programs find the calculating part of Python's library; what would reach the computer is refused when the line
is reached (`ImportError`). The robot's own Python may have more modules: what runs there may not run here.

    def job():
      import ctypes              # W213
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator

from elitescript.language.advice.unknown_names import nearest
from elitescript.language.modules import AVAILABLE, NETWORK
from elitescript.language.policy import is_future
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.said import said


@rule(code="W213", since="0.1")
def unavailable_module(program: AnalysedProgram) -> Iterator[Finding]:
    """Report each module that is imported and not available."""
    for statement in program.nodes(ast.Import):
        for alias in statement.names:
            if alias.name not in AVAILABLE:
                yield Finding(program.name_span(alias, alias.name), *_refusal(alias.name))
    for origin in program.nodes(ast.ImportFrom):
        name = "." * origin.level + (origin.module or "")
        if name not in AVAILABLE and not is_future(origin):
            yield Finding(program.header_span(origin), *_refusal(name))


def _refusal(name: str) -> tuple[str, str]:
    if name.startswith("."):
        return "a program is no package: nothing can be imported from its neighbours", "write it into the program"
    text = said("the module `{name}` is not available to programs", name=name)
    if name.partition(".")[0] in NETWORK:
        return text, "socket_open, socket_send_string, rpc_factory and their like reach the network"
    meant = nearest(name, AVAILABLE)
    return text, said("is `{meant}` meant?", meant=meant) if meant else ""
