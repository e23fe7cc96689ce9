"""Replies that are wrong in the way of their protocol."""

from __future__ import annotations

from elitescript.devices.channels.faults import LINE, Fault
from elitescript.messages.faults import ChannelFault
from elitescript.modbus.frames.pdu import EXCEPTION_BIT
from elitescript.modbus.frames.rtu import rtu_frame
from elitescript.modbus.frames.tcp import TcpSplitter, tcp_frame

BYTES = "bytes"
"""Form of a reply that does not depend on what it replaces."""

_FAULT = (
    "<?xml version='1.0'?><methodResponse><fault><value><struct>"
    "<member><name>faultCode</name><value><int>{}</int></value></member>"
    "<member><name>faultString</name><value><string>{}</string></value></member>"
    "</struct></value></fault></methodResponse>"
)


def form_and_bytes(fault: Fault) -> tuple[str, bytes]:
    """Return form and bytes of a `wrong_reply` as `ChannelFault` has them."""
    match fault.form or "text":
        case "text":
            reply = fault.reply
            return BYTES, reply if isinstance(reply, bytes) else str(reply).encode()
        case "fault":
            text = str(fault.reply).replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
            return BYTES, _http(200, "OK", _FAULT.format(fault.code, text).encode())
        case "http":
            return BYTES, _http(fault.code or 500, "Error", b"")
        case form:
            return form, b"" if fault.code is None else bytes((fault.code,))


def wrong_reply(fault: ChannelFault, request: bytes, data: bytes) -> bytes:
    """Return what arrives instead of a reply.

    Args:
        fault: which one.
        request: what the program sent last.
        data: what has arrived of the right one.
    """
    if fault.form == BYTES:
        return fault.reply
    if fault.place[0] == LINE:
        return _rtu(fault, request, data)
    return b"".join(_tcp(fault, *frame) for frame in TcpSplitter().feed(data)) or data


def _http(status: int, reason: str, body: bytes) -> bytes:
    head = f"HTTP/1.1 {status} {reason}\r\nContent-Type: text/xml\r\nContent-Length: {len(body)}\r\n\r\n"
    return head.encode() + body


def _tcp(fault: ChannelFault, transaction: int, unit: int, pdu: bytes) -> bytes:
    if fault.form == "exception":
        pdu = bytes((pdu[0] | EXCEPTION_BIT,)) + fault.reply
    elif fault.form == "transaction":
        transaction = (transaction + 1) & 0xFFFF
    else:
        unit = (unit + 1) & 0xFF
    return tcp_frame(transaction, unit, pdu)


def _rtu(fault: ChannelFault, request: bytes, data: bytes) -> bytes:
    """Return an answer that is made of the request, as bytes of the right one come in pieces."""
    unit, function = (request[0], request[1]) if len(request) > 1 else (1, 3)
    if fault.form == "unit":
        unit = unit % 247 + 1
    if fault.form == "exception":
        return rtu_frame(unit, bytes((function | EXCEPTION_BIT,)) + fault.reply)
    frame = rtu_frame(unit, bytes((function,)) + (request[2:6] if function in (5, 6, 15, 16) else b"\x02\x00\x00"))
    return frame if fault.form == "unit" else frame[:-1] + bytes((frame[-1] ^ 0xFF,))
