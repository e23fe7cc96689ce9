"""A command that is known but not simulated: the program ends with an alarm where it is reached.

On the robot it may work; here nothing takes its place.

    def job():
      not_simulated_command()    # W260
    end
"""

from __future__ import annotations

from collections.abc import Iterator

from elitescript.commands.catalogue import CATALOGUE
from elitescript.lint.program import Program
from elitescript.lint.registry import Finding, rule


@rule(code="W260", since="0.1")
def not_simulated(program: Program) -> Iterator[Finding]:
    """Report each use of such a command that the firmware has."""
    for use in program.outside:
        command = CATALOGUE.get(use.name)
        if command is None or command.is_simulated or not program.is_available(command):
            continue
        text = f"{use.name} is not simulated: the program ends with an alarm (R106) when it is reached"
        yield Finding(use.node, text, "run this part on the robot, or put a function of that name in its place")
