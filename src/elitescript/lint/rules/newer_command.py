"""A command that came with a newer firmware than the one that the program is for.

On the chosen firmware the name does not exist: an alarm when it is reached.

    def job():                   # checked with --firmware 2.10
      halt()                     # E302: came with 2.14
    end
"""

from __future__ import annotations

from collections.abc import Iterator

from elitescript.commands.catalogue import CATALOGUE
from elitescript.commands.definition.vocabulary import newer_firmware_hint, newer_firmware_text
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule


@rule(code="E302", since="0.1")
def newer_command(program: AnalysedProgram) -> Iterator[Finding]:
    """Report each use of such a command."""
    for use in program.outside:
        command = CATALOGUE.get(use.name)
        if command is None or program.is_available(command) or program.expects_missing_names(use.node):
            continue
        text = newer_firmware_text(use.name, command.since, program.profile)
        yield Finding(use.node, text, newer_firmware_hint(command.since))
