"""Everything outside the robot of a `VirtualRobot`: its task folder, its network, what is beside it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Protocol

from elitescript.devices.surroundings import Surroundings
from elitescript.environment.allowance import TASK_DIR_BYTES, Allowance
from elitescript.environment.local_channels import NETWORK_DEFAULT, LocalChannels
from elitescript.environment.network_option import PYTHON, Way
from elitescript.errors import UsageError
from elitescript.messages.line import bind_hint
from elitescript.messages.machine import DisturbInput
from elitescript.messages.timing import seconds
from elitescript.paths import real_path
from elitescript.records import NamedTuple, replace
from elitescript.runtime.environment import Channels, Files, ProgramEnvironment


class Place(NamedTuple):
    """What becomes of a connection that a program makes."""

    name: str
    """Address, or serial port of the robot."""
    port: int | None = None
    is_reached: bool = False
    is_beside: bool = False
    """Whether it ends beside the robot, in its world."""
    words: str = "beside the robot"
    """Where it ends, or why it is not let through and the option that would allow it."""


class OutsideChannels(Channels, Protocol):
    """The network of this computer, or what stands before it.

    Attributes:
        say: receives a sentence before each peer is reached for the first time.
    """

    say: Callable[[str], None]

    def take_refused(self) -> str:
        """Return in words how many connections were not let through since the last call; empty if there were none."""


class Outside:
    """Holds all of it. Implements `runtime.environment.ProgramEnvironment` for the programs of clients.

    Args:
        world: devices, or a folder and a network by themselves; this computer if None.
        task_dir: the task folder, or contents of files by their names: a folder in memory, a new one for each program;
            the program's own folder if None.
        lines: serial ports of this computer by those of the robot.
        task_dir_limit: bytes that programs may add to a task folder.
        network: what programs reach besides what is in the world; see `environment.reach`.

    Attributes:
        channels: the network.
        surroundings: what lives in the robot's time; None if nothing does.

    Raises:
        UsageError: arguments that do not go together.
    """

    __slots__ = (
        "_allowance",
        "_contents",
        "_counted",
        "_files",
        "_is_in_memory",
        "_local",
        "_task_dir",
        "_task_dir_limit",
        "_world",
        "channels",
        "surroundings",
    )

    def __init__(
        self,
        world: ProgramEnvironment | Surroundings | None,
        task_dir: str | Path | Mapping[str, bytes] | None,
        lines: Mapping[str, str] | None,
        task_dir_limit: int = TASK_DIR_BYTES,
        network: str = NETWORK_DEFAULT,
    ) -> None:
        self._contents = task_dir if isinstance(task_dir, Mapping) else {}
        self._is_in_memory = isinstance(task_dir, Mapping)
        self._task_dir = None if task_dir is None or isinstance(task_dir, Mapping) else Path(task_dir)
        self._task_dir_limit = task_dir_limit
        self._allowance = Allowance(task_dir_limit)
        self._world: ProgramEnvironment | None = None
        self._files: Files | None = None
        self.surroundings: Surroundings | None = None
        self.channels: Channels
        self._local: LocalChannels | None = None
        self._counted: OutsideChannels | None = None
        """What has been put before it."""
        if isinstance(world, Surroundings):
            self.surroundings = world
            self.channels = world.channels
            self._local = LocalChannels(lines, network, is_closed=world.is_closed)
            world.lead_outside(self._local)
        elif world is None:
            self.channels = self._local = LocalChannels(lines, network)
        elif lines:
            raise UsageError("lines are ports of this computer; a world has its own: give one of them")
        else:
            self._world = world
            self.channels = world.channels
        self.set_network_by(PYTHON)

    @property
    def is_alone(self) -> bool:
        """Whether the robot has nothing beside it but this computer."""
        return self._world is None and self.surroundings is None

    @property
    def files(self) -> Files:
        """The task folder of programs that come from clients: an empty one in memory without `task_dir`."""
        if self._files is None:
            self._files = self.world_for("<client>").files
        return self._files

    def world_for(self, source_name: str) -> ProgramEnvironment:
        """Return the world of a program; a file's own folder is its task folder unless another one was given."""
        if self._world is not None:
            return self._world
        folder = self._task_dir
        if folder is None and not self._is_in_memory and not source_name.startswith("<"):
            folder = real_path(source_name).parent
        if folder is None:
            from elitescript.environment.memory import MemoryEnvironment

            return MemoryEnvironment(self._contents, self.channels, Allowance(self._task_dir_limit))
        from elitescript.environment.local import LocalEnvironment

        return LocalEnvironment(folder, self.channels, self._allowance)

    def wrap_local(self, wrap: Callable[[OutsideChannels], OutsideChannels]) -> None:
        """Put something before the network of this computer; for a debugger."""
        if self._local is None:
            return
        self._counted = wrapped = wrap(self._local)
        if self.surroundings is not None:
            self.surroundings.lead_outside(wrapped)
        else:
            self.channels = wrapped

    def set_network_by(self, way: Way) -> None:
        """Let texts name the option `network` as users of this robot write it."""
        if self._local is not None:
            self._local.way = way

    def place(self, kind: str, name: str, port: int = 0) -> Place:
        """Return what becomes of a connection that a program makes; nothing is looked up.

        Args:
            kind: `socket`, `modbus`, `rpc` or `serial`.
            name: address, URL or serial port of the robot.
            port: of an address.

        Raises:
            InvalidValueError: a URL that is none.
        """
        if kind == "serial":
            if self.surroundings is not None and self.surroundings.has_line(name):
                return Place(name, is_reached=True, is_beside=True)
            target = None if self._local is None else self._local.target(name)
            return Place(name, is_reached=target is not None, words=target or bind_hint(name))
        if kind == "rpc":
            from elitescript.runtime.connections.rpc import server_of

            _, name, port, _ = server_of(name)
        is_beside = self._local is None or (self.surroundings is not None and self.surroundings.has_server(name, port))
        if is_beside or self._local is None:
            return Place(name, port, is_reached=True, is_beside=True)
        decision = self._local.decide(name, port)
        words = decision.reason or ("it is looked up" if decision.is_name else "let through")
        return Place(name, port, is_reached=not decision.why_not, words=words)

    @property
    def may_be_real(self) -> bool:
        """Whether programs may reach something outside of their world."""
        return self._local is not None and self._local.may_be_real

    def take_refused(self) -> str:
        """Return in words how many connections were not let through since the last call; empty if there were none."""
        counted = self._counted or self._local
        return "" if counted is None else counted.take_refused()

    def fault(self, tick: int, kind: str, on: int | str, settings: Mapping[str, Any]) -> DisturbInput | None:
        """Let something go wrong on channels, from a tick on or later; see `devices.channels.faults.Fault`.

        Returns:
            What to ask of the robot, if it is a fault of an input and there is no `ProgramEnvironment` that asks.

        Raises:
            UsageError: there is no such fault, or it makes no sense there; or no fault can be added any more.
        """
        if self.surroundings is not None:
            self.surroundings.fault(kind, on, **settings)
            return None
        from elitescript.devices.channels.faults import DEVICE, Fault, is_of_input, nowhere, place_of
        from elitescript.devices.channels.faulty_channels import FaultyChannels
        from elitescript.devices.channels.machine_faults import channel_fault, input_request

        fault = Fault(kind, on, **settings)
        if place_of(fault.on)[0] == DEVICE:
            raise nowhere(fault.on, ())
        if is_of_input(fault):
            return input_request(fault, tick)
        fault = replace(fault, at_s=max(fault.at_s, seconds(tick)))
        if not isinstance(self.channels, FaultyChannels):
            if tick or self._world is not None:
                raise UsageError(
                    "the first fault of a robot without a `ProgramEnvironment` must be given before its time begins; "
                    "VirtualRobot(world=World()) takes faults at any time"
                )
            self.channels = FaultyChannels(self.channels)
        self.channels.add(channel_fault(fault))
        return None
