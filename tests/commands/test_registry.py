from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any

import pytest

from elitescript.commands.definition.quantities import Integer, Number, Optionally, Real, Str
from elitescript.commands.definition.registry import REQUIRED, Catalogue, Command
from elitescript.errors import (
    ArgumentCountError,
    ArgumentRangeError,
    InternalError,
    InvalidValueError,
    ScriptStateError,
)

Time = Annotated[float, Number("s", 0.0)]


def shift(
    robot: Any, q: Real, t: Time = 0, label: Str = "x", near: Annotated[Any, Optionally(Integer())] = None
) -> Any:
    """Shift.

    Args:
        q: how far.
        t: how long.
        label: name.
        near: where.
    """
    if q == 13.0:
        raise InvalidValueError("13 brings bad luck")
    return robot, q, t, label, near


def nested(a: Real) -> tuple[Any, ...]:
    """Nest.

    Args:
        a: anything.
    """
    return (a, (a, (a,)), [(a,)])


def everything(first: Real, *more: object) -> int:
    """Count.

    Args:
        first: the first.
    """
    return 1 + len(more)


def undocumented(a: Real) -> None:
    """Lack a line."""


def unannotated(a: float) -> None:
    """Lack a quantity.

    Args:
        a: anything.
    """


class Program:
    is_secondary = False


def entry(function: Callable[..., Any], **fields: Any) -> Command:
    known: dict[str, Any] = {
        "family": "motion",
        "since": "2.10",
        "aliases": (),
        "spellings": {},
        "evidence": "documented",
        "waits": False,
        "works_in_sec": True,
        "is_simulated": True,
    }
    return Command(function, **{**known, **fields})


def test_signature_and_parameters_come_from_the_function() -> None:
    command = entry(shift, spellings={"time": "t"})
    assert command.takes_robot
    assert command.signature == "shift(q, t=0, label='x', near='')"
    assert [(param.name, param.is_required, param.text) for param in command.params] == [
        ("q", True, "how far."),
        ("t", False, "how long."),
        ("label", False, "name."),
        ("near", False, "where."),
    ]
    assert command.params[0].default is REQUIRED
    assert command.params[1].spellings == ("time",)
    assert command.details.summary == "Shift."


def test_nothing_is_worked_out_before_somebody_asks() -> None:
    assert entry(shift)._details is None
    assert entry(undocumented)._details is None


def test_arguments_are_put_in_order_and_defaults_are_coerced() -> None:
    command = entry(shift, spellings={"time": "t"})
    assert command.bind((1,), {}) == [1.0, 0.0, "x", None]
    assert type(command.bind((1,), {})[1]) is float
    assert command.bind((), {"time": 2, "q": 1}) == [1.0, 2.0, "x", None]
    assert command.bind((1, 2, "y", 3), {}) == [1.0, 2.0, "y", 3]
    assert command.bind((1,), {"near": 3, "label": "z"}) == [1.0, 0.0, "z", 3]


@pytest.mark.parametrize(
    ("args", "kwargs", "message"),
    [
        ((), {}, "shift misses the argument `q`"),
        ((1, 2, "a", 3, 4), {}, "shift takes at most 4 arguments, got 5"),
        ((1,), {"q": 2}, "shift gets the argument `q` twice"),
        ((1,), {"t": 2, "time": 2}, "shift gets the argument `t` twice"),
        ((1, 2), {"time": 2}, "shift gets the argument `t` twice"),
        ((1,), {"speed": 2}, "shift has no argument `speed`; its arguments: q, t, label, near"),
    ],
)
def test_wrong_calls_say_how_it_is_called(args: Any, kwargs: Any, message: str) -> None:
    with pytest.raises(ArgumentCountError) as caught:
        entry(shift, spellings={"time": "t"}).bind(args, kwargs)
    assert str(caught.value) == message
    assert caught.value.command == "shift"


def test_a_bad_argument_is_named() -> None:
    with pytest.raises(ArgumentRangeError) as caught:
        entry(shift).bind((1, -2), {})
    error = caught.value
    assert str(error) == "shift: t must be >= 0 s, got -2"
    assert (error.command, error.argument, error.value, error.limit, error.unit) == ("shift", "t", -2, ">= 0", "s")


def test_the_robot_is_handed_over_and_refusals_get_the_name_of_the_command() -> None:
    robot = Program()
    command = entry(shift)
    assert command.call(robot, (1,), {})[0] is robot
    with pytest.raises(InvalidValueError, match=r"^shift: 13 brings bad luck$") as caught:
        command.call(robot, (13,), {})
    assert caught.value.command == "shift"


def test_tuples_become_lists_at_every_depth() -> None:
    assert entry(nested).call(None, (1,), {}) == [1.0, [1.0, [1.0]], [(1.0,)]]


def test_calls_of_one_form_are_matched_with_the_parameters_once(monkeypatch: pytest.MonkeyPatch) -> None:
    command = entry(shift)
    calls = []
    place = Command.place
    monkeypatch.setattr(Command, "place", lambda self, *args: calls.append(args) or place(self, *args))
    for number in range(5):
        assert command.bind((number,), {"label": "z", "t": 1}) == [number, 1.0, "z", None]
        assert command.bind((number,), {"t": 1, "label": "z"}) == [number, 1.0, "z", None]
        with pytest.raises(ArgumentCountError):
            command.bind((number,), {"speed": 1})
    assert len(calls) == 2 + 5
    assert len(command.details.forms) == 2


def test_keywords_in_the_order_of_the_parameters_are_bound_by_position(monkeypatch: pytest.MonkeyPatch) -> None:
    def steps(robot: object, q: Annotated[float, Number()], t: Annotated[float, Number("s", 0.0)] = 0.5,
              gain: Annotated[float, Number()] = 3) -> None:  # fmt: skip
        """Do.

        Args:
            q: place.
            t: time.
            gain: gain.
        """

    command, arranged = entry(steps), []
    arrange = Command._arrange
    monkeypatch.setattr(Command, "_arrange", lambda self, *call: arranged.append(call) or arrange(self, *call))
    for _ in range(3):
        assert command.bind((1,), {"t": 2, "gain": 4}) == [1.0, 2.0, 4.0]
        assert command.bind((1,), {"t": 2}) == [1.0, 2.0, 3]
        assert command.bind((), {"q": 1, "t": 2}) == [1.0, 2.0, 3]
        with pytest.raises(ArgumentRangeError, match=r"^steps: t must be >= 0 s"):
            command.bind((1,), {"t": -2, "gain": 4})
    assert len(arranged) == 3
    for _ in range(3):
        assert command.bind((1,), {"gain": 4, "t": 2}) == [1.0, 2.0, 4.0]
        assert command.bind((1,), {"gain": 4}) == [1.0, 0.5, 4.0]
    assert len(arranged) == 9


def test_more_arguments_than_the_signature_has_are_passed_on_when_the_function_takes_them() -> None:
    command = entry(everything)
    assert command.takes_more
    assert command.signature == "everything(first)"
    assert command.call(None, (1, "a", None), {}) == 3
    assert not entry(shift).takes_more


def test_secondary_programs_may_not_call_what_moves_or_waits() -> None:
    robot = Program()
    command = entry(shift, works_in_sec=False)
    command.call(robot, (1,), {})
    robot.is_secondary = True
    with pytest.raises(ScriptStateError, match=r"^shift moves or waits, which a secondary program") as caught:
        command.call(robot, (1,), {})
    assert caught.value.code == "R120"
    entry(shift).call(robot, (1,), {})


@pytest.mark.parametrize("function", [undocumented, unannotated])
def test_a_half_filled_entry_is_our_bug(function: Any) -> None:
    with pytest.raises(InternalError, match=r"parameter 'a' lacks a quantity or its line under Args"):
        _ = entry(function).params


def test_unknown_evidence_is_our_bug() -> None:
    with pytest.raises(InternalError, match=r"^shift: evidence 'hearsay'"):
        entry(shift, evidence="hearsay")


def test_aliases_are_commands_with_a_name_and_a_release_of_their_own() -> None:
    catalogue = Catalogue()
    catalogue.add(entry(shift, aliases=("old_shift",)))
    catalogue.add_alias("new_shift", of="shift", since="2.14", evidence="observed")
    assert [command.name for command in catalogue] == ["shift"]
    assert len(catalogue) == 1
    assert set(catalogue.names()) == {"shift", "old_shift", "new_shift"}
    old, new, shifted = catalogue.get("old_shift"), catalogue.get("new_shift"), catalogue.get("shift")
    assert old is not None and new is not None and shifted is not None
    assert shifted.aliases == ("old_shift", "new_shift")
    assert (old.since, old.evidence, old.alias_of) == ("2.10", "documented", "shift")
    assert (new.since, new.evidence, new.alias_of) == ("2.14", "observed", "shift")
    assert new.signature.startswith("new_shift(q, ")
    with pytest.raises(ArgumentCountError, match=r"^new_shift misses the argument `q`"):
        new.call(Program(), (), {})


def test_two_commands_of_one_name_are_our_bug() -> None:
    catalogue = Catalogue()
    catalogue.add(entry(shift))
    with pytest.raises(InternalError, match=r"two commands are called 'shift'"):
        catalogue.add(entry(shift))
    with pytest.raises(InternalError, match=r"two commands are called 'shift'"):
        catalogue.add(entry(nested, aliases=("shift",)))
