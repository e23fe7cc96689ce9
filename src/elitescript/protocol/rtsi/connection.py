"""One client of the RTSI port: typed variables both ways, up to 250 times a second.

A message is its size (u16, of the whole message), a command (one letter) and what the command carries. `COMMANDS`
is the table of commands.

Evidence: framing, commands and replies are what the vendor's client sends and parses. *Assumed*: a refused set-up has
the number 0; inputs that are sent while paused apply, and the first package after the start shows them; commands may
come before `V`; `S` without recipes succeeds; recipes may be added while data flows; inputs apply in local control too;
texts of messages; messages that cannot be obeyed are answered with a text message, at most one a second of each kind,
and otherwise ignored.
"""

from __future__ import annotations

import struct
from collections.abc import Callable
from functools import partial
from math import isnan
from typing import Final

from elitescript.messages.inputs import AddLog, Do, Input, VariablesArrived
from elitescript.messages.outputs import Output
from elitescript.messages.snapshot import RobotDescription
from elitescript.messages.snapshot_parts import ALL_PARTS
from elitescript.messages.timing import TICKS_PER_S
from elitescript.protocol.binary import UINT8, UINT16, UINT32, Field, FieldList, WireValue
from elitescript.protocol.connection import Connection, ProtocolError
from elitescript.protocol.lines import text_bytes
from elitescript.protocol.rtsi import advice
from elitescript.protocol.rtsi.inputs import INPUTS, Arrival, requests_of
from elitescript.protocol.rtsi.recipes import FREQUENCY_MAX_HZ, FREQUENCY_MIN_HZ, InputRecipe, OutputRecipe, RtsiPort
from elitescript.protocol.rtsi.variables import OUTPUTS
from elitescript.records import NamedTuple, replace

HELD_BACK_TICKS: Final = TICKS_PER_S // 2
"""Longest wait of packages after the start for inputs that were sent before it; a restarted robot loses them."""
PROTOCOL_VERSION: Final = 1
MESSAGE_MAX: Final = 65535
RECIPES_MAX: Final = 254
"""In each direction."""
VARIABLES_MAX: Final = 2048
"""Of all recipes of a client in each direction, a bound of the time for packing (*assumed*)."""

NOT_FOUND: Final = "NOT_FOUND"
IN_USE: Final = "IN_USE"

EXCEPTION: Final = 0
ERROR: Final = 1
WARNING: Final = 2
INFO: Final = 3
"""Levels of text messages."""
_LEVELS: Final = ("exception", "error", "warning", "info")

_FRAME: Final = FieldList(Field("size", UINT16), Field("command", UINT8))
_VERSION: Final = FieldList(*(Field(name, UINT32) for name in ("major", "minor", "bug fix", "build")))
_SHORT: Final = frozenset(map(ord, "VvSP"))
"""Commands of five bytes at most."""
_FREQUENCY: Final = struct.Struct(">d")


class RtsiCommand(NamedTuple):
    """One row of the table of commands."""

    letter: str
    name: str
    question: str
    """What the client sends after the head."""
    answer: str
    """What the controller sends after the head."""


COMMANDS: Final = (
    RtsiCommand("V", "request protocol version", "u16 version; there is only 1", "u8: 1 accepted, 0 refused"),
    RtsiCommand("v", "get controller version", "nothing", "u32 major, u32 minor, u32 bug fix, u32 build"),
    RtsiCommand(
        "M",
        "text message",
        "u8 length, text, u8 length, source, u8 level",
        "u8 level (0 exception, 1 error, 2 warning, 3 info), text; at any time",
    ),
    RtsiCommand("U", "data package", "u8 input recipe, values", "u8 output recipe, values; never an answer"),
    RtsiCommand("O", "set up output recipe", "f64 frequency in Hz, names", "u8 recipe, types"),
    RtsiCommand("I", "set up input recipe", "names", "u8 recipe, types"),
    RtsiCommand("S", "start", "nothing", "u8: 1 started"),
    RtsiCommand("P", "pause", "nothing", "u8: 1 paused"),
)


class RtsiConnection(Connection):
    """One client.

    Args:
        origin: names the client, such as `rtsi#2`; unique at a port.
        description: the robot.
        port: shared by the clients of this robot.
    """

    __slots__ = (
        "_answers",
        "_arrived",
        "_buffer",
        "_failure",
        "_first_tick",
        "_held_back_until",
        "_inputs",
        "_is_started",
        "_noted_kinds",
        "_outputs",
        "_port",
        "_reported",
        "_values",
        "_written_tick",
    )

    def __init__(self, origin: str, description: RobotDescription, port: RtsiPort) -> None:
        super().__init__(origin, description)
        self._port = port
        self._buffer = bytearray()
        self._failure: ProtocolError | None = None
        self._outputs: list[OutputRecipe] = []
        self._inputs: list[InputRecipe] = []
        self._arrived: list[VariablesArrived] = []
        """The report of a package, by input recipe."""
        self._values: dict[str, WireValue] = {}
        self._is_started = False
        self._answers = 0
        self._written_tick: int | None = None
        self._first_tick = 0
        """Tick of the first package after the start, which shows the inputs that were sent before the start."""
        self._held_back_until = 0
        self._reported: dict[str, int] = {}
        """Tick of the last text message by kind of problem."""
        self._noted_kinds: set[str] = set()
        """What the log has said of the client."""

    @property
    def is_streaming(self) -> bool:
        """Whether the client gets packages."""
        return self._is_started

    @property
    def answers(self) -> int:
        """Input packages of a client that gets packages, since its start or since `forget_answers`; 0 for any other."""
        return self._answers if self._outputs else 0

    def forget_answers(self) -> None:
        """Count input packages anew."""
        self._answers = 0

    def receive(self, data: bytes, output: Output) -> list[Input]:
        """Take bytes; answer complete messages. See `Connection.receive`.

        Messages before an invalid one are still handled: then the next call raises the error, and the connection is
        over.
        """
        if self._failure is not None:
            raise self._failure
        inputs: list[Input] = []
        buffer = self._buffer
        buffer += data
        at = 0
        try:
            while len(buffer) - at >= _FRAME.size:
                size, command = struct.unpack_from(">HB", buffer, at)
                if size < _FRAME.size:
                    raise ProtocolError(f"a message has at least {_FRAME.size} bytes, not {size}")
                if command in _SHORT and size >= 256 and size % 256 == 0:
                    # Otherwise such a client and this port would wait for each other for ever.
                    text = f"message {chr(command)} has {size} bytes; RTSI is big-endian, and this client little-endian"
                    raise ProtocolError(text)
                if len(buffer) - at < size:
                    break
                inputs += self._obey(command, bytes(buffer[at + _FRAME.size : at + size]), output)
                at += size
        except ProtocolError as error:
            buffer.clear()
            self._failure = error
            self.send_text(ERROR, f"the connection is closed: {error}")
            self.is_over = True
            if not inputs:
                raise
            return inputs
        del buffer[:at]
        return inputs

    def reads(self, tick: int) -> int:
        """See `Connection.reads`. A client that gets no packages may begin at any time, with any recipe."""
        if not self._is_started:
            return ALL_PARTS
        parts = 0
        for recipe in self._outputs:
            if recipe.schedule.will_be_due(tick):
                parts |= recipe.parts
        return parts

    def publish(self, output: Output) -> None:
        """Queue the packages that are due: of this tick, or of earlier ones that leave with it (`Output.rows`).

        A client that has just written an input gets no package of an earlier tick, since it takes the next package for
        the answer. The first package after a start shows all inputs that were written before.
        """
        tick = output.tick
        if not self._is_started or tick == self._written_tick:
            return
        if output.late_rows is None:
            self._queue(output, tick)
            return
        for row in output.late_rows:
            self._queue(row, tick)
        if output.repeats:
            self._repeat(output)

    def _queue(self, row: Output, now: int) -> None:
        """Queue the packages that are due at the tick of a row."""
        if self._is_held_back(row, now):
            return
        tick = row.tick
        for recipe in self._outputs:
            if tick < recipe.new_before and not row.has(recipe.parts):
                continue
            if recipe.schedule.is_due(tick):
                package = recipe.newest = self._port.packages.package(recipe, row)
                self._out.append(package)

    def _repeat(self, output: Output) -> None:
        """Queue the last package of each recipe again where one would be due; a first one shows the last snapshot.

        What is due of later rows stays as it is.
        """
        tick = output.tick
        if self._is_held_back(output, tick):
            return
        for recipe in self._outputs:
            if not recipe.newest:
                if tick < recipe.new_before and not output.has(recipe.parts):
                    continue
                recipe.newest = self._port.packages.package(recipe, output)
                recipe.schedule.is_due(tick)
            elif not recipe.schedule.falls_on(tick):
                continue
            self._out.append(recipe.newest)

    def _is_held_back(self, row: Output, now: int) -> bool:
        """Return whether the first package after the start waits for inputs that were sent before it."""
        if self._first_tick:
            if row.snapshot.robot.tick < self._first_tick and now < self._held_back_until:
                return True
            self._first_tick = 0
        return False

    def next_tick(self, tick: int) -> int | None:
        if not self._is_started:
            return None
        return min((recipe.schedule.next_tick(tick) for recipe in self._outputs), default=None)

    def posted(self, tick: int) -> None:
        if self._first_tick:
            self._first_tick = max(self._first_tick, tick)

    def closed(self) -> list[Input]:
        """Release the client's inputs, which keep their values."""
        self._port.claims.release(self.origin)
        self._is_started = False
        self._answers = 0
        return []

    def send_text(self, level: int, text: str) -> None:
        """Queue a text message for the client."""
        body = text_bytes(text)[: MESSAGE_MAX - _FRAME.size - 1].decode(errors="ignore").encode()
        self._reply("M", bytes([level]) + body)

    def _obey(self, command: int, body: bytes, output: Output) -> list[Input]:
        handler = _HANDLERS.get(command)
        if handler is None:
            self._report(f"command {command}", f"there is no command {chr(command)!r} ({command})", output)
            return []
        return handler(self, body, output)

    def _reply(self, letter: str, body: bytes) -> None:
        self.send(_FRAME.pack([_FRAME.size + len(body), ord(letter)]) + body)

    def _noted(self, kind: str, make_text: Callable[[], str], output: Output) -> list[Input]:
        """Return a warning for the log, once a client for each kind, and once a second for clients that reconnect.

        The text is made only then: looking for the nearest names takes milliseconds.
        """
        if kind in self._noted_kinds:
            return []
        text = make_text()
        if not self._port.may_say(text, output.tick):
            return []
        self._noted_kinds.add(kind)
        return [AddLog(self.origin, f"{self.origin}: {text}", is_warning=True)]

    def _report(self, kind: str, text: str, output: Output, level: int = ERROR) -> None:
        """Send a text message about a problem, unless one of its kind was sent within a second."""
        last = self._reported.get(kind)
        if last is not None and 0 <= output.tick - last < TICKS_PER_S:
            return
        self._reported[kind] = output.tick
        self.send_text(level, text)

    # ---------------------------------------------------------------- handlers, one for each command

    def _negotiate(self, body: bytes, output: Output) -> list[Input]:
        version = int.from_bytes(body) if len(body) == 2 else None
        self._reply("V", bytes([version == PROTOCOL_VERSION]))
        if version != PROTOCOL_VERSION:
            asked = "nothing" if version is None else str(version)
            self._report("version", f"the protocol version is {PROTOCOL_VERSION}, you asked for {asked}", output)
        return []

    def _tell_version(self, _body: bytes, _output: Output) -> list[Input]:
        self._reply("v", _VERSION.pack(self.description.version))
        return []

    def _log(self, body: bytes, output: Output) -> list[Input]:
        parts = _text_message(body)
        if parts is None:
            self._report("text", "a text message is: length, text, length, source, level", output)
            return []
        text, source, level = parts
        name = _LEVELS[level] if level < len(_LEVELS) else f"level {level}"
        return [AddLog(self.origin, f"{name}: {source}: {text}" if source else f"{name}: {text}")]

    def _set_up_output(self, body: bytes, output: Output) -> list[Input]:
        if len(body) < _FREQUENCY.size:
            self._refuse("O", [], "an output recipe begins with its frequency, an f64", output)
            return []
        wanted_hz: float = _FREQUENCY.unpack_from(body)[0]
        if problem := _too_many(body[_FREQUENCY.size :]):
            return self._refuse_unread("O", problem, output)
        names = _names(body[_FREQUENCY.size :])
        words = [OUTPUTS[name].type.name if name in OUTPUTS else NOT_FOUND for name in names]
        problem = self._problem(names, self._outputs)
        if not problem and isnan(wanted_hz):
            problem = "the frequency of a recipe must be a number, not nan"
        if problem or NOT_FOUND in words:
            self._refuse("O", words, problem, output)
            if problem and NOT_FOUND not in words:
                return []
            return self._noted("output names", lambda: advice.unknown_names(names, is_input=False), output)
        frequency_hz = min(max(wanted_hz, FREQUENCY_MIN_HZ), FREQUENCY_MAX_HZ)
        recipe = OutputRecipe(len(self._outputs) + 1, names, frequency_hz)
        if recipe.size > MESSAGE_MAX:
            self._refuse("O", words, f"a package has {MESSAGE_MAX} bytes at most, not {recipe.size}", output)
            return []
        self._outputs.append(recipe)
        self._hold_back_old(recipe, output)
        self._reply("O", bytes([recipe.ident]) + ",".join(words).encode())
        if frequency_hz != wanted_hz:
            text = f"recipe {recipe.ident} is sent at {frequency_hz:g} Hz, not {wanted_hz:g} Hz"
            self._report("frequency", f"{text}: the range is 1 to 250 Hz", output, WARNING)
        return []

    def _set_up_input(self, body: bytes, output: Output) -> list[Input]:
        if problem := _too_many(body):
            return self._refuse_unread("I", problem, output)
        names = _names(body)
        claims = self._port.claims
        words = [
            NOT_FOUND if name not in INPUTS else INPUTS[name].name if claims.is_free(self.origin, name) else IN_USE
            for name in names
        ]
        problem = self._problem(names, self._inputs)
        if problem or NOT_FOUND in words or IN_USE in words:
            self._refuse("I", words, problem, output)
            if NOT_FOUND in words:
                return self._noted("input names", lambda: advice.unknown_names(names, is_input=True), output)
            taken = [(name, claims.owner(name)) for name, word in zip(names, words, strict=True) if word == IN_USE]
            return self._noted("claims", lambda: advice.claimed_names(taken), output) if taken else []
        recipe = InputRecipe(len(self._inputs) + 1, names)
        self._inputs.append(recipe)
        self._arrived.append(VariablesArrived(self.origin, recipe.names))
        claims.claim(self.origin, names)
        self._reply("I", bytes([recipe.ident]) + ",".join(words).encode())
        return []

    def _problem(self, names: tuple[str, ...], recipes: list[OutputRecipe] | list[InputRecipe]) -> str:
        """Return why one more recipe is refused, apart from its names; empty if it is not."""
        if not names:
            return "a recipe needs at least one variable"
        if len(recipes) >= RECIPES_MAX:
            return f"a client has {RECIPES_MAX} recipes at most in each direction"
        if sum(len(recipe.names) for recipe in recipes) + len(names) > VARIABLES_MAX:
            return f"the recipes of a client have {VARIABLES_MAX} variables at most in each direction"
        return ""

    def _refuse(self, letter: str, words: list[str], problem: str, output: Output) -> None:
        """Answer a set-up that fails; missing or claimed variables need no text message."""
        self._reply(letter, b"\0" + ",".join(words).encode())
        if problem:
            self._report(f"recipe {letter}", problem, output)

    def _refuse_unread(self, letter: str, problem: str, output: Output) -> list[Input]:
        """Answer a set-up whose names were not looked up; return the line for the log, if the client got a message."""
        said = len(self._out)
        self._refuse(letter, [], problem, output)
        is_told = len(self._out) > said + 1
        return [AddLog(self.origin, f"{self.origin}: {problem}", is_warning=True)] if is_told else []

    def _start(self, _body: bytes, output: Output) -> list[Input]:
        self._reply("S", b"\x01")
        if not self._is_started:
            self._is_started = True
            for recipe in self._outputs:
                recipe.begin()
                self._hold_back_old(recipe, output)
            self._held_back_until = output.tick + HELD_BACK_TICKS
            # Of several rows that left together the newest one.
            self.publish(output if not output.late_rows else replace(output, late_rows=output.late_rows[-1:]))
        return []

    def _hold_back_old(self, recipe: OutputRecipe, output: Output) -> None:
        """Send no older snapshot of what was not read before: this tick and one under way may lack it."""
        recipe.new_before = output.tick + 2

    def _pause(self, _body: bytes, _output: Output) -> list[Input]:
        self._is_started = False
        self._answers = 0
        self._reply("P", b"\x01")
        return []

    def _take_values(self, body: bytes, output: Output) -> list[Input]:
        ident = body[0] if body else 0
        if not 1 <= ident <= len(self._inputs):
            self._report("ident", f"there is no input recipe {ident}; you have set up {len(self._inputs)}", output)
            return []
        recipe = self._inputs[ident - 1]
        size = _FRAME.size + len(body)
        if size != recipe.size:
            text = f"a package of input recipe {ident} has {recipe.size} bytes, not {size}; it was ignored"
            self._report("size", text, output)
            return []
        values = self._values | recipe.values(body[1:])
        arrival = Arrival(values, self._values, output.snapshot, {})
        inputs: list[Input] = [Do(self.origin, request) for request in requests_of(recipe.effects, arrival)]
        self._values = values
        self._written_tick = output.tick
        self._answers += self._is_started
        for name, text in arrival.problems.items():
            self._report(name, text, output)
        if not self._is_started:
            self._first_tick = output.tick + 1
        inputs.append(self._arrived[ident - 1])
        if not recipe.is_looked_at:
            recipe.is_looked_at = True
            for text in advice.without_effect(recipe.names, [other.names for other in self._inputs]):
                inputs += self._noted(text, partial(str, text), output)
        return inputs


_HANDLERS: Final[dict[int, Callable[[RtsiConnection, bytes, Output], list[Input]]]] = {
    ord("V"): RtsiConnection._negotiate,
    ord("v"): RtsiConnection._tell_version,
    ord("M"): RtsiConnection._log,
    ord("U"): RtsiConnection._take_values,
    ord("O"): RtsiConnection._set_up_output,
    ord("I"): RtsiConnection._set_up_input,
    ord("S"): RtsiConnection._start,
    ord("P"): RtsiConnection._pause,
}


def _too_many(body: bytes) -> str:
    """Return why a recipe is refused whose names are not even looked up: there are too many; empty if there are not."""
    count = body.rstrip(b", ").count(b",") + 1
    return f"a recipe has {VARIABLES_MAX} variables at most, not {count}" if count > VARIABLES_MAX else ""


def _names(body: bytes) -> tuple[str, ...]:
    """Return the names of a recipe, without empty ones at the end."""
    names = [name.strip() for name in body.decode("utf-8", errors="replace").split(",")]
    while names and not names[-1]:
        names.pop()
    return tuple(names)


def _text_message(body: bytes) -> tuple[str, str, int] | None:
    """Return the text, source and level of a client's message; None if it is malformed."""
    if not body:
        return None
    text_end = 1 + body[0]
    if len(body) <= text_end:
        return None
    source_end = text_end + 1 + body[text_end]
    if len(body) != source_end + 1:
        return None
    text, source = body[1:text_end], body[text_end + 1 : source_end]
    return text.decode(errors="replace"), source.decode(errors="replace"), body[source_end]
