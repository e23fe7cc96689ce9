"""Devices that are declared in a world file: replies by text, pattern or sequence, procedures, reactions."""

from __future__ import annotations

import re
import warnings
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Final

from elitescript.controller.signals.by_name import signal_write
from elitescript.devices.device import Device, check_number, check_text
from elitescript.devices.expressions import Expression
from elitescript.devices.kinds.lines import Answer, check_encodable
from elitescript.devices.kinds.modbus import TABLES, ModbusDevice
from elitescript.devices.kinds.serial import SerialDevice
from elitescript.devices.kinds.tcp import LATENCY_MAX_S, TcpConnection, TcpServer
from elitescript.devices.kinds.xmlrpc import RpcFault, XmlRpcServer
from elitescript.errors import UsageError, did_you_mean
from elitescript.messages.signals import SIGNALS

_REPLY_KEYS: Final = ("to", "match", "send", "expression", "after_s", "set", "close")
_REACTION_KEYS: Final = ("write", "set", "value", "when", "after_s")


class DeclaredReply:
    """One row of `replies`: what a device answers to a line.

    Args:
        table: the row.

    Raises:
        UsageError: it makes no sense.
    """

    __slots__ = ("_expression", "_pattern", "_sent", "_to", "after_s", "closes", "sends", "sets")

    def __init__(self, table: object) -> None:
        if not isinstance(table, Mapping):
            raise UsageError(f"a reply is a table such as {{ to = 'where?', send = '(1, 2)' }}, not {table!r}")
        _check_keys(table, _REPLY_KEYS)
        if ("to" in table) is ("match" in table):
            raise UsageError("to: give either to, the whole line, or match, a regular expression for it")
        self._to = table.get("to")
        self._pattern = None
        if self._to is not None:
            check_text("to", self._to)
        else:
            check_text("match", table["match"])
            try:
                with warnings.catch_warnings():
                    warnings.simplefilter("ignore")  # of patterns that a later Python may read otherwise
                    self._pattern = re.compile(table["match"])
            except re.error as error:
                raise UsageError(f"match: {table['match']!r} is no regular expression: {error}") from None
        if "send" in table and "expression" in table:
            raise UsageError("expression: give either send or expression")
        sends = table.get("send", [])
        self.sends: list[str] = [sends] if isinstance(sends, str) else sends
        if not isinstance(self.sends, list) or not all(isinstance(text, str) for text in self.sends):
            raise UsageError(f"send: write a text, or a list of texts for one question after the other, not {sends!r}")
        if self._pattern is not None:
            for text in self.sends:
                _check_template(self._pattern, text)
        self._sent = 0
        self._expression = None
        if "expression" in table:
            self._expression = _expression("expression", table["expression"], ("line", "groups"))
        self.after_s = table.get("after_s", 0.0)
        check_number("after_s", self.after_s, 0.0, LATENCY_MAX_S, "s")
        self.closes = table.get("close", False)
        if not isinstance(self.closes, bool):
            raise UsageError(f"close: must be true or false, got {self.closes!r}")
        self.sets = _checked_signals(table.get("set", {}))
        if not (self.sends or self._expression or self.closes or self.sets):
            raise UsageError("send: say what happens: send, expression, set or close")

    def fits(self, line: str) -> re.Match[str] | bool:
        """Return whether it is the reply to a line."""
        if self._pattern is None:
            return line == self._to
        return self._pattern.fullmatch(line) or False

    def text(self, line: str, found: re.Match[str] | bool, device: Device) -> str | None:
        """Return what is sent; the texts of a list follow each other, and the last one stays."""
        if self._expression is not None:
            groups = [] if isinstance(found, bool) else list(found.groups())
            return str(self._expression.value(device.cell.read, {"line": line, "groups": groups}))
        if not self.sends:
            return None
        text = self.sends[min(self._sent, len(self.sends) - 1)]
        self._sent += 1
        return text if isinstance(found, bool) else found.expand(text)


class _Speaker:
    """What a declared device on TCP and one on a serial line have in common."""

    replies: Any = ()
    greeting: str = ""
    otherwise: str = ""
    encoding: str

    _rows: Sequence[DeclaredReply] = ()

    def read_replies(self) -> None:
        """Take the settings apart.

        Raises:
            UsageError: one makes no sense.
        """
        check_text("greeting", self.greeting)
        check_text("otherwise", self.otherwise)
        self._rows = _rows("replies", self.replies, DeclaredReply)
        check_encodable("greeting", self.greeting, self.encoding)
        check_encodable("otherwise", self.otherwise, self.encoding)
        for number, row in enumerate(self._rows, 1):
            for text in row.sends:
                check_encodable(f"replies: row {number}: send", text, self.encoding)

    def reply(self, device: Device, line: str, send: Callable[[str], Any], close: Callable[[], Any]) -> None:
        """Answer a line."""
        for row in self._rows:
            if found := row.fits(line):
                break
        else:
            if self.otherwise:
                send(self.otherwise)
            else:
                device.warn(f"has no reply to {line[:200]!r}")
            return
        text = row.text(line, found, device)
        for name, value in row.sets.items():
            device.cell.set(name, value, row.after_s)
        if text is not None:
            device.after(row.after_s, send, text) if row.after_s else send(text)
        if row.closes:
            device.after(row.after_s, close) if row.after_s else close()


class DeclaredTcp(_Speaker, TcpServer):
    """A TCP server that answers by its table of replies.

    Attributes:
        replies: rows with `to` (the whole line) or `match` (a regular expression for it), and `send` (a text, or a
            list of texts for one question after the other; `\\1` is a group of the pattern) or `expression` (over
            signals, `line` and `groups`), `after_s`, `set` (signals by name), `close`.
        greeting: sent when a program has connected.
        otherwise: sent when no reply fits; without it, that is a warning.
    """

    def check(self) -> None:
        super().check()
        self.read_replies()

    def opened(self, connection: TcpConnection) -> Answer:
        return self.greeting or None

    def line_received(self, connection: TcpConnection, line: str) -> Answer:
        self.reply(self, line, connection.send_line, connection.close)
        return None


class DeclaredSerial(_Speaker, SerialDevice):
    """A device on a serial line that answers by its table of replies, see `DeclaredTcp`.

    Attributes:
        every_s: period in which it sends `unasked` by itself; 0 if it does not.
        unasked: a text, or a list of texts that follow each other; the last one stays.
    """

    every_s: float = 0.0
    unasked: Any = ()

    def check(self) -> None:
        super().check()
        self.read_replies()
        check_number("every_s", self.every_s, 0.0, LATENCY_MAX_S, "s")
        if isinstance(self.unasked, str):
            self.unasked = [self.unasked]
        if not all(isinstance(text, str) for text in self.unasked):
            raise UsageError(f"unasked: write a text, or a list of texts, not {self.unasked!r}")
        for text in self.unasked:
            check_encodable("unasked", text, self.encoding)
        if bool(self.every_s) is not bool(self.unasked):
            raise UsageError("unasked: goes with every_s")

    def started(self) -> None:
        if self.every_s:
            texts = self.unasked
            count = 0

            def send_next() -> None:
                nonlocal count
                self.send(texts[min(count, len(texts) - 1)])
                count += 1

            self.every(self.every_s, send_next)

    def opened(self) -> Answer:
        return self.greeting or None

    def line_received(self, line: str) -> Answer:
        self.reply(self, line, self.send, lambda: None)
        return None


class DeclaredRpc(XmlRpcServer):
    """An XML-RPC server whose procedures are declared: each has a constant answer, or a table.

    Attributes:
        procedures: by name, what is answered: any value, or a table with `expression` (over signals and the names in
            `arguments`), or with `fault` and `text`; `after_s` in both.
    """

    procedures: Mapping[str, Any] = {}

    def check(self) -> None:
        super().check()
        declared: Any = self.procedures
        if not isinstance(declared, Mapping) or not declared:
            raise UsageError("procedures: write a table of names and answers, such as { ready = true }")
        for name, answer in self.procedures.items():
            try:
                self.functions = {**self.functions, name: self._procedure(answer)}
            except UsageError as error:
                raise UsageError(f"procedures: {name}: {error}") from None

    def _procedure(self, answer: Any) -> Callable[..., Any]:
        if not isinstance(answer, Mapping) or not {"expression", "fault"} & set(answer):
            return lambda *arguments: answer
        _check_keys(answer, ("expression", "arguments", "fault", "text", "after_s"))
        after_s = answer.get("after_s", 0.0)
        check_number("after_s", after_s, 0.0, LATENCY_MAX_S, "s")
        if "fault" in answer:
            check_number("fault", answer["fault"], -(2**31), 2**31 - 1, is_whole=True)
            check_text("text", answer.get("text", ""))

            def fail(*arguments: Any) -> Any:
                raise RpcFault(answer["fault"], answer.get("text", ""))

            return fail
        names = tuple(answer.get("arguments", ()))
        expression = _expression("expression", answer["expression"], names)

        def work_out(*arguments: Any) -> Any:
            if len(arguments) != len(names):
                raise RpcFault(1, f"takes {len(names)} arguments, not {len(arguments)}")
            try:
                result = expression.value(self.cell.read, dict(zip(names, arguments, strict=True)))
            except UsageError as error:
                raise RpcFault(1, str(error)) from None
            return self.delayed(after_s, result)

        return work_out


class Reaction:
    """One row of `reactions`: what a MODBUS device does when something is written to it."""

    __slots__ = ("_value", "_when", "after_s", "place", "target")

    def __init__(self, table: object) -> None:
        if not isinstance(table, Mapping):
            raise UsageError(f"a reaction is a table such as {{ write = 'coils[0]', set = 'coils[1]' }}, not {table!r}")
        _check_keys(table, _REACTION_KEYS)
        self.place = _entry("write", table.get("write"))
        if self.place[0] not in ("coils", "holding_registers"):
            raise UsageError(f"write: programs write coils and holding_registers, not {self.place[0]}")
        target = table.get("set")
        check_text("set", target)
        self.target: tuple[str, int] | str
        if str(target).partition("[")[0] in SIGNALS:
            self.target = str(target)
            _checked_signals({self.target: 0})
        else:
            self.target = _entry("set", target)
        self._value = _expression("value", table.get("value", "value"), ("value",))
        self._when = _expression("when", table["when"], ("value",)) if "when" in table else None
        self.after_s = table.get("after_s", 0.0)
        check_number("after_s", self.after_s, 0.0, LATENCY_MAX_S, "s")

    def act(self, device: ModbusDevice, value: int) -> None:
        """Act on what was written."""
        arguments = {"value": value}
        if self._when is not None and not self._when.value(device.cell.read, arguments):
            return
        result = self._value.value(device.cell.read, arguments)
        if isinstance(self.target, str):
            kind = SIGNALS[self.target.partition("[")[0]].kind
            device.cell.set(self.target, {"bool": bool, "int": int, "float": float}[kind](result), self.after_s)
        elif self.after_s:
            device.after(self.after_s, self._put, device, result)
        else:
            self._put(device, result)

    def _put(self, device: ModbusDevice, result: Any) -> None:
        assert isinstance(self.target, tuple)
        name, address = self.target
        getattr(device, name)[address] = int(result)


class DeclaredModbus(ModbusDevice):
    """A MODBUS device that reacts by its tables.

    Attributes:
        reactions: rows with `write` (such as `holding_registers[0]`), `set` (a place of the device, or a signal of the
            robot), `value` (an expression over `value`, what was written, and signals), `when` (such an expression:
            only if it is true) and `after_s`.
        follows: places by expressions over signals, such as `{ "discrete_inputs[0]" = "standard_digital_out[2]" }`:
            worked out whenever they are read.
    """

    reactions: Any = ()
    follows: Mapping[str, str] = {}

    _reactions: Sequence[Reaction] = ()
    _follows: Sequence[tuple[str, int, Expression]] = ()

    def check(self) -> None:
        super().check()
        self._reactions = _rows("reactions", self.reactions, Reaction)
        if not isinstance(self.follows, Mapping):
            raise UsageError("follows: write a table of places and expressions")
        self._follows = [
            (*_entry("follows", place), _expression("follows", text, ())) for place, text in self.follows.items()
        ]
        for number, reaction in enumerate(self._reactions, 1):
            self._check_place(f"reactions: row {number}: write", reaction.place)
            if isinstance(reaction.target, tuple):
                self._check_place(f"reactions: row {number}: set", reaction.target)
        for name, address, _ in self._follows:
            self._check_place("follows", (name, address))

    def _check_place(self, key: str, place: tuple[str, int]) -> None:
        name, address = place
        if address not in getattr(self, name):
            raise UsageError(f"{key}: {name}[{address}] does not exist: {name} of this device ends before or skips it")

    def reading(self, table: str, address: int, count: int) -> None:
        for name, place, expression in self._follows:
            if name == table and address <= place < address + count:
                getattr(self, name)[place] = int(expression.value(self.cell.read))

    def register_written(self, address: int, value: int) -> None:
        self._react(("holding_registers", address), value)

    def coil_written(self, address: int, level: bool) -> None:
        self._react(("coils", address), int(level))

    def _react(self, place: tuple[str, int], value: int) -> None:
        for reaction in self._reactions:
            if reaction.place == place:
                reaction.act(self, value)


def _rows(key: str, tables: object, kind: Callable[[object], Any]) -> list[Any]:
    if isinstance(tables, str | Mapping) or not isinstance(tables, Sequence):
        raise UsageError(f"{key}: write a list of tables, not {tables!r}")
    rows = []
    for number, table in enumerate(tables, 1):
        try:
            rows.append(kind(table))
        except UsageError as error:
            raise UsageError(f"{key}: row {number}: {error}") from None
    return rows


def _entry(key: str, text: object) -> tuple[str, int]:
    """Return a place such as `holding_registers[4]`."""
    check_text(key, text)
    name, _, rest = str(text).partition("[")
    if name not in TABLES or not rest.endswith("]") or not rest[:-1].isdecimal() or int(rest[:-1]) > 65535:
        raise UsageError(f"{key}: write a place such as holding_registers[4]; tables are {', '.join(TABLES)}")
    return name, int(rest[:-1])


def _expression(key: str, text: object, names: Sequence[str]) -> Expression:
    try:
        return Expression(text if isinstance(text, str) else repr(text), tuple(names))
    except UsageError as error:
        raise UsageError(f"{key}: {error}") from None


def _checked_signals(table: object) -> dict[str, Any]:
    if not isinstance(table, Mapping):
        raise UsageError(f"set: write a table of signals and values, not {table!r}")
    for name, value in table.items():
        try:
            signal_write(name, value)
        except UsageError as error:
            raise UsageError(f"set: {error}") from None
    return dict(table)


def _check_template(pattern: re.Pattern[str], text: str) -> None:
    try:
        pattern.sub(text, "")
    except (re.error, IndexError) as error:
        raise UsageError(
            f"send: {text!r} does not go with match {pattern.pattern!r}, which has {pattern.groups} groups: {error}"
        ) from None


def _check_keys(table: Mapping[str, Any], known: Sequence[str]) -> None:
    for key in table:
        if key not in known:
            near = did_you_mean(str(key), known)
            raise UsageError(f"{key}: is not known; there are {', '.join(known)}{near}")
