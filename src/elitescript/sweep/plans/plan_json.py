"""Plans, choices and rows as JSON has them, and back, checked field by field."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from hashlib import sha256
from json import dumps
from typing import Any, Final

from elitescript.errors import UsageError, did_you_mean
from elitescript.sweep.plans.plan import Choices, Disturbance, Failure, Plan, Row, Variation
from elitescript.sweep.plans.trees import tree_of

Check = Callable[[Any, str], Any]
"""Returns a value that was read, or raises `UsageError` with the place that it is given."""


def plan_data(plan: Plan) -> dict[str, Any]:
    """Return a plan as JSON has it."""
    data = {name: getattr(plan, name) for name in _PLAN}
    data["variations"] = [[row.name, row.kind, list(row.arguments)] for row in plan.variations]
    for name in ("settings", "ensure"):
        data[name] = list(data[name])
    return data


def plan_of(data: Any) -> Plan:
    """Return the plan of such data.

    Raises:
        UsageError: not a plan; the text names the field.
    """
    return Plan(**_checked(data, _PLAN, "plan"))


def plan_digest(plan: Plan) -> str:
    """Return 16 hexadecimal digits that are the same for equal plans alone."""
    return data_digest(plan_data(plan))


def data_digest(data: Any) -> str:
    """Return 16 hexadecimal digits of data as JSON has it; the order of keys does not matter."""
    return sha256(dumps(data, sort_keys=True).encode()).hexdigest()[:16]


def choices_data(choices: Choices) -> dict[str, Any]:
    """Return choices as JSON has them."""
    return {
        "run": choices.run,
        "seed": choices.seed,
        "values": dict(choices.values),
        "disturbances": [disturbance_data(row) for row in choices.disturbances],
    }


def choices_of(data: Any) -> Choices:
    """Return the choices of such data.

    Raises:
        UsageError: not choices; the text names the field.
    """
    return Choices(**_checked(data, _CHOICES, "choices"))


def disturbance_data(disturbance: Disturbance) -> dict[str, Any]:
    """Return a disturbance as JSON has it."""
    return {
        "kind": disturbance.kind,
        "on": disturbance.on,
        "at_s": disturbance.at_s,
        "for_s": disturbance.for_s,
        "settings": dict(disturbance.settings),
    }


def row_data(row: Row) -> list[Any]:
    """Return a row as JSON has it."""
    failure = row.failure
    return [
        choices_data(row.choices),
        row.state,
        row.time_s,
        dict(row.measures),
        row.digest,
        None if failure is None else {name: getattr(failure, name) for name in _FAILURE},
        list(row.margins),
        row.is_warned,
    ]


def row_of(data: Any) -> Row:
    """Return the row of such data.

    Raises:
        UsageError: not a row; the text names the field.
    """
    # Journals that were begun by an earlier version do not say whether a run has warnings.
    if not isinstance(data, list) or not len(_ROW) - 1 <= len(data) <= len(_ROW):
        raise UsageError(f"row: a list of {len(_ROW)} is expected")
    values = zip(data, _ROW.items(), strict=False)
    return Row(**{name: check(value, f"row.{name}") for value, (name, check) in values})


# ---------------------------------------------------------------- checks of single values


def _checked(data: Any, checks: Mapping[str, Check], place: str) -> dict[str, Any]:
    if not isinstance(data, dict):
        raise UsageError(f"{place}: an object is expected, not {_shown(data)}")
    for name in data:
        if name not in checks:
            raise UsageError(f"{place}: {name!r} is not known{did_you_mean(name, checks)}")
    for name in checks:
        if name not in data:
            raise UsageError(f"{place}: {name} is missing")
    return {name: check(data[name], f"{place}.{name}") for name, check in checks.items()}


def _shown(value: Any) -> str:
    return f"{type(value).__name__} {str(value)[:40]!r}"


def _text(value: Any, place: str) -> str:
    if type(value) is not str:
        raise UsageError(f"{place}: a text is expected, not {_shown(value)}")
    return value


def _whole(value: Any, place: str) -> int:
    if type(value) is not int:
        raise UsageError(f"{place}: a whole number is expected, not {_shown(value)}")
    return value


def _number(value: Any, place: str) -> float:
    if type(value) is not float and type(value) is not int:
        raise UsageError(f"{place}: a number is expected, not {_shown(value)}")
    return value


def _flag(value: Any, place: str) -> bool:
    if type(value) is not bool:
        raise UsageError(f"{place}: true or false is expected, not {_shown(value)}")
    return value


def _any(value: Any, place: str) -> Any:
    return value


def _place(value: Any, place: str) -> int | str:
    return _whole(value, place) if type(value) is int else _text(value, place)


def _or_none(check: Check) -> Check:
    return lambda value, place: None if value is None else check(value, place)


def _list(check: Check) -> Check:
    def checked(value: Any, place: str) -> tuple[Any, ...]:
        if not isinstance(value, list):
            raise UsageError(f"{place}: a list is expected, not {_shown(value)}")
        return tuple(check(item, f"{place}[{index}]") for index, item in enumerate(value))

    return checked


def _table(check: Check) -> Check:
    def checked(value: Any, place: str) -> dict[str, Any]:
        if not isinstance(value, dict):
            raise UsageError(f"{place}: an object is expected, not {_shown(value)}")
        return {name: check(item, f"{place}.{name}") for name, item in value.items()}

    return checked


def _variation(value: Any, place: str) -> Variation:
    if not isinstance(value, list) or len(value) != 3:
        raise UsageError(f"{place}: name, kind and arguments are expected, not {_shown(value)}")
    return Variation(_text(value[0], place), _text(value[1], place), _list(_any)(value[2], place))


def _disturbance(value: Any, place: str) -> Disturbance:
    return Disturbance(**_checked(value, _DISTURBANCE, place))


def _failure(value: Any, place: str) -> Failure:
    return Failure(**_checked(value, _FAILURE, place))


def _choices(value: Any, place: str) -> Choices:
    return Choices(**_checked(value, _CHOICES, place))


_PLAN: Final[Mapping[str, Check]] = {
    "program": _text,
    "program_name": _text,
    "tree": tree_of,
    "files": _table(_text),
    "world": _text,
    "world_name": _text,
    "python": _table(_text),
    "options": _table(_any),
    "settings": _list(_text),
    "variations": _list(_variation),
    "seed": _whole,
    "until_s": _or_none(_number),
    "ensure": _list(_text),
    "measures": _table(_text),
    "chaos": _text,
    "step_s": _or_none(_number),
    "has_margins": _flag,
    "version": _text,
}
_DISTURBANCE: Final[Mapping[str, Check]] = {
    "kind": _text,
    "on": _place,
    "at_s": _number,
    "for_s": _or_none(_number),
    "settings": _table(_any),
}
_CHOICES: Final[Mapping[str, Check]] = {
    "run": _whole,
    "seed": _whole,
    "values": _table(_any),
    "disturbances": _list(_disturbance),
}
_FAILURE: Final[Mapping[str, Check]] = {
    "expression": _text,
    "state": _text,
    "code": _text,
    "line": _whole,
    "disturbance": _text,
    "text": _text,
    "t": _or_none(_number),
    "margin": _or_none(_number),
}
_ROW: Final[Mapping[str, Check]] = {
    "choices": _choices,
    "state": _text,
    "time_s": _or_none(_number),
    "measures": _table(_any),
    "digest": _text,
    "failure": _or_none(_failure),
    "margins": _list(_or_none(_number)),
    "is_warned": _flag,
}
