"""The facts about the documented commands that tests compare with, and values made from them.

`tests/data/command_examples.json` holds names, signatures, units, ranges, computed examples and error conditions.
Sources: script manuals 2.10 and 2.14, the vendor's editor extension and SDK. A range is the one that the catalogue
keeps: where the manual limits or truncates instead of refusing, none is given.
"""

from __future__ import annotations

import json
from math import inf, nan, nextafter
from pathlib import Path
from typing import Any, Final, NamedTuple

FACTS: Final[dict[str, Any]] = json.loads(
    (Path(__file__).parent.parent / "data" / "command_examples.json").read_text(encoding="utf-8")
)
COMMANDS: Final[list[dict[str, Any]]] = FACTS["commands"]


class BadValue(NamedTuple):
    """A value that a parameter must refuse, and the class of the refusal."""

    value: Any
    error: str


def good_value(param: dict[str, Any]) -> Any:
    """A value that the parameter takes."""
    return _good_of_kind(param["kinds"][0], param)


def edge_values(param: dict[str, Any]) -> list[Any]:
    """The outermost values that the parameter takes, in the form in which it takes them."""
    scalars = list(param.get("choices", ()))
    for bound, outward in (("low", inf), ("high", -inf)):
        if bound in param:
            edge = param[bound]
            scalars.append(nextafter(edge, outward) if param.get(f"{bound}_open") else edge)
    edges = []
    for kind in param["kinds"]:
        if kind in ("int", "float", "str"):
            edges += [scalar for scalar in scalars if kind != "str" or isinstance(scalar, str)]
            if kind == "int":
                edges += [bool(scalar) for scalar in scalars if scalar in (0, 1)]
        elif kind.startswith("list[") and scalars and len(param["kinds"]) < 3:
            edges += [[scalar] * (_count(kind) or 1) for scalar in scalars if not isinstance(scalar, str)]
    edges += param.get("left_out", [])
    if param["kinds"] == ["bool"]:
        edges += [True, False, 0, 1]
    return edges


def bad_values(param: dict[str, Any]) -> list[BadValue]:
    """Values of wrong type, wrong length, outside the range, and those that are no finite number."""
    kinds = param["kinds"]
    if kinds == ["any"]:
        return []
    if kinds == ["printable"]:
        return [BadValue(object(), "ArgumentTypeError")]
    wrong_types: list[Any] = [object(), 1j, {}]
    left_out = param.get("left_out", [])
    wrong_types += [] if None in left_out else [None]
    if not any(kind.startswith("list") or kind in ("tuple", "printable") for kind in kinds):
        wrong_types += [[], (1,)]
    if "str" not in kinds and "printable" not in kinds:
        wrong_types += ["five", b"5"] if "bytes" not in kinds else ["five"]
    if kinds in (["int"], ["bool"]):
        wrong_types += [1.0, nan]
    if kinds == ["str"]:
        wrong_types += [1, True, b"a"]
    if all(kind.startswith("list") for kind in kinds):
        wrong_types += [1, 0.5]
    if kinds == ["tuple"]:
        wrong_types += [1, "text", None]
    bad = [BadValue(value, "ArgumentTypeError") for value in wrong_types]
    if "float" in kinds:
        bad += [BadValue(value, "ArgumentRangeError") for value in (nan, inf, -inf, 10**400)]
    for kind in kinds:
        bad += _bad_lists(kind)
        if kind in ("int", "float"):
            bad += _outside(param, kind)
        if kind.startswith("list[") and len(kinds) < 3:
            length = _count(kind) or 1
            element = kind[5 : kind.index("]")]
            bad += [
                BadValue([_good_of_kind(element, param)] * (length - 1) + [b.value], b.error)
                for b in _outside(param, element)
            ]
    if "choices" in param and kinds == ["str"]:
        bad += [BadValue(param["choices"][0].upper(), "ArgumentRangeError"), BadValue("", "ArgumentRangeError")]
    return bad


def good_arguments(command: dict[str, Any], **given: Any) -> dict[str, Any]:
    """Arguments that the command takes, some of them replaced."""
    arguments = {param["name"]: good_value(param) for param in command["params"]}
    if command["name"] == "encoder_enable_pulse_decode":
        arguments["B"] = 17
    arguments.update(given)
    return arguments


def _good_of_kind(kind: str, param: dict[str, Any]) -> Any:
    if "choices" in param and kind in ("int", "float", "str"):
        return param["choices"][0]
    if kind in ("int", "float"):
        if "low" in param and "high" in param:
            middle = (param["low"] + param["high"]) / 2
            return int(middle) if kind == "int" else middle
        return param.get("low", 0) + 1
    if kind.startswith("list["):
        element = kind[5 : kind.index("]")]
        return [_good_of_kind(element, param)] * (_count(kind) or 2)
    if kind == "str" and param["name"] == "port":
        return "/dev/ttymxc0"
    if kind == "str" and param["name"] == "str":
        return "12"
    return {
        "bool": True,
        "str": "text",
        "any": "text",
        "printable": 1.5,
        "list": [1, 2],
        "bytes": b"ab",
        "callable": print,
        "tuple": (1,),
    }[kind]


def _count(kind: str) -> int:
    return int(kind[kind.index("(") + 1 : -1]) if "(" in kind else 0


def _bad_lists(kind: str) -> list[BadValue]:
    if not kind.startswith("list["):
        return []
    count = _count(kind)
    element = kind[5 : kind.index("]")]
    filler: Any = {"float": 1.0, "int": 1, "bool": True}[element]
    length = count or 3
    bad = [BadValue([filler] * (length - 1) + [wrong], "ArgumentTypeError") for wrong in ("x", None, [1.0], 1j)]
    if count:
        bad += [BadValue([filler] * wrong, "ArgumentTypeError") for wrong in (0, count - 1, count + 1)]
    if element == "float":
        bad += [BadValue([filler] * (length - 1) + [wrong], "ArgumentRangeError") for wrong in (nan, inf, -inf)]
    else:
        bad.append(BadValue([1.5] * length, "ArgumentTypeError"))
    return bad


def _outside(param: dict[str, Any], kind: str) -> list[BadValue]:
    values: list[Any] = []
    for bound, outward in (("low", -inf), ("high", inf)):
        if bound not in param:
            continue
        edge = param[bound]
        if kind == "int":
            values.append(edge - 1 if outward < 0 else edge + 1)
        else:
            values.append(edge if param.get(f"{bound}_open") else nextafter(edge, outward))
    choices = param.get("choices", ())
    if choices and kind == "int":
        values += [min(choices) - 1, max(choices) + 1]
    return [BadValue(value, "ArgumentRangeError") for value in values]
