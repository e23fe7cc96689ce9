"""Faults as they are written, turned into what the robot gets."""

from __future__ import annotations

from elitescript.devices.channels.faults import ANALOG, INPUTS, Fault, is_of_input, place_of
from elitescript.devices.channels.wrong_replies import form_and_bytes
from elitescript.messages.faults import ChannelFault
from elitescript.messages.machine import DisturbInput
from elitescript.messages.timing import ticks_for


def machine_fault(fault: Fault) -> ChannelFault | DisturbInput:
    """Return what the robot gets for a fault whose place is a port, a line or an input."""
    return input_request(fault) if is_of_input(fault) else channel_fault(fault)


def channel_fault(fault: Fault) -> ChannelFault:
    """Return what channels get for a fault whose place is a port or a line."""
    form, reply = form_and_bytes(fault) if fault.kind == "wrong_reply" else ("", b"")
    return ChannelFault(
        fault.kind,
        fault.on,
        place_of(fault.on),
        ticks_for(fault.at_s),
        None if fault.for_s is None else ticks_for(fault.for_s),
        fault.nth,
        fault.count,
        fault.direction,
        float(fault.share),
        ticks_for(fault.delay_s),
        fault.chunk,
        form,
        reply,
    )


def input_request(fault: Fault, tick: int | None = None) -> DisturbInput:
    """Return the request for a fault of an input.

    Args:
        fault: its place is an input.
        tick: the present one, if the fault is for now or later; None if its time may be over already.
    """
    _, name, index = place_of(fault.on)
    begin = ticks_for(fault.at_s)
    span_s = {"bouncing": fault.settle_s, "late": fault.delay_s}.get(fault.kind, fault.every_s)
    value = fault.value
    return DisturbInput(
        fault.kind,
        name,
        index,
        begin if tick is None else max(begin, tick),
        None if fault.for_s is None else ticks_for(fault.for_s),
        float(value) if value is not None and INPUTS[name] == ANALOG else value,
        max(1, ticks_for(span_s)),
        fault.bounces,
        float(fault.per_s or fault.sigma or fault.rate_hz),
        None if fault.bound is None else float(fault.bound),
        0 if fault.seed is None else fault.seed,
    )
