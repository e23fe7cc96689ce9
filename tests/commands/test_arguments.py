"""Every parameter of every documented command refuses what it must and takes what it may."""

from __future__ import annotations

from typing import Any

import pytest

from elitescript import errors
from elitescript.commands.catalogue import CATALOGUE
from tests.commands.facts import COMMANDS, bad_values, edge_values, good_arguments

PARAMS = [(facts, param) for facts in COMMANDS for param in facts["params"]]
every_param = pytest.mark.parametrize(
    ("facts", "param"), PARAMS, ids=[f"{facts['name']}-{param['name']}" for facts, param in PARAMS]
)
every_command = pytest.mark.parametrize("facts", COMMANDS, ids=[facts["name"] for facts in COMMANDS])


@every_param
def test_bad_values_are_refused_with_what_where_and_limit(
    facts: dict[str, Any], param: dict[str, Any], robot: Any
) -> None:
    command = CATALOGUE.get(facts["name"])
    assert command is not None
    for bad in bad_values(param):
        arguments = good_arguments(facts, **{param["name"]: bad.value})
        with pytest.raises(errors.ScriptError) as caught:
            command.call(robot, (), arguments)
        error = caught.value
        assert type(error).__name__ == bad.error, (bad.value, str(error))
        assert str(error).startswith(f"{facts['name']}: {param['name']} "), bad.value
        assert (error.command, error.argument) == (facts["name"], param["name"])
        assert error.limit
    assert robot.asked == []


@every_param
def test_edge_values_are_taken(facts: dict[str, Any], param: dict[str, Any]) -> None:
    command = CATALOGUE.get(facts["name"])
    assert command is not None
    position = [known["name"] for known in facts["params"]].index(param["name"])
    for value in edge_values(param):
        bound = command.bind((), good_arguments(facts, **{param["name"]: value}))[position]
        if value in (None, "") and "left_out" in param:
            assert bound is None
        elif isinstance(value, list):
            assert bound == tuple(value)
        elif value not in param.get("left_out", ()):
            assert bound == value


@every_command
def test_good_arguments_are_taken_by_position_and_by_name(facts: dict[str, Any]) -> None:
    command = CATALOGUE.get(facts["name"])
    assert command is not None
    arguments = good_arguments(facts)
    bound = command.bind(tuple(arguments.values()), {})
    assert command.bind((), arguments) == bound
    assert command.bind((), dict(reversed(arguments.items()))) == bound


@every_command
def test_wrong_number_or_names_of_arguments_are_refused(facts: dict[str, Any], robot: Any) -> None:
    command = CATALOGUE.get(facts["name"])
    assert command is not None
    arguments = good_arguments(facts)
    required = [param["name"] for param in facts["params"] if "default_text" not in param]
    cases: list[tuple[tuple[Any, ...], dict[str, Any], str]] = [
        ((), {**arguments, "nonsense": 1}, "has no argument `nonsense`")
    ]
    if required:
        cases.append(((), {k: v for k, v in arguments.items() if k != required[-1]}, f"misses .*`{required[-1]}`"))
    if arguments:
        first = next(iter(arguments))
        cases.append(((arguments[first],), arguments, f"gets the argument `{first}` twice"))
    if not command.takes_more:
        cases.append(((*arguments.values(), 1), {}, "takes .*, got "))
    for args, kwargs, message in cases:
        with pytest.raises(errors.ArgumentCountError, match=f"^{facts['name']} {message}") as caught:
            command.call(robot, args, kwargs)
        assert caught.value.command == facts["name"]
    assert robot.asked == []


@every_command
def test_only_what_is_not_simulated_says_so_after_its_arguments_were_checked(facts: dict[str, Any], robot: Any) -> None:
    command = CATALOGUE.get(facts["name"])
    assert command is not None
    refusal: errors.ScriptError | None = None
    try:
        command.call(robot, (), good_arguments(facts))
    except errors.ScriptError as error:
        refusal = error
    is_refused = isinstance(refusal, errors.NotSimulatedError)
    assert is_refused == (not command.is_simulated)
    if is_refused:
        assert refusal is not None
        assert refusal.command == facts["name"]
        assert str(refusal).startswith(f"{facts['name']}: ")
        assert "not simulated yet" in str(refusal)
        assert robot.asked == []
