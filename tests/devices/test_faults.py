"""Faults: which make sense where, and how they are asked for."""

from __future__ import annotations

import re

import pytest

from elitescript.devices.channels.faults import FORMS, LINE, TABLE, TCP, fault_of, fault_text, place_of
from elitescript.errors import UsageError
from elitescript.testing.world import Fault, ModbusDevice, SerialDevice, TcpServer, World, XmlRpcServer

NEEDS = {"delay": {"delay_s": 0.1}, "wrong_reply": {"reply": "x"}}
FORM_NEEDS = {"reply": "x", "code": 200}


@pytest.mark.parametrize("kind", TABLE)
@pytest.mark.parametrize("on", [5000, "tool"])
def test_the_table_says_what_is_possible(kind, on):
    row = TABLE[kind]
    effect = row.tcp if on == 5000 else row.line
    if effect.is_possible:
        assert Fault(kind, on, **NEEDS.get(kind, {})).kind == kind
    else:
        with pytest.raises(UsageError) as caught:
            Fault(kind, on)
        assert str(caught.value) == f"kind: {kind} on {on!r}: {effect.text}"


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("on", [5000, "tool"])
def test_the_table_of_wrong_replies_says_what_is_possible(form, on):
    row = FORMS[form]
    effect = row.tcp if on == 5000 else row.line
    settings = {name: FORM_NEEDS[name] for name in row.takes}
    if effect.is_possible:
        assert Fault("wrong_reply", on, form=form, **settings).form == form
    else:
        with pytest.raises(UsageError) as caught:
            Fault("wrong_reply", on, form=form, **settings)
        assert str(caught.value) == f"form: {form} on {on!r}: {effect.text}"


@pytest.mark.parametrize(
    "settings, words",
    [
        ({"kind": "explode"}, "kind: there is no fault 'explode'; there are refuse, silence"),
        ({"kind": ["drop"]}, "kind: there is no fault"),
        ({"on": "standard_digital_out[1]"}, "on: standard_digital_out.1. is an output; inputs that can be disturbed"),
        ({"on": 70_000}, r"on: a port must be in \[1, 65535\], got 70000"),
        ({"on": ""}, "on: write a port"),
        ({"on": True}, "on: write a port"),
        ({"at_s": -1}, "at_s: must be a number in"),
        ({"at_s": "soon"}, "at_s: must be a number in"),
        ({"for_s": 0}, "for_s: must be one control period at least"),
        ({"nth": 0}, "nth: must be a whole number in"),
        ({"nth": 1.5}, "nth: must be a whole number in"),
        ({"count": 0}, "count: must be a whole number in"),
        ({"share": 1.5}, "share: must be a number in"),
        ({"direction": "up"}, "direction: must be one of both, to_robot, to_device"),
        ({"delay_s": 1}, "delay_s: drop has no such setting; delay, late has"),
        ({"chunk": 2}, "chunk: drop has no such setting; trickle has"),
        ({"kind": "delay"}, "delay_s: must be one control period at least"),
        ({"kind": "refuse", "nth": 2}, "nth: refuse is about the whole channel"),
        ({"kind": "disconnect", "direction": "to_robot"}, "direction: disconnect is about the whole channel"),
        ({"kind": "reconnect", "for_s": 1}, "for_s: reconnect happens at a moment"),
        ({"kind": "wrong_reply"}, "reply: a wrong reply of the form text needs it"),
        ({"kind": "wrong_reply", "form": "exception"}, "code: a wrong reply of the form exception needs it"),
        ({"kind": "wrong_reply", "form": "exception", "code": 0}, r"code: must be a whole number in \[1, 255\]"),
        ({"kind": "wrong_reply", "form": "http", "code": 20}, r"code: must be a whole number in \[100, 599\]"),
        (
            {"kind": "wrong_reply", "form": "unit", "code": 1},
            "code: a wrong reply of the form unit has no such setting",
        ),
        ({"kind": "wrong_reply", "reply": "x", "direction": "to_device"}, "direction: a wrong reply goes to_robot"),
        ({"kind": "wrong_reply", "reply": 5}, "reply: must be a text or bytes"),
        ({"kind": "wrong_reply", "form": "rude"}, "form: there is no 'rude'"),
    ],
)
def test_a_fault_that_makes_no_sense_is_refused(settings, words):
    with pytest.raises(UsageError, match=words):
        Fault(**{"kind": "drop", "on": 5000, **settings})


def test_places_are_ports_addresses_and_lines():
    assert place_of(5000) == (TCP, "", 5000) == place_of("5000")
    assert place_of("10.0.0.1:502") == (TCP, "10.0.0.1", 502)
    assert place_of("box") == (LINE, "/dev/ttymxc0", 0)


def test_a_reconnect_needs_a_disconnect_before_it():
    with pytest.raises(UsageError, match="1: kind: reconnect on 5000 has no disconnect before it"):
        World(faults=[Fault("reconnect", 5000, at_s=2.0), Fault("disconnect", 5000, at_s=3.0)])
    World([TcpServer(port=5000)], faults=[Fault("reconnect", 5000, at_s=3.0), Fault("disconnect", 5000, at_s=2.0)])


def test_a_fault_goes_through_a_line_of_text():
    fault = Fault("wrong_reply", 502, form="exception", code=6, nth=3, count=1, at_s=0.5)
    assert fault_of(fault_text(fault)) == fault
    with pytest.raises(UsageError, match="reply: must be a text"):
        fault_text(Fault("wrong_reply", 5000, reply=b"x"))
    for text, words in [("{", "is no fault"), ("[]", "must be an object"), ('{"kind": "drop"}', "on: is missing")]:
        with pytest.raises(UsageError, match=words):
            fault_of(text)


EXCEPTION = {"kind": "wrong_reply", "form": "exception", "code": 2}
SERVICE = {"kind": "wrong_reply", "form": "http", "code": 503}


@pytest.mark.parametrize(
    ("device", "on", "settings", "words"),
    [
        (
            TcpServer(port=5000, name="camera"),
            5000,
            EXCEPTION,
            "form: exception on 5000: camera there speaks no MODBUS",
        ),
        (TcpServer(port=5000, address="h"), 5000, SERVICE, "form: http on 5000: TcpServer there speaks no XML-RPC"),
        (TcpServer(port=5000), "h:5000", SERVICE, "form: http on 'h:5000': TcpServer there speaks no XML-RPC"),
        (
            SerialDevice(line="tool"),
            "tool",
            EXCEPTION,
            "form: exception on 'tool': SerialDevice there speaks no MODBUS",
        ),
        (ModbusDevice(port=502), 502, SERVICE, "speaks no XML-RPC"),
        (XmlRpcServer(port=8000), 8000, EXCEPTION, "speaks no MODBUS"),
    ],
)
def test_a_wrong_reply_of_another_protocol_is_refused(device, on, settings, words):
    fault = Fault(on=on, **settings)
    with pytest.raises(UsageError, match=re.escape(words)):
        World(devices=[device], faults=[fault])


def test_a_wrong_reply_of_another_protocol_is_refused_later_too():
    world = World(devices=[TcpServer(port=5000)])
    with pytest.raises(UsageError, match="speaks no MODBUS"):
        world.fault(on=5000, **EXCEPTION)
    assert world.faults == ()


@pytest.mark.parametrize("on", [502, "tool", "h:502", "other:5000"])
def test_where_such_a_device_is_or_nobody_knows_who_is_there_it_is_not(on):
    devices = [ModbusDevice(port=502), ModbusDevice(line="tool", unit=1), TcpServer(port=5000, address="h")]
    fault = Fault(on=on, **EXCEPTION)
    assert World(devices=devices, faults=[fault], network="real").faults == (fault,)
