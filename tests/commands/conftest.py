"""A robot without a controller: it answers from fields and records what commands ask of it."""

from __future__ import annotations

import random
from collections.abc import Callable
from math import pi
from typing import Any

import pytest

from elitescript.commands.catalogue import CATALOGUE
from elitescript.commands.definition.context import Rule
from elitescript.commands.definition.plausibility import mistaken
from elitescript.errors import InvalidValueError, ScriptError
from elitescript.kinematics.arm import Arm
from elitescript.kinematics.transforms import compose, pose_from_transform, transform_from_pose
from elitescript.messages.machine import WriteSignal
from elitescript.messages.motion import MicroLine, Six
from elitescript.messages.path_offset import OffsetFrame
from elitescript.messages.profile import Profile, profile
from elitescript.messages.signals import SIGNALS, Value
from elitescript.messages.state import ZERO_SIX, JointState, Payload, Poses, TcpSpeeds

CS66 = Arm(0.1625, -0.427, -0.3905, 0.1475, 0.0965, 0.092)
Q_ACTUAL: Six = (0.1, -1.2, 1.3, -1.6, -1.5, 0.2)
Q_TARGET: Six = (0.11, -1.21, 1.31, -1.61, -1.51, 0.21)


class FakeMachine:
    """The machine that a command sees; a test sets its fields."""

    def __init__(self) -> None:
        self.tick = 0
        self.arm = CS66
        self.joint_ranges: tuple[tuple[float, float], ...] = ((-2 * pi, 2 * pi),) * 6
        self.payload_max_kg = 6.0
        self.default_motion = (1.5, 1.1, 1.3, 0.3)
        self.tcp_offset: Six = ZERO_SIX
        self.payload = Payload(1.5, (0.01, 0.02, 0.03))
        self.target_waypoint: Six = (0.4, 0.1, 0.3, 0.0, 1.0, 0.0)
        self.joint_temperatures: Six = (31.0, 32.0, 33.0, 34.0, 35.0, 36.0)
        self.controller_temperature = 41.5
        self.image: dict[tuple[str, int], Value] = {}
        self.port_registers: dict[int, int] = {}
        self.port_coils: dict[int, bool] = {}
        self.tested: list[tuple[Six, Any]] = []

    def joints(self) -> JointState:
        return JointState(Q_TARGET, (0.2,) * 6, Q_ACTUAL, (0.1,) * 6)

    def is_within_safety_limits(self, q: Six, pairs: Any = None) -> bool:
        self.tested.append((q, pairs))
        return q[0] < 1.0

    def joint_torques(self) -> Six:
        return (0.1, -20.5, 8.25, 0.5, -0.25, 0.0)

    def tcp_wrench(self, is_compensated: bool) -> Six:
        return (3.0, 4.0, 12.0, 0.1, 0.2, 0.3) if is_compensated else (3.5, 4.5, 12.5, 0.1, 0.2, 0.3)

    def path_offset_along(self, frame: OffsetFrame) -> Six:
        return (0.001 * frame, 0.0, 0.0, 0.0, 0.0, 0.0)

    def tcp_pose_along_path(self) -> Six:
        return (0.4, 0.1, 0.2, 3.0, 0.0, 0.0)

    def poses(self) -> Poses:
        flange = self.arm.forward(Q_ACTUAL)
        offset = transform_from_pose(self.tcp_offset)
        return Poses(
            pose_from_transform(compose(self.arm.forward(Q_TARGET), offset)),
            pose_from_transform(compose(flange, offset)),
            pose_from_transform(flange),
        )

    def tcp_speeds(self) -> TcpSpeeds:
        return TcpSpeeds((0.01, 0.02, 0.03, 0.04, 0.05, 0.06), (0.1, 0.2, 0.3, 0.4, 0.5, 0.6))

    def read(self, name: str, index: int = 0) -> Value:
        return self.image.get((name, index), SIGNALS[name].default)

    def port_register(self, address: int, version: tuple[int, ...]) -> int:
        return version[address - 63] if 63 <= address <= 65 else self.port_registers.get(address, 0)

    def port_coil(self, address: int) -> bool:
        return self.port_coils.get(address, False)

    def tool_pin(self, index: int) -> bool:
        return bool(self.read("tool_digital_in", index))

    def encoder_count(self, index: int) -> float:
        return 864.0 + index

    def encoder_unwound(self, index: int, delta: float) -> float:
        return delta + 65536.0

    def timestamp_s(self) -> float:
        return 1704067200.0 + self.tick * 0.004


class FakeSockets:
    """Connections that stand unless a test says otherwise.

    Attributes:
        received: what a read finds, for every name.
        asked: every call, in order.
    """

    def __init__(self) -> None:
        self.stands = True
        self.received = bytearray()
        self.asked: list[tuple[Any, ...]] = []

    def open(self, address: str, port: int, name: str) -> bool:
        self.asked.append(("open", address, port, name))
        return self.stands

    def close(self, name: str) -> None:
        self.asked.append(("close", name))

    def is_connected(self, name: str) -> bool:
        self.asked.append(("is_connected", name))
        return self.stands

    def send(self, name: str, data: bytes, *, is_text: bool = False) -> bool:
        self.asked.append(("send", name, data))
        return self.stands

    def ask(self, name: str, question: bytes, rule: Any, timeout_s: float) -> int:
        return int(self.read(name, rule, timeout_s)) if self.send(name, question) else 0

    def read(self, name: str, rule: Rule, timeout_s: float) -> Any:
        self.asked.append(("read", name, timeout_s))
        value, used = rule(self.received, True)
        del self.received[:used]
        return value


class FakeLines:
    """Serial ports that are open and answer as a test says.

    Attributes:
        asked: every call, in order.
        answer: what a slave says, as values; None if it does not answer.
        is_open: what `enable` and `is_open` return.
    """

    def __init__(self) -> None:
        self.asked: list[tuple[Any, ...]] = []
        self.received = b"abc"
        self.answer: tuple[int, ...] | None = (1, 2)
        self.opens = True

    def _ask(self, *what: Any) -> None:
        self.asked.append(what)

    def enable(self, device: str, settings: Any, *, is_modbus: bool, is_daemons: bool = False) -> bool:
        self._ask("enable", device, settings, is_modbus, is_daemons)
        return self.opens

    def disable(self, device: str) -> None:
        self._ask("disable", device)

    def is_open(self, device: str) -> bool:
        self._ask("is_open", device)
        return self.opens

    def open_devices(self) -> list[str]:
        return ["/dev/ttymxc0", "tool"]

    def mode(self, device: str) -> str:
        self._ask("mode", device)
        return "RS485"

    def read(self, device: str, count: int, timeout_s: float) -> bytes:
        self._ask("read", device, count, timeout_s)
        return self.received[:count]

    def write(self, device: str, data: bytes, *, is_text: bool = False) -> int | None:
        self._ask("write", device, data)
        return len(data) if self.opens else None

    def flush(self, device: str) -> None:
        self._ask("flush", device)

    def read_slave(self, *what: Any, is_polled: bool) -> tuple[int, ...] | None:
        self._ask("read_slave", *what, is_polled)
        return self.answer

    def write_slave(self, *what: Any, is_polled: bool) -> bool:
        self._ask("write_slave", *what, is_polled)
        return self.answer is not None


class FakeModbus:
    """Signals that work and stand at zero.

    Attributes:
        asked: every call, in order.
    """

    def __init__(self) -> None:
        self.asked: list[tuple[Any, ...]] = []
        self.codes = (0, 0)

    def status(self, name: str) -> int:
        self.asked.append(("status", name))
        return 0

    def errors(self, name: str) -> tuple[int, int]:
        self.asked.append(("errors", name))
        return self.codes

    def invalid_s(self, name: str) -> float:
        self.asked.append(("invalid_s", name))
        return 0.0

    def __getattr__(self, name: str) -> Callable[..., None]:
        return lambda *what, **more: self.asked.append((name, *what, *more.values()))


class FakeRobot:
    """The robot that a command sees; `asked` holds what it wanted, in order."""

    def __init__(self) -> None:
        self.machine = FakeMachine()
        self.profile: Profile = profile()
        self.is_secondary = False
        self.task_path = "/tasks/"
        self.asked: list[Any] = []
        self.refusal: ScriptError | None = None
        self.micro_lines: list[MicroLine] = []
        self.task_files: dict[str, bytes] = {}
        self.sockets = FakeSockets()
        self.lines = FakeLines()
        self.modbus = FakeModbus()
        self.kinds: dict[Any, str] = {}
        self.doubts: list[Any] = []
        self.told: list[tuple[str, str, str]] = []
        self._random = random.Random(7)
        self.machine.write = self._write

    def _ask(self, *what: Any) -> None:
        if self.refusal is not None:
            raise self.refusal
        self.asked.append(what[0] if len(what) == 1 else what)

    def remote_procedures(self, url: str) -> object:
        self._ask("rpc", url)
        return object()

    def read_task_file(self, path: str, size_max: int) -> bytes:
        if path not in self.task_files:
            raise InvalidValueError(f"the file {path!r} does not exist")
        return self.task_files[path]

    def move(self, request: Any) -> None:
        self._ask(request)

    def track(self, request: Any) -> None:
        self._ask(request)

    def shift(self, request: Any) -> None:
        self._ask(request)

    def stop_motion(self, request: Any) -> None:
        self._ask(request)

    def request(self, request: Any) -> None:
        self._ask(request)

    def _write(self, name: str, index: int, value: Any) -> None:
        self._ask(WriteSignal(name, index, value))
        self.machine.image[name, index] = value

    def wait_ticks(self, count: int) -> None:
        self._ask("wait_ticks", count)

    def start_thread(self, function: Callable[..., Any], args: tuple[Any, ...], name: str) -> int:
        self._ask("start_thread", function, args, name)
        return -81230

    def join_thread(self, handle: int) -> None:
        self._ask("join_thread", handle)

    def stop_thread(self, handle: int) -> None:
        self._ask("stop_thread", handle)

    def message(self, text: str) -> None:
        self._ask("message", text)

    def popup(self, text: str, title: str, level: str, *, is_blocking: bool) -> None:
        self._ask("popup", text, title, level, is_blocking)

    def warn_once(self, key: str, text: str, *, code: str = "", hint: str = "") -> None:
        self._ask("warn_once", key, text)

    def mistaken(self, meaning: str, value: Any) -> Any:
        return mistaken(meaning, self.kinds.get(value, ""))

    def note_missing(self, command: str, came: int, number: int) -> None:
        self.missing = command, came, number

    def remember(self, kind: str, value: Any) -> None:
        self.kinds[value] = kind

    def hold_doubts(self, doubts: Any) -> None:
        self.doubts = list(doubts)

    def tell_doubts(self) -> None:
        self.told += [(doubt.code, doubt.text, doubt.hint) for doubt in self.doubts]
        self.doubts = []

    def random(self) -> float:
        return self._random.random()

    def pause(self) -> None:
        self._ask("pause")

    def halt(self) -> None:
        self._ask("halt")

    def mark(self, number: int, label: str) -> None:
        self._ask("mark", number, label)

    def enter_interpreter(self, *, clears_queue: bool, clears_at_end: bool) -> None:
        self._ask("enter_interpreter", clears_queue, clears_at_end)

    def end_interpreter(self) -> None:
        self._ask("end_interpreter")

    def clear_interpreter(self) -> None:
        self._ask("clear_interpreter")

    def watch(self, variable: str, frequency_hz: float, action: str) -> None:
        self._ask("watch", variable, frequency_hz, action)


@pytest.fixture
def robot() -> FakeRobot:
    """A CS66 at rest."""
    return FakeRobot()


@pytest.fixture
def call(robot: FakeRobot) -> Callable[..., Any]:
    """Call a command as a script does: `call("sin", 0.5)`."""

    def call_command(name: str, *args: Any, **kwargs: Any) -> Any:
        command = CATALOGUE.get(name)
        assert command is not None, name
        return command.call(robot, args, kwargs)

    return call_command


@pytest.fixture
def script(robot: FakeRobot) -> Callable[[str], Any]:
    """Evaluate an expression in which every command can be called by its name."""

    def evaluate(text: str) -> Any:
        def bound(command: Any) -> Callable[..., Any]:
            return lambda *args, **kwargs: command.call(robot, args, kwargs)

        names = {name: bound(CATALOGUE.get(name)) for name in CATALOGUE.names()}
        return eval(text, names)

    return evaluate
