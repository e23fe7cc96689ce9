"""Plays sessions, in leaps or tick by tick, and says what of all that must hold does not."""

from __future__ import annotations

import traceback
from collections.abc import Callable
from itertools import pairwise
from random import Random
from typing import Any

from elitescript import PlantConfig, VirtualRobot
from elitescript.client.primary_messages import MessageReader
from elitescript.client.rtsi_messages import FrameReader
from elitescript.errors import CODES, ElitescriptError, InternalError, PeerError, ScriptError
from elitescript.kernel.kernel import Kernel
from elitescript.messages.enums import TaskState
from elitescript.messages.events import Alarm
from elitescript.messages.timing import PERIOD_S, seconds
from elitescript.models.model import RobotModel, load_model
from elitescript.records import NamedTuple
from elitescript.runtime.environment import EmptyEnvironment
from tests.chaos import rare
from tests.chaos.sessions import TICKS, Act, Session
from tests.invariants.random_devices import RPC_S, random_fault, random_world

END_TICKS = TICKS + 300
"""Then a program that still runs is stopped."""
REST_S = 3.0
"""After which everything rests, *assumed*: the arm has braked, and what was sent has arrived or was given up."""

SPEED_TOLERANCE = 2e-3
JUMP_TOLERANCE = 0.06


class Broken(Exception):
    """Something that must hold does not; the text begins with its name."""


class Played(NamedTuple):
    """What came of a session."""

    record: tuple[Any, ...]
    """Everything that is the same for each play."""
    rows: Any
    ticks: int
    """Ticks that were run."""


MODELS: dict[str, RobotModel] = {}


def failure_of(session: Session) -> tuple[str, int, int]:
    """Return what does not hold, empty if all does; ticks that were run in the first play, and in all of them."""
    ticks: list[int] = []
    if session["kind"] in rare.KINDS:
        try:
            count_of = rare.KINDS[session["kind"]](session)
        except Exception as error:
            return f"{session['kind']}: {_place(error)}", 0, 0
        return "", count_of, 2 * count_of

    def count(steps: bool) -> Played:
        played = play(session, steps=steps)
        ticks.append(played.ticks)
        return played

    try:
        first = count(False)
        again = count(False)
        _same("the same again", first, again)
        _same("every tick", first, count(True))
    except Broken as broken:
        return str(broken), ticks[0] if ticks else 0, sum(ticks)
    except Exception as error:
        return f"exception: {_place(error)}", ticks[0] if ticks else 0, sum(ticks)
    return "", ticks[0], sum(ticks)


def _place(error: BaseException) -> str:
    """Return the kind of an exception and where it came from; it is the same for the same mistake."""
    frames = [frame for frame in traceback.extract_tb(error.__traceback__) if "/tests/" not in frame.filename]
    place = f" in {frames[-1].filename.rpartition('/elitescript/')[2]}:{frames[-1].lineno}" if frames else ""
    return f"{type(error).__name__}{place}: {error}"


def _same(name: str, first: Played, other: Played) -> None:
    for what, a, b in zip(("state", "end", "outcomes", "received", "events"), first.record, other.record, strict=True):
        if a != b:
            raise Broken(f"{name}: another {what}, {_difference(a, b)}")
    if first.rows != other.rows:
        at = next((index for index, (a, b) in enumerate(zip(first.rows, other.rows, strict=False)) if a != b), -1)
        raise Broken(f"{name}: another row: {at}")


def _difference(a: Any, b: Any) -> str:
    """Return the first difference, behind the kind of what differs."""
    if isinstance(a, dict):
        number = next(key for key in a if a[key] != b.get(key))
        at = next((i for i, (x, y) in enumerate(zip(a[number], b[number], strict=False)) if x != y), -1)
        return f"bytes: of client {number} at {at}: {a[number][at : at + 80]!r} | {b[number][at : at + 80]!r}"
    if isinstance(a, list):
        at = next((i for i, (x, y) in enumerate(zip(a, b, strict=False)) if x != y), min(len(a), len(b)))
        one, two = ((items[at : at + 1] or ["nothing"])[0] for items in (a, b))
        return f"{one.partition('(')[0]}, {two.partition('(')[0]}: at {at}: {one[:300]} | {two[:300]}"
    return f"{a[:300]} | {b[:300]}"


class _CountingKernel:
    """Counts the ticks that kernels run, while it is entered."""

    def __enter__(self) -> _CountingKernel:
        self.ticks = 0
        self._run_tick = run_tick = Kernel.run_tick

        def counted(kernel: Kernel) -> Any:
            self.ticks += 1
            return run_tick(kernel)

        Kernel.run_tick = counted  # type: ignore[method-assign]
        return self

    def __exit__(self, *_: object) -> None:
        Kernel.run_tick = self._run_tick  # type: ignore[method-assign]


def play(session: Session, *, steps: bool) -> Played:
    """Play a session.

    Raises:
        Broken: something does not hold.
    """
    with _CountingKernel() as counting:
        player = _Player(session, steps=steps)
        player.play()
    return Played(player.record(), player.rows(), counting.ticks)


class _Player:
    def __init__(self, session: Session, *, steps: bool) -> None:
        self._session = session
        self._pace: Callable[[int], None] | None = (lambda tick: None) if steps else None
        options = dict(session["options"])
        name = options.pop("model", "CS66")
        model = MODELS.get(name) or MODELS.setdefault(name, load_model(name))
        if "lag_s" in options or "noise_rad" in options:
            options["plant"] = PlantConfig(
                **{key: options.pop(key) for key in ("lag_s", "noise_rad") if key in options}, seed=1
            )
        self.world = None
        if session["kind"] == "talk":
            self.world = random_world(Random(f"world {session['seed']}"), session["seed"])
            options |= {"rpc_timeout_s": RPC_S, "firmware": "2.14"}
        self.robot = VirtualRobot(model, world=self.world or EmptyEnvironment(), **options)
        self.is_ideal = "plant" not in options
        self.outcomes: list[str] = []
        self.clients: dict[int, Any] = {}
        self.ports: dict[int, str] = {}
        self.received: dict[int, bytearray] = {}
        self.run: Any = None

    def play(self) -> None:
        """Do everything."""
        self._try(lambda: self._start())
        for act in self._session["acts"]:
            self._advance(act[0])
            self._try(lambda act=act: self._do(act))
            self._receive()
        self._advance(END_TICKS)
        self._rest()
        self._receive()
        self._check()

    def _start(self) -> None:
        self.run = self.robot.start(self._session["program"], trace=True, trace_signals="standard_digital_out")

    def _advance(self, tick: int) -> None:
        if tick > self.robot.tick:
            self.robot.advance(seconds(tick - self.robot.tick), pace=self._pace)

    def _try(self, act: Callable[[], None]) -> None:
        """Do something that may be refused, in the documented way."""
        try:
            act()
            self.outcomes.append("done")
        except InternalError:
            raise
        except (ElitescriptError, ScriptError, ConnectionError) as error:
            self.outcomes.append(f"{type(error).__name__}: {error}")

    def _do(self, act: Act) -> None:
        _, name, *arguments = act
        getattr(self, f"_do_{name.replace(' ', '_')}")(*arguments)

    def _do_pause(self) -> None:
        self.robot.pause()

    def _do_resume(self) -> None:
        self.robot.resume()

    def _do_stop(self) -> None:
        self.robot.stop()

    def _do_slider(self, fraction: float) -> None:
        self.robot.set_speed(fraction)

    def _do_signal(self, name: str, value: Any) -> None:
        self.robot.signals[name] = value

    def _do_protective_stop(self) -> None:
        self.robot.protective_stop("chaos")

    def _do_unlock(self) -> None:
        self.robot.unlock_protective_stop()

    def _do_restart_safety(self) -> None:
        self.robot.restart_safety()

    def _do_secondary(self, text: str) -> None:
        self.robot.submit_secondary(text)

    def _do_device_fault(self, number: int) -> None:
        if self.world is not None:
            self.world.add_fault(random_fault(Random(number), self.world.agenda.time_s))

    def _do_connect(self, number: int, port: str) -> None:
        self.clients[number] = self.robot.connect(port)
        self.ports[number] = port
        self.received[number] = bytearray()

    def _do_send(self, number: int, data: str) -> None:
        if number in self.clients:
            self.clients[number].send(bytes.fromhex(data))

    def _do_close(self, number: int) -> None:
        if number in self.clients:
            self.clients[number].close()

    def _receive(self) -> None:
        for number, client in self.clients.items():
            self.received[number] += client.receive()

    # ---------------------------------------------------------------- the end

    def _rest(self) -> None:
        """End what still runs: clients go, stops are released, the task is stopped."""
        for client in self.clients.values():
            self._receive()
            client.close()
        for name in ("safeguard_stop", "emergency_stop", "system_emergency_stop"):
            self.robot.signals[name] = False
        self.robot.signals["external_wrench[0]"] = 0.0
        self.robot.set_speed(1.0)
        for _ in range(2):
            self._try(self.robot.stop)
            self.robot.advance(REST_S / 2, pace=self._pace)

    def _check(self) -> None:
        robot, run = self.robot, self.run
        if run is not None and run.state == "":
            raise Broken("it never ends")
        if robot.controller.task_state is not TaskState.STOPPED:
            raise Broken(f"something runs at the end: {robot.controller.task_state}")
        if threads := robot.threads():
            raise Broken(f"threads are left: {threads}")
        if any(robot.state.qd_target):
            raise Broken(f"the arm moves at the end: {robot.state.qd_target}")
        for event in [] if run is None else run.events:
            if isinstance(event, Alarm) and event.code not in CODES:
                raise Broken(f"an alarm without a code: {event}")
        for number, data in self.received.items():
            self._check_stream(self.ports[number], bytes(data))
        if run is not None:
            self._check_motion()

    def _check_stream(self, port: str, data: bytes) -> None:
        """What a client of the product cannot read is wrong."""
        try:
            if port in ("primary", "secondary", "readonly"):
                MessageReader().feed(data)
            elif port == "rtsi":
                FrameReader().feed(data)
            elif port == "dashboard":
                data.decode()
        except (PeerError, UnicodeDecodeError) as error:
            raise Broken(f"bytes of port {port} cannot be read: {error}") from None

    def _check_motion(self) -> None:
        joints = self.robot.model.joints
        rows = list(self.run.trace)
        for row in rows:
            for q, w, joint in zip(row.q, row.qd, joints, strict=True):
                if not joint.q_min - 1e-9 <= q <= joint.q_max + 1e-9:
                    raise Broken(f"a joint beyond its range at {row.t} s: {q}")
                if not abs(w) <= joint.qd_max * (1.0 + SPEED_TOLERANCE):
                    raise Broken(f"a joint beyond its speed at {row.t} s: {w}")
        for row, later in pairwise(rows):
            for q, w, q_later, w_later, joint in zip(row.q, row.qd, later.q, later.qd, joints, strict=True):
                jump = abs(q_later - q - 0.5 * (w + w_later) * PERIOD_S)
                if not jump <= 0.5 * joint.qdd_max * PERIOD_S**2 * (1.0 + JUMP_TOLERANCE):
                    raise Broken(f"the target jumps at {later.t} s: {jump} rad")

    def record(self) -> tuple[Any, ...]:
        """Return what is the same for each play."""
        run = self.run
        return (
            "" if run is None else run.state,
            repr(self.robot.state),
            self.outcomes,
            {number: bytes(data) for number, data in self.received.items()},
            [] if run is None else list(map(repr, run.events)),
        )

    def rows(self) -> Any:
        """Return the rows of the trace."""
        return [] if self.run is None else self.run.trace
