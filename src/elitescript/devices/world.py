"""Puts everything around one robot: a network with devices, signals, faults."""

from __future__ import annotations

import traceback
from collections.abc import Callable, Iterable
from functools import partial, reduce
from operator import or_
from pathlib import Path
from typing import Any, Final

from elitescript.devices.agenda import Agenda, DeviceError
from elitescript.devices.channels.faults import (
    DEVICE,
    INPUTS,
    TABLE,
    Fault,
    check_protocol,
    check_together,
    fault_from,
    is_of_input,
    nowhere,
    place_of,
)
from elitescript.devices.channels.faulty_channels import FaultyChannels
from elitescript.devices.channels.machine_faults import channel_fault, input_request
from elitescript.devices.channels.network import VirtualNetwork
from elitescript.devices.device import Device, DeviceContext, misspelt, setting_names
from elitescript.devices.doubts import Doubt, doubts_of, doubts_of_held
from elitescript.devices.surroundings import REAL, VIRTUAL, RobotAccess, Surroundings
from elitescript.errors import UsageError, suggests_keywords
from elitescript.messages.faults import Passing
from elitescript.messages.machine import DisturbInput, EndInputFaults
from elitescript.messages.signals import Value
from elitescript.records import replace
from elitescript.runtime.environment import Channels

_NEVER: Final = "nothing calls {}(); is it meant to be {}()?"
_HOME: Final = str(Path(__file__).parents[2])
_LIBRARY: Final = str(Path(traceback.__file__).parent)


class World(Surroundings):
    """Devices, wires and faults around one robot, in the robot's own time.

    It has no clock: a program runs as fast as without it, and every run with the same seed is the same.
    What is not in it is reached as far as the option `network` of the robot lets it: by default the loopback addresses
    of this computer are, which holds the run back to the wall clock while a connection is open.

    Args:
        devices: what is there.
        wires: how signals depend on each other; devices as well.
        faults: what goes wrong on channels and at inputs.
        seed: of everything that is drawn in it.
        network: `virtual`: there is nothing but the devices, whatever the option of the robot is; `real`: as without,
            and faults may be at places where no device is.

    Attributes:
        signals: of the robot, as all devices share them.
        network: what programs reach.
        leads_to: what `network` was.
        agenda: what happens when.
        seed: see above.
        devices: all of them, wires too.

    Raises:
        UsageError: two devices have the same place, or one is part of another world.

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

    @suggests_keywords
    def __init__(
        self,
        devices: Iterable[Device] = (),
        wires: Iterable[Device] = (),
        faults: Iterable[Fault] = (),
        *,
        seed: int = 0,
        network: str = "",
    ) -> None:
        if network not in ("", VIRTUAL, REAL):
            raise UsageError(f"network: must be {VIRTUAL} or {REAL}, got {network!r}")
        self.leads_to = network
        if isinstance(seed, bool) or not isinstance(seed, int):
            raise UsageError(f"seed: must be a whole number, got {seed!r}")
        self.seed = seed
        self.agenda = Agenda()
        self.agenda.on_failure = self._failed
        self.network = VirtualNetwork(agenda=self.agenda)
        self._context = DeviceContext(self.agenda, self.network, seed)
        self.signals = self._context.signals
        self._faults: list[Fault] = []
        self._faulty = FaultyChannels(self.network, seed=seed, say=self._note_fault)
        self.channels: Channels = self._faulty
        self.devices: list[Device] = []
        self.on_device_failure: Callable[[DeviceError], None] | None = None
        """Called when the code of a device has failed; as long as it is None the run ends with the error."""
        for device in (*devices, *wires):
            self.add(device)
        found = [self.resolved(fault) for fault in faults]
        check_together(found)
        for fault in found:
            self.add_fault(fault)

    def add(self, device: Device) -> None:
        """Put one more device there."""
        if not isinstance(device, Device):
            raise UsageError(f"a world is made of devices and wires, not of {device!r}")
        device.join(self._context)
        self.devices.append(device)
        if type(device).signal_changed is not Device.signal_changed:
            device.cell.listen(device.signal_changed)
        if self.signals.robot is not None:
            self._start(device)

    def fault(self, kind: str, on: int | str, **settings: Any) -> None:
        """Let something go wrong from now on; see `Fault`. `at_s` counts from the robot's start.

        Raises:
            UsageError: there is no such fault, or it makes no sense there.
        """
        fault = self.resolved(fault_from({"kind": kind, "on": on, **settings}))
        now = replace(fault, at_s=max(fault.at_s, self.agenda.time_s))
        check_together([*self._faults, now])
        self.add_fault(now)

    @property
    def faults(self) -> tuple[Fault, ...]:
        """What goes wrong, or will; each with the place and the seed that it has."""
        return tuple(self._faults)

    @property
    def input_faults(self) -> list[DisturbInput]:
        """The faults of inputs among them, for the robot that has not begun."""
        return [input_request(fault) for fault in self._faults if is_of_input(fault)]

    def fault_places(self) -> list[tuple[str, str, str]]:
        places = [(place, device) for device in self.devices for place in self.network.places(device.carrier)]
        names = [(name, device) for device in self.devices for name in device.driven_inputs]
        places += [(name, device) for name, device in names if name.partition("[")[0] in INPUTS]
        return [(str(place), place_of(place)[0], device.name or device.title) for place, device in places]

    def has_server(self, address: str, port: int) -> bool:
        return self.network.server(address, port) is not None

    def has_line(self, device: str) -> bool:
        return device in self.network.lines

    def setters(self, name: str) -> list[str] | None:
        found = [words for device in self.devices if (words := device.sets(name))]
        return None if not found and any(device.may_set_any for device in self.devices) else found

    def title_at(self, kind: str, where: str) -> str:
        address, _, port = where.rpartition(":")
        server = self.network.server(address, int(port)) if port.isdecimal() else self.network.lines.get(where)
        owner = getattr(server, "__self__", None)
        return owner.title if isinstance(owner, Device) else ""

    def hear(self, listener: Callable[[Passing], Any]) -> None:
        """Have a function called with each message that passes between programs and devices, from now on."""
        self._faulty.on_message = listener

    def faults_so_far(self) -> list[tuple[str, str]]:
        return [(str(fault.on), fault.kind) for fault in self._faults]

    def add_fault(self, fault: Fault) -> None:
        """Let something go wrong at its time.

        Raises:
            UsageError: it makes no sense with the devices that are there.
        """
        fault = self.check_fault(fault)
        self._faults.append(fault)
        if not is_of_input(fault):
            self._faulty.put(channel_fault(fault))
        elif self.signals.robot is not None:
            self.signals.robot.disturb(input_request(fault, self.agenda.tick))

    def resolved(self, fault: Fault) -> Fault:
        """Return a fault with the port, line or input that its `on` means, and with the seed of this world.

        Raises:
            UsageError: no device is called so, or it has no place for such a fault, or more than one.
        """
        changes: dict[str, Any] = {}
        kind, name, _ = place_of(fault.on)
        if kind == DEVICE:
            changes["on"] = self._place_of_device(name, is_input=is_of_input(fault))
        if fault.seed is None and "seed" in TABLE[fault.kind].takes:
            changes["seed"] = self.seed
        try:
            return replace(fault, **changes) if changes else fault
        except UsageError as error:
            raise UsageError(f"{error} (of {fault.on})" if kind == DEVICE else str(error)) from None

    def _place_of_device(self, name: str, *, is_input: bool) -> int | str:
        devices = [device for device in self.devices if name in (device.name, device.title)]
        if not devices:
            raise nowhere(name, [device.name for device in self.devices if device.name])
        if len(devices) > 1:
            raise UsageError(f"on: {len(devices)} devices are called {name}; write a port, a line or an input")
        places = devices[0].driven_inputs if is_input else self.network.places(devices[0].carrier)
        if len(places) == 1:
            return places[0]
        what = "set no input" if is_input else "has no port or line"
        if not places:
            raise UsageError(f"on: {name} {what.replace('set ', 'sets ')}; name the place itself")
        raise UsageError(f"on: {name} sets {', '.join(map(str, places))}; name one of them")

    def check_fault(self, fault: Fault) -> Fault:
        """Refuse a fault that makes no sense with the devices that are there, else return it as `resolved` does.

        Raises:
            UsageError: no device is at its place, or it is a wrong reply of a protocol that no device there speaks.
        """
        fault = self.resolved(fault)
        if is_of_input(fault):
            return fault
        owners = self.network.owners(*place_of(fault.on))
        if not owners and not self._has_other_places:
            raise UsageError(f"on: no device of this world is at {fault.on!r}, so nothing could ever go wrong there")
        there = [owner for owner in owners if isinstance(owner, Device)]
        check_protocol(fault, {device.title: device.protocol for device in there})
        return fault

    @property
    def is_closed(self) -> bool:
        return self.leads_to == VIRTUAL

    @property
    def _has_other_places(self) -> bool:
        """Whether faults may be where no device is: what has devices is meant to be all that programs speak to."""
        return self.leads_to == REAL or not (self.leads_to or self.network.servers or self.network.lines)

    def end_faults(self) -> None:
        """End all faults."""
        self._faults.clear()
        self._faulty.clear()
        if self.signals.robot is not None:
            self.signals.robot.disturb(EndInputFaults())

    # ---------------------------------------------------------------- called by the robot

    def begin(self, robot: RobotAccess) -> None:
        """Belong to a robot, from its first tick on.

        Raises:
            UsageError: it belongs to another one.
        """
        if self.signals.robot is not None:
            raise UsageError("this world belongs to another robot already; make a new one for each robot")
        self.agenda.clock = lambda: robot.present_tick
        self.signals.robot = robot
        for device in self.devices:
            self._start(device)
        self._doubt(doubts_of_held((device.name or device.title, device.held_signal) for device in self.devices))
        for fault in self._faults:
            self._doubt(
                doubts_of(f"{fault.kind} on {fault.on}", {"delay_s": fault.delay_s, "settle_s": fault.settle_s})
            )

    def _doubt(self, doubts: Iterable[Doubt]) -> None:
        # In the first tick, so that the record of the run has it.
        for doubt in doubts:
            self.agenda.put(1, partial(self._context.doubt, doubt))

    def _start(self, device: Device) -> None:
        for name, near in misspelt(type(device)):
            # In the first tick, so that the record of the run has it.
            self.agenda.put(
                1, partial(self._context.note, device.title, _NEVER.format(name, near), is_warning=True), device
            )
        self._doubt(doubts_of(device.title, {name: getattr(device, name) for name in setting_names(type(device))}))
        self.agenda.attempt(device.begin, device)
        self.agenda.attempt(device.started, device)

    def lead_outside(self, channels: Channels) -> None:
        self.network.outside = channels

    def signal_changed(self, name: str, value: Value) -> None:
        self.signals.changed(name, value)

    def next_tick(self, tick: int) -> int | None:
        return self.agenda.next_tick(tick)

    def settle(self) -> None:
        self.signals.settle()
        self._context.publish()

    def reads(self, tick: int) -> int:
        """Return the parts of the snapshot of a tick that devices read at ports of the robot, as bits."""
        return reduce(or_, [device.reads(tick) for device in self._context.clients], 0)

    def run_ended(self) -> None:
        for device in self.devices:
            device.run_ended()

    def _note_fault(self, text: str) -> None:
        self._context.note("fault", text)

    def _failed(self, owner: object, error: Exception) -> None:
        """Disconnect a device whose code has raised."""
        if not isinstance(owner, Device):
            raise error
        owner.leave()
        author = owner.author
        self.network.drop(owner, f"{author.title} has failed")
        failure = DeviceError(describe(author, error))
        if self.on_device_failure is None:
            raise failure from error
        self.on_device_failure(failure)


def describe(device: Device, error: Exception) -> str:
    """Return where the code of a device failed, and how."""
    place = place_in(error)
    kind = type(device).__name__
    named = device.title if device.title == kind else f"{device.title} ({kind})"
    return f"{place + ': ' if place else ''}device {named}: {type(error).__name__}: {error}"


def place_in(error: Exception) -> str:
    """Return the file and line where code that is not ours has failed; empty if none has."""
    frames = traceback.extract_tb(error.__traceback__)
    own = [frame for frame in frames if not frame.filename.startswith((_HOME, _LIBRARY, "<"))]
    return f"{own[-1].filename}:{own[-1].lineno}" if own else ""
