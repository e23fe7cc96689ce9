"""Numbers of an untrusted robot: every port can say all that the codec lets pass, or the robot is refused."""

from collections.abc import Iterator
from copy import deepcopy
from dataclasses import fields
from math import inf, nan
from struct import pack
from typing import Any, get_args, get_type_hints

import pytest

from elitescript.codec.json_text import from_text, to_text
from elitescript.codec.messages import shape_of
from elitescript.codec.values import CodecError
from elitescript.kernel import Kernel, RobotOptions
from elitescript.messages.events import Alarm, Event, Popup, TextMessage, Warned
from elitescript.messages.outputs import Output
from elitescript.protocol.ports import SERVICES
from elitescript.protocol.rtsi.variables import OUTPUTS
from elitescript.services.output_text import output_text

SHAPE = shape_of(Output)
KERNEL = Kernel(RobotOptions(power_on=True))
WHOLE = from_text(output_text(KERNEL.tick_and_snapshot()))
INTEGERS = (-(2**63), -1, 25, 256, 2**16, 2**31, 2**63 - 1)
ORDINARY: dict[Any, Any] = {int: 1, str: "a", bool: False}


def places(data: Any, kind: type, at: tuple[int, ...] = ()) -> Iterator[tuple[int, ...]]:
    """Where numbers of a kind stand."""
    if type(data) is list:
        for index, item in enumerate(data):
            yield from places(item, kind, (*at, index))
    elif type(data) is kind:
        yield at


def with_number(where: tuple[int, ...], value: float) -> Any:
    changed = deepcopy(WHOLE)
    inner = changed
    for index in where[:-1]:
        inner = inner[index]
    inner[where[-1]] = value
    return changed


def say_everywhere(data: Any) -> bool:
    """Publish an output at every port and in every variable; whether it is let pass at all."""
    try:
        output = SHAPE.decode(from_text(to_text(data)))
    except CodecError:
        return False
    for service in SERVICES:
        connection = service.open(KERNEL.description)(f"{service.name}#1")
        connection.publish(output)
        connection.due()
    for variable in OUTPUTS.values():
        value = variable.read(output.snapshot)
        pack(">" + variable.type.layout, *(value if variable.type.is_vector else (value,)))
    return True


@pytest.mark.parametrize("value", [nan, inf, -inf, 1e308, -5e-324])
def test_any_float(value: float) -> None:
    changed = deepcopy(WHOLE)
    for where in places(WHOLE, float):
        inner = changed
        for index in where[:-1]:
            inner = inner[index]
        inner[where[-1]] = value
    say_everywhere(changed)


def test_any_whole_number_of_a_picture() -> None:
    # Of a family or vector the first element stands for all.
    found = {where[:-1] if len(where) > 2 else where: where for where in reversed(list(places(WHOLE, int)))}
    passed = [say_everywhere(with_number(where, value)) for where in found.values() for value in INTEGERS]
    assert any(passed)
    assert not all(passed)


@pytest.mark.parametrize("kind", [Alarm, Popup, TextMessage, Warned])
def test_any_whole_number_of_an_event(kind: type) -> None:
    assert kind in get_args(Event)
    hints = get_type_hints(kind)
    ordinary = [ORDINARY.get(hints[field.name], {}) for field in fields(kind)]
    for index in [place for place, item in enumerate(ordinary) if type(item) is int]:
        for value in INTEGERS:
            event = [kind.__name__, *ordinary]
            event[1 + index] = value
            say_everywhere([WHOLE[0], [event], *WHOLE[2:]])
    assert say_everywhere([WHOLE[0], [[kind.__name__, *ordinary]], *WHOLE[2:]])
