"""Lockstep: time waits for the clients of the RTSI port.

A client takes part from its first input package (`U`) after the start of its packages (`S`) on, until it pauses (`P`),
ends its connection or goes. Robot time then advances only while every such client has answered the last data package
that it got by an input package, of any of its recipes. So between two packages of a client lies exactly one answer of
that client; with a recipe of 125 Hz the robot makes two ticks for each answer. As fast as the clients answer, as fast
does time pass.

- Clients that have not sent an input yet, or that get no packages, are not asked. Time does not wait for them, but
  while one that gets packages is behind with reading them, so that no package is left out.
- A client that time has waited for `timeout_s` is let go, with a line in the log: time goes on without it, and it takes
  part again from its next input package on. Without this bound a client that answers only now and then (the vendor's
  `RtsiIOInterface` sends nothing unless a value was set since the last package) would stop time for ever.
- Each time that a client is let go, it is waited for a quarter as long from then on, a control period at least; once it
  has answered `TRUSTED_ANSWERS` packages one after the other, as long as at first. So a client that answers some of its
  packages costs less than a second once, and time passes for it about as on the wall.
- While no client takes part, time passes as on the wall: power can be switched and programs loaded.
- Everything else (dashboard, primary port, sockets of programs) goes on, measured in robot time.

From a client's answer to its next package there is no turn of the event loop, unless the loop has something to do: the
client that time waits for is read directly (`services.clients.direct`) while it answers within `DIRECT_MS`. Ticks in
which nothing is due are leapt over, which gives the same as if they ran.
"""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable, Mapping
from typing import Final

from elitescript.messages.timing import PERIOD_S, TICKS_PER_S
from elitescript.protocol.rtsi.connection import RtsiConnection
from elitescript.records import NamedTuple
from elitescript.services.clients.direct import DirectReading
from elitescript.services.clients.tcp import Client
from elitescript.services.log import ServerLog
from elitescript.services.time.cycle import LEAP_MAX_TICKS
from elitescript.services.time.paced import PacedTime
from elitescript.services.time.prompt import PromptFuture

TIMEOUT_S: Final = 0.5
"""How long time waits for a client by default (*assumed*). The vendor's C++ client gives up its connection when it has
got no package for 1 s."""
PATIENCE_FACTOR: Final = 0.25
"""By which the time is shorter after each package that a client has not answered (*assumed*)."""
PATIENCE_MIN_S: Final = PERIOD_S
"""Shortest of these times."""
TRUSTED_ANSWERS: Final = TICKS_PER_S
"""Answers one after the other after which a client is waited for as at first."""
STEP_MAX_S: Final = 5 * PERIOD_S
"""What counts of the time between two looks at the clients: while this process was stopped no client could answer."""
REPORT_S: Final = 10.0
"""Wall time within which the log names the same client once."""
DIRECT_MS: Final = 1
"""How long the answer of a client is waited for with nothing else served but sockets."""
TURN_S: Final = PERIOD_S / 2
"""Wall time after which the event loop gets a turn in any case."""


class Gate(NamedTuple):
    """Whether time may go on."""

    is_open: bool
    has_participants: bool
    waits_for: str
    """Origin of a client that time waits for; empty if there is none."""


_UNASKED = Gate(True, False, "")
_OPEN = Gate(True, True, "")


class Lockstep:
    """Knows which clients of one robot's RTSI port time waits for, and how long.

    Args:
        clients: of the port, by origin; read at every call.
        note: receives a line of the log and the origin of its client.
        timeout_s: wall time after which a client is let go, s; infinite for never.
    """

    __slots__ = (
        "_clients",
        "_let_go",
        "_note",
        "_passed",
        "_patience_s",
        "_quiet_s",
        "_tick",
        "_timeout_s",
        "_waited_s",
    )

    def __init__(
        self, clients: Mapping[str, Client], note: Callable[[str, str], None], timeout_s: float = TIMEOUT_S
    ) -> None:
        self._clients = clients
        self._note = note
        self._timeout_s = timeout_s
        self._tick = -1
        self._waited_s: dict[str, float] = {}
        """How long time has waited for a client at this tick."""
        self._patience_s: dict[str, float] = {}
        """How long time waits for clients that were let go."""
        self._passed: set[str] = set()
        """Clients behind with reading that time does not wait for any more."""
        self._quiet_s: dict[str, float] = {}
        """How long the log does not name a client again."""
        self._let_go: dict[str, int] = {}
        """How often it was let go in that time."""

    def gate(self) -> Gate:
        """Return whether time may go on now."""
        has_participants = False
        behind = ""
        for origin, client in self._clients.items():
            connection = client.connection
            if client.is_leaving or not isinstance(connection, RtsiConnection):
                continue
            if connection.answers:
                has_participants = True
                if client.owes_input:
                    return Gate(False, True, origin)
            if client.is_behind and connection.is_streaming and origin not in self._passed:
                behind = origin
        if not has_participants:
            return _UNASKED
        return Gate(False, True, behind) if behind else _OPEN

    def watch(self, tick: int, elapsed_s: float) -> bool:
        """Let clients go that time has waited for too long; return whether there was one.

        Args:
            tick: the last one; time that has gone on since the last call has waited for no client.
            elapsed_s: wall time since the last call, s.
        """
        step_s = min(elapsed_s, STEP_MAX_S)
        self._tell(elapsed_s)
        if tick != self._tick:
            self._tick = tick
            self._waited_s.clear()
            step_s = 0.0
        for origin in self._patience_s.keys() - self._clients.keys():
            del self._patience_s[origin]
        self._passed = {origin for origin in self._passed if self._is_behind(origin)}
        is_let_go = False
        while not (found := self.gate()).is_open:
            origin = found.waits_for
            waited_s = self._waited_s[origin] = self._waited_s.get(origin, 0.0) + step_s
            if waited_s < self._timeout_of(origin):
                break
            is_let_go = True
            self._release(origin)
        return is_let_go

    def _timeout_of(self, origin: str) -> float:
        connection = self._clients[origin].connection
        assert isinstance(connection, RtsiConnection)
        if connection.answers > TRUSTED_ANSWERS:
            self._patience_s.pop(origin, None)
        return self._patience_s.get(origin, self._timeout_s)

    def _is_behind(self, origin: str) -> bool:
        client = self._clients.get(origin)
        return client is not None and client.is_behind

    def _release(self, origin: str) -> None:
        client = self._clients[origin]
        connection = client.connection
        assert isinstance(connection, RtsiConnection)
        waited_s, more = self._timeout_s, ""
        if connection.answers and client.owes_input:
            waited_s = self._timeout_of(origin)
            self._patience_s[origin] = max(PATIENCE_FACTOR * waited_s, min(PATIENCE_MIN_S, self._timeout_s))
            connection.forget_answers()
            what = "has not answered a package"
            more = "; after that it is waited for a quarter as long"
        else:
            self._passed.add(origin)
            what = "has not read its packages"
        if origin in self._quiet_s:
            self._let_go[origin] = self._let_go.get(origin, 0) + 1
            return
        self._quiet_s[origin] = REPORT_S
        text = f"{origin} {what} for {waited_s:g} s: time goes on without it until its next input package{more}"
        self._note(text, origin)

    def _tell(self, elapsed_s: float) -> None:
        """Write how often a client was let go since the log named it last."""
        for origin in list(self._quiet_s):
            self._quiet_s[origin] -= elapsed_s
            if self._quiet_s[origin] > 0.0:
                continue
            del self._quiet_s[origin]
            if count := self._let_go.pop(origin, 0):
                self._note(f"{origin} was let go {count} times more within {REPORT_S:g} s", origin)


class LockstepTime(PacedTime):
    """Says when the next tick begins: when the RTSI clients that take part have answered.

    Args:
        log: takes the names of clients that are let go.
        on_left_out: see `PacedTime`.
        clients: of the RTSI port, by origin; read at every call.
        complete: called before the event loop gets a turn: makes the snapshot of the last tick whole.
        relieve: called once in a period of the wall clock, with the origin of the client that time waits for: reads
            clients on.
        timeout_s: see `Lockstep`.
    """

    __slots__ = (
        "_clients",
        "_complete",
        "_direct",
        "_gate",
        "_news",
        "_passed",
        "_relief",
        "_relieve_clients",
        "_relieved_s",
        "_turn_s",
        "_waits_for",
    )

    def __init__(
        self,
        log: ServerLog,
        on_left_out: Callable[[int], None],
        clients: Mapping[str, Client],
        complete: Callable[[], None],
        relieve: Callable[[str], None],
        timeout_s: float = TIMEOUT_S,
    ) -> None:
        super().__init__(log, on_left_out)
        self._gate = Lockstep(
            clients, lambda text, origin: log.note("let_go", text, is_problem=True, origin=origin), timeout_s
        )
        self._clients = clients
        self._complete = complete
        self._relieve_clients = relieve
        self._news: PromptFuture | None = None
        """Waits for a reason to look at the clients again."""
        loop = asyncio.get_running_loop()
        self._direct = DirectReading()
        self._turn_s = 0.0
        """When it has had a turn last."""
        self._passed = 0
        """Ticks that went by on the wall since the last one, before a client took part."""
        self._waits_for = ""
        self._relieved_s = loop.time()
        self._relief = loop.call_soon(self._relieve)

    @property
    def lag_ticks(self) -> int:
        """None: clients wait as the robot does."""
        return 0

    @property
    def waits_for(self) -> str:
        return self._waits_for

    @property
    def passed(self) -> int:
        return self._passed + self._cycle.passed

    @property
    def is_standing(self) -> bool:
        """Whether time waits for a client, and the event loop goes on."""
        return self._news is not None

    async def next(
        self, ticks_on: Callable[[], int | None], *, has_outlet: bool, is_known: Callable[[], bool] = lambda: False
    ) -> int:
        """Return when the next tick begins.

        While time goes by the clients, ticks are leapt over as soon as it may go on.

        Args:
            ticks_on: see `PacedTime.next`.
            has_outlet: not used: what a tick gives leaves at once.
            is_known: not used: no tick is waited for.
        """
        had_turn = False
        while True:
            found = self._gate.gate()
            self._waits_for = found.waits_for
            if not found.has_participants:
                self._direct.release()
                gone_on = await self._cycle.next(1 if self._passed else ticks_on())
                if not self._gate.gate().has_participants:
                    return self._go_on(gone_on)
                # Time waits for the client that takes part now; what came before it has passed.
                self._passed += gone_on - 1
                continue
            self._cycle.restart()
            if not had_turn and (self._direct.is_loop_due or time.monotonic() - self._turn_s >= TURN_S):
                await self._turn()
                had_turn = True
            elif found.is_open:
                return self._go_on(1 if self._passed else ticks_on())
            else:
                had_turn = False
                if not self._direct.read(self._clients[found.waits_for], DIRECT_MS):
                    await self._stand()

    def wake(self) -> None:
        """Look again whether time may go on: a client has sent something, has read, or goes."""
        self.make_due()
        self._look_again()

    def make_due(self) -> int:
        # While time goes by the clients, what is due is found when it goes on.
        return self._passed + self._cycle.make_due()

    def close(self) -> None:
        self._relief.cancel()
        super().close()

    def _go_on(self, ticks: int | None) -> int:
        """Return how many ticks on the next one is from the last that has run."""
        passed, self._passed = self._passed, 0
        return passed + min(ticks or LEAP_MAX_TICKS, LEAP_MAX_TICKS)

    def _look_again(self) -> None:
        """Look at the clients again, if that is waited for."""
        if self._news is not None and not self._news.done():
            self._news.set_result(None)

    async def _turn(self) -> None:
        """Let the event loop look for what has come, which is the first of its rounds, and hand it on."""
        self._leave_direct()
        await asyncio.sleep(0)
        await asyncio.sleep(0)
        self._turn_s = time.monotonic()

    def _leave_direct(self) -> None:
        """Prepare a turn of the event loop."""
        self._complete()
        self._direct.release()

    async def _stand(self) -> None:
        """Return when there is a reason to look at the clients again."""
        self._leave_direct()
        self._news = PromptFuture()
        try:
            await self._news
        finally:
            self._news = None
        self._turn_s = time.monotonic()

    def _relieve(self) -> None:
        self._relieve_clients(self._waits_for)
        loop = asyncio.get_running_loop()
        before_s, self._relieved_s = self._relieved_s, loop.time()
        if self._gate.watch(self._log.tick, self._relieved_s - before_s):
            self._look_again()
        self._relief = loop.call_later(PERIOD_S, self._relieve)
