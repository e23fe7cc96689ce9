"""Journals of format 2, in which faults and replies were texts: read, and compared with what the robot gives today."""

from __future__ import annotations

from typing import Any, Final

from elitescript.codec.json_text import to_text
from elitescript.codec.messages import shape_of
from elitescript.codec.values import CodecError, write_text
from elitescript.devices.channels.faults import fault_from
from elitescript.devices.channels.machine_faults import machine_fault
from elitescript.errors import UsageError
from elitescript.kernel import RobotOptions
from elitescript.messages.enums import ChannelError
from elitescript.messages.events import Event, TaskStateChanged, Warned
from elitescript.messages.faults import ChannelFault
from elitescript.messages.inputs import AddFault, EndFaults, Input, Query
from elitescript.messages.machine import DisturbInput
from elitescript.messages.outcomes import InterpreterOutcome, Refused, RegistersRead, ShownValue
from elitescript.messages.outputs import NOT_CONNECTED, Output, Reply
from elitescript.messages.profile import PLAIN
from elitescript.protocol import interpreter, query
from elitescript.records import fields_of, replace
from elitescript.services.options_data import options_from_data
from elitescript.services.output_text import without_points
from elitescript.untrusted.json_text import json_value

FORMAT: Final = 2

_CONFIG: Final = [
    "model",
    "model_text",
    "firmware",
    "seed",
    "first_tick",
    "epoch_s",
    "joints",
    "speed",
    "power_on",
    "power_times",
    "remote",
    "robot_id",
    "serial_number",
    "configuration",
    "contact",
    "safety",
    "plant",
    "signals",
    "faults",
    "work_per_tick",
    "rpc_timeout_s",
    "strict",
]
"""Options in the order of that format, which does not name them."""
_FAULTS: Final = "faults"
_EVENTS, _REPLIES = map(list(fields_of(Output)).index, ("events", "replies"))
_ADDED: Final[dict[object, tuple[object, ...]]] = {"Warned": (False,), "TaskStateChanged": ("",)}
"""Defaults of the fields at the end of an event that came after that format, by its name."""
_ITEMS: Final[dict[object, int]] = {
    kind.__name__: 1 + len(fields_of(kind)) - len(_ADDED[kind.__name__]) for kind in (Warned, TaskStateChanged)
}
"""Items of these events with their name, as that format has them."""

_LATE: Final = ("no answer within", "connection timed out")
_ERRORS: Final = {
    "": ChannelError.RESET,
    NOT_CONNECTED: ChannelError.NOTHING_BOUND,
    "broken pipe": ChannelError.BROKEN_PIPE,
    "network is unreachable": ChannelError.NETWORK_UNREACHABLE,
    "connection reset by peer": ChannelError.RESET,
    "connection refused": ChannelError.REFUSED,
    "host is down": ChannelError.HOST_DOWN,
    "no route to host": ChannelError.HOST_UNREACHABLE,
    "the address is not known": ChannelError.HOST_UNREACHABLE,
    "name or service not known": ChannelError.HOST_UNREACHABLE,
}
"""What the reasons of channels, in small letters, stood for."""


class Format2:
    """Translates one journal."""

    __slots__ = ("_idents",)

    def __init__(self) -> None:
        self._idents: dict[str, str] = {}
        """Ids of queries by their origin: replies had them."""

    def options(self, data: Any) -> RobotOptions:
        """Return the options of the first line.

        Raises:
            CodecError: it is none.
        """
        if type(data) is not list or len(data) != len(_CONFIG):
            raise CodecError(f"the options of format {FORMAT} have {len(_CONFIG)} fields")
        values = dict(zip(_CONFIG, data, strict=True))
        faults = tuple(_fault(text) for text in values.pop(_FAULTS))
        return replace(options_from_data(values), faults=faults)

    def input(self, data: Any) -> Input:
        """Return an input of a tick.

        Raises:
            CodecError: it is none.
        """
        match data:
            case ["ChannelOpened", _, _, str(reason)] | ["ChannelClosed", _, str(reason)]:
                data = [*data, int(_channel_error(reason))]
            case ["AddFault", str(origin), ""]:
                return EndFaults(origin)
            case ["AddFault", str(origin), text]:
                return AddFault(origin, _fault(text))
            case ["Query", str(origin), str(ident), str(text)]:
                self._idents[origin] = ident
                return Query(origin, text)
        item: Input = shape_of(Input).decode(data)
        return item

    def event(self, data: Any) -> Event:
        """Return an event that clients were told of while there was no robot.

        Raises:
            CodecError: it is none.
        """
        match data:
            case [str(name), *_] if len(data) == _ITEMS.get(name):
                data = [*data, *_ADDED[name]]
        item: Event = shape_of(Event).decode(data)
        return item

    def output_text(self, output: Output) -> str:
        """Return an output as digests of that format cover it."""
        data = shape_of(Output).encode(without_points(replace(output, replies=())))
        data[_EVENTS] = [event[: _ITEMS.get(event[0])] for event in data[_EVENTS]]
        data[_REPLIES] = [[write_text(reply.origin), write_text(self._reply_text(reply))] for reply in output.replies]
        return to_text(data)

    def _reply_text(self, reply: Reply) -> str:
        ident = self._idents.get(reply.origin)
        if ident is not None:
            return query.reply_text(ident, reply.outcome, PLAIN)
        match reply.outcome:
            case Refused(reason):
                return f"refused: {reason}"
            case ShownValue(text):
                return f"done: {text}"
            case RegistersRead(values):
                return f"done: {''.join(f'{value:04x}' for value in values)}"
            case outcome if isinstance(outcome, InterpreterOutcome):
                return interpreter.reply_text(outcome)
        return "done"


def _channel_error(reason: str) -> ChannelError:
    reason = reason.lower()
    return ChannelError.TIMED_OUT if reason.startswith(_LATE) else _ERRORS.get(reason, ChannelError.OTHER)


def _fault(text: Any) -> ChannelFault | DisturbInput:
    try:
        settings = json_value(text)
        if type(settings) is dict:
            return machine_fault(fault_from(settings))
    except (ValueError, TypeError, RecursionError, UsageError) as error:
        raise CodecError(f"no fault: {str(error)[:200]}") from None
    raise CodecError("no fault: it must be an object")
