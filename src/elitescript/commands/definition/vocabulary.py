"""Collects the names that a firmware has, and those of other languages, for advice on unknown names."""

from __future__ import annotations

from collections.abc import Collection, Container, Mapping
from functools import cache

from elitescript.commands.catalogue import CATALOGUE
from elitescript.commands.definition.foreign import FOREIGN
from elitescript.commands.definition.reserved import RESERVED
from elitescript.messages.profile import PROFILES, Profile, release_of
from elitescript.records import NamedTuple
from elitescript.said import said


class Vocabulary(NamedTuple):
    """Names around a program.

    Attributes:
        commands: the commands that the firmware has.
        foreign: names of other languages, and the command that does the same.
        reserved: names that no released command has, and that programs may not define.
    """

    commands: Collection[str]
    foreign: Mapping[str, str]
    reserved: Container[str]


@cache
def vocabulary_of(profile: Profile) -> Vocabulary:
    """Return the names of one firmware."""
    commands = frozenset(command.name for command in CATALOGUE if release_of(command.since) <= profile.release)
    return Vocabulary(commands, FOREIGN, RESERVED)


def newer_firmware_text(name: str, since: str, profile: Profile) -> str:
    """Return the message about a command that the firmware does not have yet, before and during the run."""
    return said(
        "{name} needs firmware {since} or newer; the chosen one is {profile}",
        name=name,
        since=since,
        profile=profile.name,
    )


def newer_firmware_hint(since: str) -> str:
    """Return the hint for a command that the firmware does not have yet."""
    newest = max(PROFILES.values(), key=lambda profile: profile.release)
    if release_of(since) > newest.release:
        return said("the newest firmware that is simulated is {newest}", newest=newest.name)
    return said("if the robot has it, choose --firmware {newest}", newest=newest.name)
