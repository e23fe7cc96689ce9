"""A command that came with a newer firmware than the one that the program is for.

On the chosen firmware the name does not exist: an alarm when it is reached.

    def job():                   # checked with --firmware 2.10
      halt()                     # E302: came with 2.14
    end
"""

from __future__ import annotations

from collections.abc import Iterator

from elitescript.commands.catalogue import CATALOGUE
from elitescript.lint.program import Program
from elitescript.lint.registry import Finding, rule
from elitescript.messages.profile import PROFILES, Release, release_of


@rule(code="E302", since="0.1")
def newer_command(program: Program) -> Iterator[Finding]:
    """Report each use of such a command."""
    for use in program.outside:
        command = CATALOGUE.get(use.name)
        if command is None or program.is_available(command) or program.expects_missing_names(use.node):
            continue
        text = f"{use.name} needs firmware {command.since} or newer; the program is checked for {program.profile.name}"
        yield Finding(use.node, text, _advice(release_of(command.since)))


def _advice(needed: Release) -> str:
    newer = [profile.name for profile in PROFILES.values() if profile.release >= needed]
    return f"if the robot has it, choose --firmware {newer[0]}" if newer else "it cannot be chosen here yet"
