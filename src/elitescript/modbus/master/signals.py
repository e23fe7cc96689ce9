"""A MODBUS signal of the controller: its request and last known state. Function codes: table 6-1 of manual 2.14."""

from __future__ import annotations

from collections.abc import Sequence
from enum import IntEnum
from typing import Final

from elitescript.modbus.frames.pdu import (
    READ_COILS,
    READ_DISCRETE_INPUTS,
    READ_HOLDING_REGISTERS,
    READ_INPUT_REGISTERS,
    AnswerError,
    ExceptionResponse,
    read,
    read_write_registers,
    values_of,
    write_coil,
    write_coils,
    write_register,
    write_registers,
)
from elitescript.modbus.frames.tcp import tcp_frame

DEFAULT_FREQUENCY_HZ: Final = 10
"""*assumed*"""

BROADCAST: Final = 0

NOT_CONNECTED: Final = -2
CONNECTING: Final = -1
NO_ERROR: Final = 0
UNDEFINED_ERROR: Final = 9
"""An answer of the wrong slave, function or length, or an unknown exception (*assumed*)."""

DEVICE_CODE_MAX: Final = 11


class SignalKind(IntEnum):
    """Kind of a signal; the first four are the numbers of `modbus_add_signal`."""

    DIGITAL_INPUT = 0
    DIGITAL_OUTPUT = 1
    REGISTER_INPUT = 2
    REGISTER_OUTPUT = 3
    READ_WRITE = 4
    CUSTOM = 5
    """A request with any function code."""


_READS: Final = {
    SignalKind.DIGITAL_INPUT: READ_DISCRETE_INPUTS,
    SignalKind.DIGITAL_OUTPUT: READ_COILS,
    SignalKind.REGISTER_INPUT: READ_INPUT_REGISTERS,
    SignalKind.REGISTER_OUTPUT: READ_HOLDING_REGISTERS,
    SignalKind.READ_WRITE: READ_HOLDING_REGISTERS,
}


class ModbusSignal:
    """Coils or registers of a device, which the controller reads or writes periodically.

    Args:
        name: of the signal; empty for a custom request.
        kind: of the signal.
        unit: number of the slave.
        address: first coil or register; of those that are read, if it reads and writes.
        count: how many.
        is_sequential: never requested while another sequential one of its connection waits for an answer.
        tick: the present one.
        write_address: first register that it writes, if it reads and writes.
        write_count: how many.
        custom: the whole request, if it is a custom one.
        is_once: whether that is sent once.

    Attributes:
        frequency_hz: requests per second; 0 for none.
        watchdog_ticks: how long it may be faulty before using it is an alarm.
        choice: level of an output without a program, see `forced`.
        outputs: values that the program has set, from the first coil or register on; None before.
        inputs: values that were read last; zeros before.
        request: the present request.
        tail: the frame of the request behind its transaction number.
        answer: the last good answer to that request; empty if there is none.
        added_tick: when it began.
        ok_tick: when it last worked, or began.
        fault_tick: since when it does not work; None while it does.
        device_code: exception code of the device.
        connection_code: an errno.
        is_waiting: whether it is due and not sent.
        is_owed: whether the values of the program are not written yet; any answer ends that.
        is_removed: whether it was removed, so that its answers are not reported.
        noted: what and data of its last recorded entry; None if the next one is recorded in any case.
        missed: how often it was due again while it still waited.
        turn: number of its last request on its connection.
        has_value: whether an answer has brought values.
        early: lines that have read it before that; None without one.
        set_turn: `turn` when a program set it last; -1 before.
        set_tick: when that was.
        sets: how often programs have set it.
        first_set_tick: when that was first.
        replaced: values before the last set.
    """

    __slots__ = (
        "added_tick",
        "address",
        "answer",
        "choice",
        "connection_code",
        "count",
        "custom",
        "device_code",
        "early",
        "fault_tick",
        "first_set_tick",
        "frequency_hz",
        "has_value",
        "inputs",
        "is_once",
        "is_owed",
        "is_removed",
        "is_sequential",
        "is_waiting",
        "kind",
        "missed",
        "name",
        "noted",
        "ok_tick",
        "outputs",
        "replaced",
        "request",
        "set_tick",
        "set_turn",
        "sets",
        "tail",
        "turn",
        "unit",
        "watchdog_ticks",
        "write_address",
        "write_count",
    )

    def __init__(
        self,
        name: str,
        kind: SignalKind,
        unit: int,
        address: int,
        count: int,
        *,
        tick: int,
        is_sequential: bool = False,
        write_address: int = 0,
        write_count: int = 0,
        custom: bytes = b"",
        is_once: bool = False,
    ) -> None:
        self.name = name
        self.kind = kind
        self.unit = unit
        self.address = address
        self.count = count
        self.is_sequential = is_sequential
        self.write_address = write_address
        self.write_count = write_count
        self.custom = custom
        self.is_once = is_once
        self.frequency_hz = DEFAULT_FREQUENCY_HZ
        self.watchdog_ticks = 0
        self.choice = 0
        self.outputs: tuple[int, ...] | None = None
        self.inputs: tuple[int, ...] = (0,) * count
        self.request = b""
        self.tail = b""
        self.answer = b""
        self.added_tick = self.ok_tick = tick
        self.fault_tick: int | None = tick
        self.device_code = CONNECTING
        self.connection_code = NO_ERROR
        self.is_waiting = False
        self.is_owed = is_once
        self.is_removed = False
        self.noted: tuple[str, str] | None = None
        self.missed = 0
        self.turn = 0
        self.has_value = False
        self.early: set[int] | None = None
        self.set_turn = -1
        self.set_tick = self.first_set_tick = 0
        self.sets = 0
        self.replaced: tuple[int, ...] | None = None
        self.prepare(is_running=True)

    # ---------------------------------------------------------------- requests

    @property
    def is_output(self) -> bool:
        """Whether programs can set it."""
        return self.kind in (SignalKind.DIGITAL_OUTPUT, SignalKind.REGISTER_OUTPUT, SignalKind.READ_WRITE)

    @property
    def is_asking(self) -> bool:
        """Whether its request only reads."""
        return self.request[0] <= READ_INPUT_REGISTERS and self.kind is not SignalKind.CUSTOM

    @property
    def writable(self) -> int:
        """Number of coils or registers that programs can set."""
        return self.write_count if self.kind is SignalKind.READ_WRITE else self.count

    def set(self, values: Sequence[int]) -> None:
        """Take the values that the program sets; coils or registers behind those it has ever set are not written."""
        known = self.outputs or ()
        self.outputs = (*values, *known[len(values) :])

    def forced(self, is_running: bool) -> int | None:
        """Return the level of an output that overrides the values of the program, by `choice`; None for none.

        0: none; 1: low without a program; 2: high without a program; 3: low without a program, high with one.
        """
        if self.choice == 3:
            return int(is_running)
        if self.choice == 0 or is_running:
            return None
        return self.choice - 1

    def prepare(self, *, is_running: bool) -> None:
        """Update the request."""
        request = self.custom or self._request(is_running)
        if request != self.request:
            self.request = request
            self.tail = tcp_frame(0, self.unit, request)[2:]
            self.answer = b""
            self.is_owed = self.is_once or not self.is_asking

    def _request(self, is_running: bool) -> bytes:
        forced = self.forced(is_running)
        values = self.outputs if forced is None else (forced,) * self.count
        if values is None:
            return read(_READS[self.kind], self.address, self.count)
        if self.kind is SignalKind.READ_WRITE:
            return read_write_registers(self.address, self.count, self.write_address, values)
        if self.kind is SignalKind.DIGITAL_OUTPUT:
            return write_coil(self.address, values[0]) if self.count == 1 else write_coils(self.address, values)
        return write_register(self.address, values[0]) if self.count == 1 else write_registers(self.address, values)

    @property
    def is_digital(self) -> bool:
        """Whether it has coils or discrete inputs."""
        return self.kind in (SignalKind.DIGITAL_INPUT, SignalKind.DIGITAL_OUTPUT)

    # ---------------------------------------------------------------- answers

    @property
    def values(self) -> tuple[int, ...]:
        """Present values: those that the program has set, else those read last."""
        if self.outputs is None or self.kind is SignalKind.READ_WRITE:
            return self.inputs
        return (*self.outputs, *self.inputs[len(self.outputs) :])

    def written(self, *, is_running: bool) -> tuple[int, ...]:
        """Return the levels or values that an output writes; none if it only reads."""
        forced = self.forced(is_running)
        return self.outputs or () if forced is None else (forced,) * self.count

    def shown(self, values: Sequence[int]) -> str:
        """Return values as text, as programs write them."""
        levels = [str(bool(value)) if self.is_digital else str(value) for value in values]
        return levels[0] if len(levels) == 1 else f"[{', '.join(levels)}]"

    def take(self, request: bytes, answer: bytes, tick: int) -> str:
        """Take the answer to a request; return its problem, empty if there is none."""
        try:
            values = values_of(request, answer)
        except ExceptionResponse as error:
            self.fail(tick, error.code if 1 <= error.code <= DEVICE_CODE_MAX else UNDEFINED_ERROR, NO_ERROR)
            return str(error)
        except AnswerError as error:
            self.fail(tick, UNDEFINED_ERROR, NO_ERROR)
            return str(error)
        if values:
            self.inputs = values
            self.has_value = True
        if request is self.request:
            self.answer = answer
        self.work(tick)
        return ""

    def work(self, tick: int) -> None:
        """Note that it works."""
        self.ok_tick = tick
        self.fault_tick = None
        self.device_code = self.connection_code = NO_ERROR

    def fail(self, tick: int, device_code: int, connection_code: int) -> None:
        """Note that it does not work."""
        if self.fault_tick is None:
            self.fault_tick = tick
        self.device_code, self.connection_code = device_code, connection_code
        self.answer = b""

    def is_overdue(self, tick: int) -> bool:
        """Return whether it has been faulty for longer than its watchdog allows."""
        return self.fault_tick is not None and tick - self.fault_tick > self.watchdog_ticks
