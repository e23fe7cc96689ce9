"""Everything around one robot: a network with devices, signals, faults."""

from __future__ import annotations

import traceback
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Final

from elitescript.errors import UsageError
from elitescript.messages.events import DeviceNoted
from elitescript.messages.signals import Value
from elitescript.runtime.world import Channels
from elitescript.worlds.surroundings import RobotPort, Surroundings
from elitescript.worlds.virtual.agenda import Agenda, DeviceError
from elitescript.worlds.virtual.device import Device
from elitescript.worlds.virtual.network import VirtualNetwork
from elitescript.worlds.virtual.signals import RobotSignals

_HOME: Final = str(Path(__file__).parents[2])


class World(Surroundings):
    """Devices, wires and faults around one robot, in the robot's own time.

    Nothing in it knows a clock: a program runs as fast as without it, and every run with the same seed is the same.
    What is not in it does not exist: a connection to another port is refused.

    Args:
        devices: what is there.
        wires: how signals depend on each other; devices as well.
        seed: of everything that is drawn in it.

    Attributes:
        signals: of the robot.
        network: what programs reach.
        agenda: what happens when.
        seed: see above.
        devices: all of them, wires too.

    Raises:
        UsageError: two devices want the same place, or one is part of another world.

    Example:
        An output closes a gripper, which raises an input 0.3 s later.

        >>> from elitescript import VirtualRobot
        >>> from elitescript.testing.world import Wire, World
        >>> gripper = Wire(when="standard_digital_out[0]", then="standard_digital_in[1]", after_s=0.3)
        >>> robot = VirtualRobot("CS66", world=World(wires=[gripper]))
        >>> run = robot.run('''
        ... def grip():
        ...   set_standard_digital_out(0, True)
        ...   while not get_standard_digital_in(1):
        ...     sync()
        ...   end
        ...   textmsg("closed")
        ... end
        ... ''')
        >>> run.log, run.time_s
        (['closed'], 0.3)
    """

    def __init__(self, devices: Iterable[Device] = (), wires: Iterable[Device] = (), *, seed: int = 0) -> None:
        self.seed = seed
        self.agenda = Agenda()
        self.agenda.on_failure = self._failed
        self.signals = RobotSignals(self.agenda)
        self.network = VirtualNetwork(agenda=self.agenda)
        self.channels: Channels = self.network
        self.devices: list[Device] = []
        self._robot: RobotPort | None = None
        for device in (*devices, *wires):
            self.add(device)

    def add(self, device: Device) -> None:
        """Put one more device there."""
        if not isinstance(device, Device):
            raise UsageError(f"a world is made of devices and wires, not of {device!r}")
        device.join(self)
        self.devices.append(device)
        if type(device).signal_changed is not Device.signal_changed:
            self.signals.listen(device.signal_changed, device)
        if self._robot is not None:
            self.agenda.attempt(device.started, device)

    # ---------------------------------------------------------------- the robot's side

    def begin(self, robot: RobotPort) -> None:
        """Belong to a robot, from its first tick on.

        Raises:
            UsageError: it belongs to another one.
        """
        if self._robot is not None:
            raise UsageError("this world belongs to another robot already; make a new one for each robot")
        self._robot = robot
        self.signals.begin(robot)
        for device in self.devices:
            self.agenda.attempt(device.started, device)

    def signal_changed(self, name: str, value: Value) -> None:
        self.signals.changed(name, value)

    def settle(self) -> None:
        self.signals.settle()

    # ---------------------------------------------------------------- the devices' side

    def say(self, device: Device, text: str, *, is_warning: bool = False) -> None:
        """Put words of a device into the record of the run."""
        if self._robot is not None:
            self._robot.emit(DeviceNoted(self.agenda.tick, device.title, text, is_warning))

    def _failed(self, owner: object, error: Exception) -> None:
        """The code of a device has raised."""
        if not isinstance(owner, Device):
            raise error
        owner.leave()
        self.network.drop(owner, f"{owner.title} has failed")
        raise DeviceError(describe(owner, error)) from error


def describe(device: Device, error: Exception) -> str:
    """Where the code of a device failed, and how."""
    frames: Sequence[traceback.FrameSummary] = traceback.extract_tb(error.__traceback__)
    own = [frame for frame in frames if not frame.filename.startswith(_HOME)]
    place = f"{own[-1].filename}:{own[-1].lineno}: " if own else ""
    kind = type(device).__name__
    named = device.title if device.title == kind else f"{device.title} ({kind})"
    return f"{place}device {named}: {type(error).__name__}: {error}"
