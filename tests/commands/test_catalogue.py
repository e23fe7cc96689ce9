"""Every documented command is in the catalogue, with the signature that the manuals give."""

from __future__ import annotations

from typing import Any

import pytest

from elitescript.commands.catalogue import CATALOGUE
from elitescript.commands.definition.page import CHAPTERS
from elitescript.commands.definition.registry import Command
from elitescript.commands.definition.reserved import RESERVED
from tests.commands.facts import COMMANDS, good_arguments

BY_NAME = {facts["name"]: facts for facts in COMMANDS}
EVERY_NAME = sorted(CATALOGUE.names())

documented = pytest.mark.parametrize("facts", COMMANDS, ids=list(BY_NAME))


def command_called(name: str) -> Command:
    command = CATALOGUE.get(name)
    assert command is not None, name
    return command


def test_all_documented_commands_are_registered() -> None:
    assert len(COMMANDS) == 209
    assert [name for name in BY_NAME if CATALOGUE.get(name) is None] == []


def test_what_no_manual_describes_is_marked_observed() -> None:
    unknown = [command for command in CATALOGUE if command.name not in BY_NAME]
    assert {command.evidence for command in unknown} == {"observed"}
    assert {command.family for command in unknown} == {"observed"}


@documented
def test_signature_is_that_of_the_manual(facts: dict[str, Any]) -> None:
    command = command_called(facts["name"])
    wanted = [(param["name"], param.get("default_text", "")) for param in facts["params"]]
    assert [(param.name, param.default_text.replace('"', "'")) for param in command.params] == wanted
    assert command.family == facts["family"]
    assert command.since == facts["since"]


@documented
def test_units_are_those_of_the_manual(facts: dict[str, Any]) -> None:
    command = command_called(facts["name"])
    for param, known in zip(command.params, facts["params"], strict=True):
        if "unit" in known:
            assert param.quantity.unit == known["unit"], param.name
    if facts["returns"]["unit"]:
        assert command.details.returns.unit == facts["returns"]["unit"]


@documented
def test_manual_section_is_given(facts: dict[str, Any]) -> None:
    command = command_called(facts["name"])
    newer = f"2.14: {facts['section_2_14']}" if "section_2_14" in facts else ""
    assert command.manual == facts.get("section_2_10", newer)


@documented
def test_every_spelling_of_a_keyword_is_accepted(facts: dict[str, Any]) -> None:
    command = command_called(facts["name"])
    arguments = good_arguments(facts)
    bound = command.bind((), arguments)
    for param in facts["params"]:
        for spelling in param.get("spellings", ()):
            others = {name: value for name, value in arguments.items() if name != param["name"]}
            assert command.bind((), {**others, spelling: arguments[param["name"]]}) == bound
    known = {spelling for param in facts["params"] for spelling in param.get("spellings", ())}
    assert known <= {spelling for param in command.params for spelling in param.spellings}


@documented
def test_aliases_take_the_same_arguments_from_their_own_release_on(facts: dict[str, Any]) -> None:
    command = command_called(facts["name"])
    aliases = facts.get("aliases", {})
    assert set(command.aliases) == set(aliases)
    for name, since in aliases.items():
        other = command_called(name)
        assert other.name == name
        assert other.alias_of == command.name
        assert other.since == since
        assert other.signature == command.signature.replace(command.name, name, 1)
        assert other.is_simulated == command.is_simulated


@pytest.mark.parametrize("name", EVERY_NAME)
def test_every_command_says_what_it_does(name: str) -> None:
    command = command_called(name)
    assert command.details.summary.endswith((".", ")."))
    assert command.family in CHAPTERS
    assert all(param.text.endswith(".") for param in command.params)
    returns = command.function.__annotations__["return"]
    assert (returns == "None") == (command.details.returns_text == "")
    assert command.evidence in ("documented", "observed")


def test_reserved_names_are_no_commands() -> None:
    assert [name for name in RESERVED if CATALOGUE.get(name) is not None] == []
    assert {"set_rtcp", "servol", "xor"} <= RESERVED


def test_commands_that_move_or_wait_are_refused_in_secondary_programs() -> None:
    refused = {command.name for command in CATALOGUE if not command.works_in_sec}
    assert {"movej", "movel", "movec", "movep", "stopj", "stopl", "speedj", "speedl", "servoj", "moveml"} <= refused
    assert {"sleep", "sync", "pause", "interpreter_mode", "start_thread", "join_thread"} <= refused
    assert refused.isdisjoint({"halt", "popup", "socket_open", "serial_config", "stop_thread", "textmsg", "set_flag"})


def test_commands_that_can_take_time_are_known() -> None:
    waiting = {command.name for command in CATALOGUE if command.waits}
    assert {"movej", "sleep", "sync", "join_thread", "popup", "socket_open", "serial_read", "pause"} <= waiting
    assert waiting.isdisjoint({"get_flag", "set_tcp", "textmsg", "sin", "start_thread"})


@pytest.mark.parametrize(
    ("name", "param", "spelling"),
    [
        ("tool_serial_read", "time_out", "timeout"),
        ("socket_read_string", "timeout", "time_out"),
        ("socket_read_ascii_float", "timeout", "time_out"),
        ("read_port_bit", "address", "addr"),
        ("set_tcp", "pose", "p"),
        ("get_inverse_kin", "p", "pose"),
        ("modbus_set_output_signal", "signal_name", "singal_name"),
        ("modbus_add_signal", "signal_name", "ignal_name"),
        ("pose_dist", "p_from", "p_fom"),
        ("is_within_safety_limits", "qNear", "qnear"),
    ],
)
def test_spellings_of_one_command_are_taken_by_all(name: str, param: str, spelling: str) -> None:
    command = CATALOGUE.get(name)
    assert command is not None
    (found,) = [each for each in command.params if each.name == param]
    assert spelling in found.spellings
