"""Requests and answers on one open connection of a master: queue, requests under way, window.

No more than a window of requests waits for answers. The window is 1 until signals miss their turns. Then a burst of
twice as many is tried; if each is answered, that is the new window. It stays there if the burst took much longer than
a single request, since more would only wait in the device. A device that does not answer all of a burst gets one
request at a time from then on, and the unanswered ones are repeated. If it has answered none, the next single request
shows whether the burst or the device is the cause.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Final

from elitescript.messages.enums import ChannelError
from elitescript.messages.timing import TICKS_PER_S, seconds
from elitescript.modbus.frames.pdu import READS
from elitescript.modbus.frames.tcp import TcpSplitter
from elitescript.modbus.master.signals import BROADCAST, NO_ERROR, UNDEFINED_ERROR, ModbusSignal
from elitescript.said import said

WINDOW_MAX: Final = 256
"""Largest window: all 200 signals in each tick, with answers in the next tick or a little later."""
REPLY_TICKS: Final = TICKS_PER_S
"""Timeout of an answer (*assumed*)."""
SILENCE_TICKS: Final = 3 * REPLY_TICKS
"""Time without any answer to requests after which the connection is reopened (*assumed*)."""
PROBE_TICKS: Final = TICKS_PER_S // 10
"""Timeout of the answers to a burst; more if the device is slow."""
PROBE_ROUNDS: Final = 4
SLOW_ROUNDS: Final = 2
SLOW_TICKS: Final = 2
"""A burst that takes longer than so many round trips and ticks is the last one."""

TIMED_OUT: Final = int(ChannelError.TIMED_OUT)


class Exchange:
    """Queue of signals to request, and the requests under way.

    Args:
        report: reports the problem of a signal; keyword `is_late` if it was not answered in time.
        note: records traffic: signal, what, data.
        lose: reports why a request that is sent once is given up.
        is_single: whether the device is known to take one request at a time.

    Attributes:
        window: how many requests may wait for an answer.
        is_single: whether the device takes one request at a time.
        answered: number of good answers.
        strays: number of answers without a request.
        broadcasts: signals sent to all slaves, without answer, since the connection last had taken everything.
        has_heard: whether the connection has brought an answer.
    """

    __slots__ = (
        "_chained",
        "_flight",
        "_heard_tick",
        "_is_pressed",
        "_is_suspect",
        "_lose",
        "_note",
        "_probe_begin",
        "_probe_end",
        "_probe_size",
        "_probe_ticks",
        "_proven",
        "_queue",
        "_quickest_ticks",
        "_report",
        "_slowest_ticks",
        "_splitter",
        "_transaction",
        "_turns",
        "answered",
        "broadcasts",
        "has_heard",
        "is_single",
        "strays",
        "window",
    )

    def __init__(
        self,
        report: Callable[..., None],
        note: Callable[[ModbusSignal, str, str], None],
        lose: Callable[[ModbusSignal, str], None],
        *,
        is_single: bool,
    ) -> None:
        self.window = 1
        self.is_single = is_single
        self.answered = 0
        self.strays = 0
        self.has_heard = False
        self.broadcasts: list[ModbusSignal] = []
        self._report = report
        self._note = note
        self._lose = lose
        self._queue: deque[ModbusSignal] = deque()
        self._flight: dict[int, tuple[ModbusSignal, bytes, int]] = {}
        """Signal, request and tick of sending, by transaction; the oldest one first."""
        self._splitter = TcpSplitter()
        self._chained: ModbusSignal | None = None
        """Sequential signal that is under way."""
        self._transaction = 0
        self._turns = 0
        self._heard_tick = 0
        self._slowest_ticks = 0
        self._quickest_ticks = REPLY_TICKS
        self._is_pressed = False
        self._is_suspect = False
        """Whether no request of the last burst was answered, and none since."""
        self._proven = 1
        """Largest window that was answered."""
        self._probe_size = 0
        """Requests of the burst that is under way."""
        self._probe_begin = 0
        self._probe_end = 0
        self._probe_ticks = 0
        """Duration of the last burst."""

    # ---------------------------------------------------------------- reading

    @property
    def is_lost(self) -> bool:
        """Whether the device sends no MODBUS any more."""
        return self._splitter.is_lost

    @property
    def has_waiting(self) -> bool:
        """Whether a signal waits to be requested."""
        return bool(self._queue)

    @property
    def is_idle(self) -> bool:
        """Whether nothing waits to be sent or answered."""
        return not self._queue and not self._flight

    @property
    def is_probing(self) -> bool:
        """Whether a burst is under way that is larger than any answered one."""
        return self._probe_size > 0

    @property
    def room(self) -> int:
        """Number of requests that could be sent now."""
        return self.window - len(self._flight)

    @property
    def single_requests(self) -> int:
        """Number of requests that wait to be sent once."""
        return sum(signal.is_once for signal in self._queue)

    @property
    def owed(self) -> list[ModbusSignal]:
        """Signals with outputs to write: queued, under way or sent to all slaves."""
        under_way = [signal for signal, _, _ in self._flight.values()]
        return [signal for signal in (*self._queue, *under_way, *self.broadcasts) if signal.is_owed]

    def is_under_way(self, signal: ModbusSignal) -> bool:
        """Return whether the present request of a signal waits for its answer."""
        return any(one is signal and request is signal.request for one, request, _ in self._flight.values())

    def next_tick(self, tick: int) -> int | None:
        """Return the earliest tick after `tick` at which something is due without an event."""
        if self._probe_size:
            return self._probe_end
        if self._queue and len(self._flight) < self.window:
            return tick + 1
        if self._flight:
            return next(iter(self._flight.values()))[2] + REPLY_TICKS
        return None

    # ---------------------------------------------------------------- turns

    def ask(self, signal: ModbusSignal) -> None:
        """Queue one request of a signal."""
        if not signal.is_waiting:
            signal.is_waiting = True
            self._queue.append(signal)

    def forget(self, signal: ModbusSignal) -> None:
        """Take a signal out of the queue; a request under way still waits for its answer."""
        if signal.is_waiting:
            signal.is_waiting = False
            self._queue.remove(signal)

    def press(self) -> None:
        """Note that a signal has missed its turn, so that a larger window is tried."""
        self._is_pressed = True

    def drop_once(self, reason: str) -> None:
        """Give up queued requests that are sent once: they do not wait for another connection."""
        for signal in [signal for signal in self._queue if signal.is_once]:
            self._lose(signal, said("not sent, {reason}", reason=reason))
            self._queue.remove(signal)

    # ---------------------------------------------------------------- the connection

    def begin(self, tick: int) -> None:
        """Begin on a new connection."""
        self._splitter = TcpSplitter()
        self._heard_tick = tick
        self._is_pressed = self.has_heard = False

    def end(self) -> None:
        """Give up what is under way, after the end of the connection."""
        for signal, _, _ in self._flight.values():
            if signal.is_once:
                self._lose(signal, "the connection was lost before the answer")
        self._flight.clear()
        self.broadcasts.clear()
        self._chained = None
        self._probe_size = 0

    def fall_back(self, *, is_certain: bool = True) -> None:
        """Return to one request at a time, and repeat what was not answered.

        Args:
            is_certain: whether it is known that the device takes no more.
        """
        self.is_single = self.is_single or is_certain
        self._is_suspect = not is_certain
        self.window = self._proven = 1
        self._probe_size = 0
        self._chained = None
        left = [signal for signal, _, _ in self._flight.values()]
        self._flight.clear()
        for signal in reversed(left):
            if not (signal.is_waiting or signal.is_removed):
                signal.is_waiting = True
                self._queue.appendleft(signal)

    def look_at_time(self, tick: int) -> bool:
        """Give up late answers; return whether the connection seems dead."""
        flight = self._flight
        if not flight:
            return False
        if self._probe_size:
            if tick >= self._probe_end:
                self.fall_back(is_certain=len(flight) < self._probe_size)
            return False
        late = [number for number, (_, _, sent) in flight.items() if tick >= sent + REPLY_TICKS]
        self._is_suspect = self._is_suspect and not late
        for number in late:
            signal = flight.pop(number)[0]
            if signal is self._chained:
                self._chained = None
            signal.fail(tick, NO_ERROR, TIMED_OUT)
            problem = said("no answer within {seconds:g} s", seconds=seconds(REPLY_TICKS))
            if signal.is_once:
                self._lose(signal, problem)
            else:
                self._report(signal, problem, is_late=True)
        return bool(late) and tick - self._heard_tick >= SILENCE_TICKS

    # ---------------------------------------------------------------- bytes

    def outgoing(self, tick: int, room: int) -> bytes:
        """Return as many requests as the window has room for, in one piece; none while a burst is under way.

        Args:
            tick: the present one.
            room: bytes that the connection takes.
        """
        queue, flight = self._queue, self._flight
        if not queue or self._probe_size:
            return b""
        window, transaction = self._window(tick), self._transaction
        parts: list[bytes] = []
        held: list[ModbusSignal] = []
        while queue and len(flight) < window:
            signal = queue.popleft()
            if signal.is_once and window > self._proven:
                # It must not be sent twice, so it takes no part in a burst.
                window = self._proven
                if len(flight) >= window:
                    held.append(signal)
                    break
            if signal.is_sequential and self._chained is not None:
                held.append(signal)
                continue
            if signal.unit == BROADCAST and signal.is_asking:
                # A read request to all slaves has no answer.
                signal.is_waiting = False
                signal.work(tick)
                continue
            tail = signal.tail
            room -= 2 + len(tail)
            if room < 0:
                held.append(signal)
                break
            transaction = transaction % 65535 + 1
            parts.append(transaction.to_bytes(2, "big"))
            parts.append(tail)
            signal.is_waiting = False
            self._turns += 1
            signal.turn = self._turns
            if signal.unit == BROADCAST:
                signal.work(tick)
                self.broadcasts.append(signal)
                if window == 1:
                    break
            else:
                flight[transaction] = signal, signal.request, tick
                if signal.is_sequential:
                    self._chained = signal
        queue.extendleft(reversed(held))
        self._transaction = transaction
        if len(flight) > self._proven:
            self._probe_size = len(flight)
            self._probe_begin = tick
            self._probe_end = tick + max(PROBE_TICKS, PROBE_ROUNDS * self._slowest_ticks)
        return b"".join(parts)

    def _window(self, tick: int) -> int:
        """Return how many requests may be under way in this tick."""
        if self.window == self._proven and not self._is_pressed:
            return self.window
        flight = self._flight
        # Turns missed because the device is silent are no reason for a larger window.
        is_prompt = not flight or tick - next(iter(flight.values()))[2] < self._slowest_ticks
        is_quick = self._probe_ticks <= SLOW_ROUNDS * self._quickest_ticks + SLOW_TICKS
        is_tame = self.is_single or self._is_suspect or not self.has_heard
        if self._is_pressed and is_prompt and is_quick and not is_tame and self.window == self._proven:
            self.window = min(WINDOW_MAX, 2 * self.window)
        self._is_pressed = False
        if not is_prompt or any(signal.is_once for signal, _, _ in flight.values()):
            return min(self.window, self._proven)
        return self.window

    def incoming(self, data: bytes, tick: int) -> None:
        """Take received bytes."""
        flight = self._flight
        for transaction, unit, pdu in self._splitter.feed(data):
            entry = flight.pop(transaction, None)
            if entry is None:
                self.strays += 1
                continue
            signal, request, sent = entry
            if request is signal.request:
                signal.is_owed = False
            if signal is self._chained:
                self._chained = None
            if tick - sent > self._slowest_ticks:
                self._slowest_ticks = tick - sent
            if tick - sent < self._quickest_ticks:
                self._quickest_ticks = tick - sent
            self._heard_tick = tick
            self.has_heard = True
            if self._is_suspect:
                self._is_suspect, self.is_single = False, True
            if unit != signal.unit:
                signal.fail(tick, UNDEFINED_ERROR, NO_ERROR)
                self._report(
                    signal,
                    said("slave {unit} has answered instead of {signal_unit}", unit=unit, signal_unit=signal.unit),
                )
            elif pdu == signal.answer and request is signal.request:
                self.answered += 1
                signal.ok_tick = tick
            elif problem := signal.take(request, pdu, tick):
                self._report(signal, problem)
            else:
                self.answered += 1
                if signal.custom:
                    self._note(signal, "received", f"slave {unit}: {pdu.hex(' ')}")
                elif request[0] in READS:
                    self._note(signal, "received", signal.shown(signal.inputs))
                else:
                    signal.noted = None
        if self._probe_size and not flight and not self._splitter.is_lost:
            self._proven = self._probe_size
            self._probe_size = 0
            self._probe_ticks = tick - self._probe_begin
