"""Plays sessions, in leaps or tick by tick, and says what of all that must hold does not."""

from __future__ import annotations

import traceback
from collections.abc import Callable
from contextlib import nullcontext
from hashlib import sha256
from itertools import pairwise
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from typing import Any

from elitescript import VirtualRobot
from elitescript.client.primary_messages import MessageReader
from elitescript.errors import CODES, ElitescriptError, InternalError, PeerError, ScriptError
from elitescript.kernel.kernel import Kernel
from elitescript.messages.enums import TaskState
from elitescript.messages.events import Alarm
from elitescript.messages.signals import KEPT
from elitescript.messages.timing import PERIOD_S, seconds
from elitescript.records import NamedTuple
from elitescript.run import Run
from tests.chaos import rare, rtsi_streams, scenes
from tests.chaos.sessions import TICKS, Act, Session
from tests.invariants.random_devices import random_fault
from tests.solids import every_tick

END_TICKS = TICKS + 300
"""Then a program that still runs is stopped."""
REST_S = 3.0
"""After which everything rests, *assumed*: the arm has braked, and what was sent has arrived or was given up."""

SPEED_TOLERANCE = 5e-3
JUMP_TOLERANCE = 0.1
"""Relative; Cartesian moves keep the limits at grid points and almost keep them between, and ramps add to it."""
SHIFTED_JUMP_TOLERANCE = 0.5
"""The same for moves that a program shifts; as `test_path_offset_invariants.py` has it."""
CONTACT_ROWS_MAX = 500
"""Rows of a run whose contacts are looked for in every period: the plain way takes long."""


class Broken(Exception):
    """Something that must hold does not; the text begins with its name."""


class Played(NamedTuple):
    """What came of a session."""

    record: tuple[Any, ...]
    """Everything that is the same for each play."""
    rows: Any
    ticks: int
    """Ticks that were run."""
    shows_hash_order: bool
    """Whether it may differ in a process with another hash seed."""


class Verdict(NamedTuple):
    """What is said of a session."""

    failure: str
    """What does not hold; empty if all does."""
    ticks: int = 0
    """That were run in the first play."""
    all_ticks: int = 0
    """That were run in all plays."""
    digest: str = ""
    """Of what the first play said; empty if a process with another hash seed may say something else."""


def verdict_of(session: Session) -> Verdict:
    """Play a session in leaps, then again in the way that is its own, and compare."""
    ticks: list[int] = []
    if session["kind"] in rare.KINDS:
        try:
            count_of = rare.KINDS[session["kind"]](session)
        except Exception as error:
            return Verdict(f"{session['kind']}: {_place(error)}")
        return Verdict("", count_of, 2 * count_of)

    def count(way: str) -> Played:
        played = play(session, way, checks=not ticks)
        ticks.append(played.ticks)
        return played

    try:
        first = count("leaps")
        other = count(session["way"])
        if (difference := _difference_of(first, other)) and session["way"] != "leaps":
            # What is not the same twice is not the way's fault.
            _same("the same again", _difference_of(first, count("leaps")))
            _same(f"in {session['way']}", difference)
        _same("the same again", difference)
    except Broken as broken:
        return Verdict(str(broken), ticks[0] if ticks else 0, sum(ticks))
    except Exception as error:
        return Verdict(f"exception: {_place(error)}", ticks[0] if ticks else 0, sum(ticks))
    return Verdict("", ticks[0], sum(ticks), _digest(first))


def digest_of(session: Session) -> str:
    """Play a session once; return the digest of what it said."""
    return _digest(play(session, "leaps", checks=False))


def _digest(played: Played) -> str:
    if played.shows_hash_order:
        return ""
    return sha256(repr(played.record).encode("utf-8", "backslashreplace")).hexdigest()


def _place(error: BaseException) -> str:
    """Return the kind of an exception and where it came from; it is the same for the same mistake."""
    frames = [frame for frame in traceback.extract_tb(error.__traceback__) if "/tests/" not in frame.filename]
    place = f" in {frames[-1].filename.rpartition('/elitescript/')[2]}:{frames[-1].lineno}" if frames else ""
    return f"{type(error).__name__}{place}: {error}"


def _same(name: str, difference: str) -> None:
    if difference:
        raise Broken(f"{name}: {difference}")


def _difference_of(first: Played, other: Played) -> str:
    """Return what differs first; empty if nothing does."""
    for what, a, b in zip(("state", "end", "outcomes", "received", "events"), first.record, other.record, strict=True):
        if a != b:
            return f"another {what}: {_difference(a, b)}"
    for a, b in zip(first.rows, other.rows, strict=True):
        if a != b:
            return f"another row: {next((i for i, (x, y) in enumerate(zip(a, b, strict=False)) if x != y), -1)}"
    return ""


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


def play(session: Session, way: str, *, checks: bool) -> Played:
    """Play a session.

    Args:
        session: what is done.
        way: how time goes, `leaps` or one of `WAYS` of the sessions.
        checks: whether what must hold of one play is looked at.

    Raises:
        Broken: something does not hold.
    """
    needs_files = {"things", "remembers"} & set(session["options"])
    with _CountingKernel() as counting, TemporaryDirectory() if needs_files else nullcontext("") as folder:
        player = _Player(session, way, Path(folder))
        player.play()
        if checks:
            player.check()
        return Played(player.record(), player.rows(), counting.ticks, player.shows_hash_order)


class _Player:
    def __init__(self, session: Session, way: str, folder: Path) -> None:
        self._session = session
        self._folder = folder
        self._pace: Callable[[int], None] | None = (lambda tick: None) if way == "steps" else None
        cuts = Random(f"cuts {session['seed']}")
        self._cuts = sorted(cuts.randrange(END_TICKS) for _ in range(cuts.choice((3, 30)))) if way == "pieces" else []
        self.robot, self.world = scenes.robot_of(session, folder)
        self.home = self.robot.state.q_target
        self.outcomes: list[str] = []
        self.clients: dict[int, Any] = {}
        self.ports: dict[int, str] = {}
        self.sent: dict[int, bytearray] = {}
        self.received: dict[int, bytearray] = {}
        self.runs: list[Run] = []

    @property
    def shows_hash_order(self) -> bool:
        """Whether a program may show the order of a set."""
        return any(run.unit.shows_hash_order for run in self.runs)

    def play(self) -> None:
        """Do everything."""
        self._try(lambda: self._do_start(self._session["program"]))
        for act in self._session["acts"]:
            self._advance(act[0])
            self._try(lambda act=act: self._do(act))
            self._receive()
        self._advance(END_TICKS)
        self._rest()
        self._receive()

    def _do_start(self, program: str) -> None:
        self.runs.append(self.robot.start(program, trace=True, trace_signals="standard_digital_out"))

    def _advance(self, tick: int) -> None:
        while self._cuts and self._cuts[0] <= tick:
            self._advance_to(self._cuts.pop(0))
        self._advance_to(tick)

    def _advance_to(self, tick: int) -> None:
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

    def _do_input_fault(self, kind: str, name: str, settings: dict[str, Any]) -> None:
        self.robot.fault(kind, on=name, **settings)

    def _do_end_faults(self) -> None:
        if self.world is not None:
            self.world.end_faults()

    def _do_schedule(self, time_s: float, name: str, value: Any) -> None:
        self.robot.at(time_s, name, value)

    def _do_connect(self, number: int, port: str) -> None:
        self.clients[number] = self.robot.connect(port)
        self.ports[number] = port
        self.sent[number] = bytearray()
        self.received[number] = bytearray()

    def _do_send(self, number: int, data: str) -> None:
        if number in self.clients:
            self.clients[number].send(bytes.fromhex(data))
            self.sent[number] += bytes.fromhex(data)

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
        for index in range(6):
            self.robot.signals[f"external_wrench[{index}]"] = 0.0
        for index in range(2):
            self.robot.signals[f"encoder_speed[{index}]"] = 0.0
        self.robot.set_speed(1.0)
        for _ in range(2):
            self._try(self.robot.stop)
            self.robot.advance(REST_S / 2, pace=self._pace)

    def check(self) -> None:
        """Look whether everything holds that must."""
        robot = self.robot
        if self.runs and self.runs[-1].state == "":
            raise Broken("it never ends")
        if robot.controller.task_state is not TaskState.STOPPED:
            raise Broken(f"something runs at the end: {robot.controller.task_state}")
        if threads := robot.threads():
            raise Broken(f"threads are left: {threads}")
        if any(robot.state.qd_target):
            raise Broken(f"the arm moves at the end: {robot.state.qd_target}")
        for run in self.runs:
            for event in run.events:
                if isinstance(event, Alarm) and event.code not in CODES:
                    raise Broken(f"an alarm without a code: {event}")
            self._check_motion(run)
        for number, data in self.received.items():
            self._check_stream(number, bytes(data))
        self._check_contacts()
        self._check_remembered()

    def _check_contacts(self) -> None:
        """Compare the contacts of the first run with those of every period."""
        path = self._folder / scenes.WORLD_FILE
        if (
            not self.runs
            or "things" not in self._session["options"]
            or not 0 < len(self.runs[0].trace) <= CONTACT_ROWS_MAX
        ):
            return
        try:
            every_tick.check(self.runs[0], self.home, path, self.robot.model)
        except AssertionError as error:
            raise Broken(f"contacts: other than those of every tick: {str(error)[:2000]}") from None

    def _check_remembered(self) -> None:
        """Look whether a robot that is switched on again has what it remembers."""
        if "remembers" not in self._session["options"]:
            return
        other = VirtualRobot(self.robot.model, state_file=self._folder / scenes.STATE_FILE)
        for name in KEPT:
            was, now = (list(its.controller.signals.levels(name)) for its in (self.robot, other))
            if was != now:
                raise Broken(f"another level after a restart: {name}: {was} | {now}")

    def _check_stream(self, number: int, data: bytes) -> None:
        """What a client of the product cannot read is wrong."""
        port = self.ports[number]
        try:
            if port in ("primary", "secondary", "readonly"):
                MessageReader().feed(data)
            elif port == "rtsi":
                rtsi_streams.check(bytes(self.sent[number]), data)
            elif port == "dashboard":
                data.decode()
        except (PeerError, UnicodeDecodeError) as error:
            raise Broken(f"bytes of port {port} cannot be read: {error}") from None
        except rtsi_streams.Lost as lost:
            raise Broken(f"rtsi: packages are lost: {lost}") from None

    def _check_motion(self, run: Run) -> None:
        joints = self.robot.model.joints
        tolerance = SHIFTED_JUMP_TOLERANCE if self._session["kind"] == "shifts" else JUMP_TOLERANCE
        jumps = [0.5 * joint.qdd_max * PERIOD_S**2 * (1.0 + tolerance) for joint in joints]
        rows = list(run.trace)
        for row in rows:
            for q, w, joint in zip(row.q, row.qd, joints, strict=True):
                if not joint.q_min - 1e-9 <= q <= joint.q_max + 1e-9:
                    raise Broken(f"motion: a joint beyond its range: at {row.t} s, {q}")
                if not abs(w) <= joint.qd_max * (1.0 + SPEED_TOLERANCE):
                    raise Broken(f"motion: a joint beyond its speed: at {row.t} s, {w}")
        for row, later in pairwise(rows):
            if row.q is later.q:
                continue
            for q, w, q_later, w_later, most in zip(row.q, row.qd, later.q, later.qd, jumps, strict=True):
                jump = abs(q_later - q - 0.5 * (w + w_later) * PERIOD_S)
                if not jump <= most:
                    raise Broken(f"motion: the target jumps: at {later.t} s by {jump} rad, line {later.line}")

    def record(self) -> tuple[Any, ...]:
        """Return what is the same for each play."""
        return (
            repr([(run.state, run.contacts, run.clearances) for run in self.runs]),
            repr(self.robot.state),
            self.outcomes,
            {number: bytes(data) for number, data in self.received.items()},
            [repr(event) for run in self.runs for event in run.events],
        )

    def rows(self) -> Any:
        """Return the rows of the traces."""
        return [run.trace for run in self.runs]
