"""Which fault there is where, against tables written by hand: every kind and every form at every place."""

from __future__ import annotations

from typing import Any

import pytest

from elitescript.devices.channels.faults import DELAY_MAX_S, DIRECTIONS, FORMS, TABLE, Fault
from elitescript.errors import UsageError
from tests.tables import rows

# Kind; on a TCP port; on a serial line; whether it is about single messages; settings of its own.
KINDS = """
refuse        yes   no    channel    .
silence       yes   yes   messages   .
drop          yes   yes   messages   .
delay         yes   yes   messages   delay_s
duplicate     yes   yes   messages   .
corrupt       yes   yes   messages   .
trickle       yes   yes   messages   chunk
wrong_reply   yes   yes   messages   form reply code
disconnect    yes   yes   channel    .
reconnect     yes   yes   channel    .
"""

# Kind of a fault of inputs; on a digital input; on an analog one; settings of its own.
INPUT_KINDS = """
stuck         yes   yes   value
inverted      yes   no    .
bouncing      yes   no    settle_s bounces seed
open_wire     yes   yes   value
drifting      no    yes   per_s bound every_s
noisy         yes   yes   sigma rate_hz every_s seed
late          yes   yes   delay_s
"""

# Form of a wrong reply; on a TCP port; on a serial line; what it needs; the protocol of the device.
FORM_TABLE = """
text          yes   yes   reply        .
exception     yes   yes   code         MODBUS
transaction   yes   no    .            MODBUS
unit          yes   yes   .            MODBUS
checksum      no    yes   .            MODBUS
fault         yes   no    code reply   XML-RPC
http          yes   no    code         XML-RPC
"""

PLACES: dict[str, Any] = {"tcp": 5000, "line": "tool"}
SETTINGS: dict[str, Any] = {"delay_s": 0.5, "chunk": 2, "form": "text", "reply": "no", "code": 4}
NEEDED: dict[str, dict[str, Any]] = {"delay": {"delay_s": 0.5}, "wrong_reply": {"form": "text", "reply": "no"}}
"""Settings without which a kind means nothing."""
INPUT_NEEDS: dict[str, dict[str, Any]] = {
    "bouncing": {"settle_s": 0.02, "bounces": 2},
    "drifting": {"per_s": 0.5, "bound": 1.0},
    "noisy": {"sigma": 0.1, "rate_hz": 2.0},
    "late": {"delay_s": 0.1},
}
CODES = {"exception": 255, "http": 599, "fault": 2**31 - 1}
"""The largest code of each form."""


def is_taken(**settings: Any) -> bool:
    try:
        Fault(**settings)
    except UsageError:
        return False
    return True


def test_every_kind_and_form_is_in_the_tables() -> None:
    assert list(TABLE) == [row[0] for row in (*rows(KINDS), *rows(INPUT_KINDS))]
    assert list(FORMS) == [row[0] for row in rows(FORM_TABLE)]
    assert DIRECTIONS == ("both", "to_robot", "to_device")


@pytest.mark.parametrize(("kind", "tcp", "line", "about", "own"), rows(KINDS))
def test_kinds(kind: str, tcp: str, line: str, about: str, own: str) -> None:
    needed = NEEDED.get(kind, {})
    assert is_taken(kind=kind, on=5000, **needed) == (tcp == "yes")
    assert is_taken(kind=kind, on="192.168.1.20:5000", **needed) == (tcp == "yes")
    assert is_taken(kind=kind, on="tool", **needed) == (line == "yes")
    for setting in ({"direction": "to_robot"}, {"nth": 2}, {"count": 1}, {"share": 0.5}):
        assert is_taken(kind=kind, on=5000, **needed, **setting) == (about == "messages"), setting
    assert sorted(TABLE[kind].takes) == sorted(own.split())
    for name in set(SETTINGS) - set(own.split()):
        assert not is_taken(kind=kind, on=5000, **needed, **{name: SETTINGS[name]}), name


@pytest.mark.parametrize(("kind", "digital", "analog", "own"), rows(INPUT_KINDS))
def test_kinds_of_inputs(kind: str, digital: str, analog: str, own: str) -> None:
    needed = INPUT_NEEDS.get(kind, {})
    on_digital = {name: value for name, value in needed.items() if name != "sigma"}
    on_analog = {name: value for name, value in needed.items() if name != "rate_hz"}
    assert is_taken(kind=kind, on="standard_digital_in[3]", **on_digital) == (digital == "yes")
    assert is_taken(kind=kind, on="standard_analog_in[1]", **on_analog) == (analog == "yes")
    assert is_taken(kind=kind, on="tool_analog_in", **on_analog) == (analog == "yes")
    for place in (5000, "tool", "standard_digital_out[3]", "input_bool_register[0]", "emergency_stop"):
        assert not is_taken(kind=kind, on=place, **on_digital), place
    assert sorted(TABLE[kind].takes) == sorted(own.split())


@pytest.mark.parametrize("kind", [row[0] for row in rows(KINDS)])
def test_faults_of_connections_are_none_of_inputs(kind: str) -> None:
    assert not is_taken(kind=kind, on="standard_digital_in[3]", **NEEDED.get(kind, {}))
    assert not is_taken(kind=kind, on="standard_analog_in[1]", **NEEDED.get(kind, {}))


@pytest.mark.parametrize(("form", "tcp", "line", "needs", "protocol"), rows(FORM_TABLE))
def test_forms(form: str, tcp: str, line: str, needs: str, protocol: str) -> None:
    settings = {"reply": "no", "code": CODES.get(form)}
    given = {name: settings[name] for name in needs.split()}
    for place, answer in (("tcp", tcp), ("line", line)):
        assert is_taken(kind="wrong_reply", on=PLACES[place], form=form, **given) == (answer == "yes"), place
    assert FORMS[form].protocol == protocol
    place = PLACES["tcp" if tcp == "yes" else "line"]
    assert not is_taken(kind="wrong_reply", on=place, form=form, direction="to_device", **given)
    for name, value in {"reply": "no", "code": 200}.items():
        changed = dict(given)
        if changed.pop(name, None) is None:
            changed[name] = value
        assert not is_taken(kind="wrong_reply", on=place, form=form, **changed), name
    if "code" in given:
        assert not is_taken(kind="wrong_reply", on=place, form=form, **{**given, "code": CODES[form] + 1})


def test_the_reason_says_what_to_take_instead() -> None:
    with pytest.raises(UsageError, match=r"cannot refuse: .*Take silence"):
        Fault("refuse", on="tool")
    with pytest.raises(UsageError, match="frames of MODBUS TCP have no checksum"):
        Fault("wrong_reply", on=502, form="checksum")


def test_the_longest_delay_is_an_hour() -> None:
    assert DELAY_MAX_S == 3600.0
    assert is_taken(kind="delay", on=5000, delay_s=3600.0)
    assert not is_taken(kind="delay", on=5000, delay_s=3600.1)
