"""A blend radius below 0, which is taken for 0.

Down to -0.001 m a motion command takes it, because programs of the vendor's tools have such values; the arm then stops
at the waypoint. Only values that are certain before the run count; see `constants`.

    def job():
      movel(TARGET, r=-0.001)    # W250: write r=0
    end
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import get_args

from elitescript.commands.definition.quantities import BlendRadius
from elitescript.commands.motion import NEGATIVE_RADIUS_HINT, negative_radius_text
from elitescript.errors import ScriptError
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule


@rule(code="W250", since="0.1", needs_values=True)
def negative_radius(program: AnalysedProgram) -> Iterator[Finding]:
    """Report each such argument that the command takes."""
    for called, arguments in zip(program.command_calls, program.arguments, strict=True):
        for param, node in arguments.given:
            if param.quantity is not _RADIUS:
                continue
            try:
                radius = _RADIUS.coerce(program.constants.value(node, called.scope))
            except ScriptError:
                continue
            if radius < 0.0:
                yield Finding(node, negative_radius_text(radius), NEGATIVE_RADIUS_HINT)


_RADIUS = get_args(BlendRadius)[1]
