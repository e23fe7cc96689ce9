"""Defines the base class of devices, and what the devices of one world share."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, ClassVar, Final, dataclass_transform

from elitescript.devices.doubts import Doubt
from elitescript.devices.signals import RobotSignals, SignalHub
from elitescript.errors import UsageError, did_you_mean
from elitescript.messages.events import DeviceNoted, Warned
from elitescript.messages.signals import Value
from elitescript.messages.timing import ticks_for
from elitescript.said import said

if TYPE_CHECKING:
    from random import Random

    from elitescript.devices.agenda import Agenda
    from elitescript.devices.channels.network import VirtualNetwork
    from elitescript.messages.outputs import Output
    from elitescript.protocol.connection import Connection


class TakenError(UsageError):
    """Another device has the place already.

    Args:
        text: what is taken.
        other: the device that has it.
    """

    def __init__(self, text: str, other: object) -> None:
        super().__init__(text)
        self.other = other


_ALIKE: Final = 0.85
"""Of two names, as `difflib` counts: one letter wrong in seven, or two that have changed places in fourteen."""


class DeviceContext:
    """Holds what the devices of one world share.

    Args:
        agenda: what happens when.
        network: what programs reach.
        seed: of all random numbers.

    Attributes:
        agenda: see above.
        clients: devices that have connected to a port of the robot, in the order in which they did.
        network: see above.
        seed: see above.
        signals: of the robot, and the robot itself.
    """

    __slots__ = ("_connections", "agenda", "clients", "network", "seed", "signals")

    def __init__(self, agenda: Agenda, network: VirtualNetwork, seed: int) -> None:
        self._connections = 0
        self.agenda = agenda
        self.clients: list[Device] = []
        self.network = network
        self.seed = seed
        self.signals = SignalHub(agenda)

    def connect(self, device: Device, service: str) -> Connection:
        """Connect a device to a port of the robot; it gets the outputs of the ticks that matter to it.

        Raises:
            UsageError: there is no robot, or it has no such port.
        """
        if self.signals.robot is None:
            raise UsageError("there is no robot yet to connect to")
        self._connections += 1
        connection = self.signals.robot.connect(service, f"{service}#world{self._connections}")
        if device in self.clients:
            self.clients.remove(device)
        self.clients.append(device)
        return connection

    def publish(self) -> None:
        """Hand the output of the tick that has run to the devices to which it matters."""
        robot = self.signals.robot
        clients = [device for device in self.clients if device.is_connected]
        if robot is None or not clients:
            return
        tick, has_news = robot.present_tick, robot.has_news
        for device in [device for device in clients if has_news or device.next_output_tick(tick - 1) == tick]:
            device.take_output(robot.output())
        due = [at for at in (device.next_output_tick(tick) for device in clients) if at is not None]
        if due:
            self.agenda.put(min(due) - tick, lambda: None)  # time does not leap over it

    def note(self, device: str, text: str, *, is_warning: bool = False) -> None:
        """Put a line about a device into the record of the run."""
        if self.signals.robot is not None:
            self.signals.robot.emit(DeviceNoted(self.agenda.tick, device, text, is_warning))

    def doubt(self, doubt: Doubt) -> None:
        """Put what is hardly meant into the record of the run."""
        if self.signals.robot is not None:
            code = "W293" if doubt.severity == "warning" else "N290"
            self.signals.robot.emit(Warned(self.agenda.tick, doubt.text, "", 0, code, doubt.hint, 0, doubt.severity))


@dataclass_transform(kw_only_default=True)
class _WithSettings:
    """Takes the settings of a subclass as keywords: type checkers know one for each of its annotated attributes."""

    def __init__(self, **settings: Any) -> None:
        known = setting_names(type(self))
        for key, value in settings.items():
            if key not in known:
                near = did_you_mean(str(key), known)
                raise UsageError(f"{key}: is not known; settings are {', '.join(known)}{near}")
            setattr(self, key, value)
        self.check()

    def check(self) -> None:
        """Check the settings."""


class Device(_WithSettings):
    """Something beside the robot; the base class of all devices.

    A setting is a public attribute of the class. A subclass may give it another value, and so may a keyword, as in
    `Camera(port=5001)`, or a key of a world file, as in `port = 5001`. A subclass may have settings of its own. Type
    checkers know the keywords of attributes that have an annotation.

    Attributes:
        name: for messages; the name of the class if empty. A setting, like those of the subclasses.
        cell: the robot's signals.
        acts_as: what the record of a run calls it when it changes a signal: `device`, `wire` or `schedule`.
        protocol: which one it speaks, `MODBUS` or `XML-RPC`, or neither; faults that are of a protocol go by it.

    Raises:
        UsageError: a keyword that is no setting, or a value that makes no sense.

    Example:
        A button that is pressed every ten seconds.

        >>> from elitescript.testing.world import Device, World
        >>> class Button(Device):
        ...     input: str = "standard_digital_in[0]"
        ...     def started(self):
        ...         self.every(10.0, self.press)
        ...     def press(self):
        ...         self.cell.pulse(self.input, 0.2)
        >>> world = World(devices=[Button(input="standard_digital_in[3]")])
    """

    name: str = ""
    protocol: ClassVar[str] = ""
    acts_as: ClassVar[str] = "device"
    _kept: ClassVar[tuple[str, ...]] = ("cell", "protocol", "acts_as")
    """Public attributes that are no settings."""
    _context: DeviceContext | None = None
    _random: Random | None = None
    _is_gone: bool = False
    _has_missed: bool = False

    if TYPE_CHECKING:
        # No setting, so it is no annotated attribute.

        @property
        def cell(self) -> RobotSignals: ...

        @cell.setter
        def cell(self, cell: RobotSignals) -> None: ...

    # ---------------------------------------------------------------- what a subclass may override

    def check(self) -> None:
        """Check the settings.

        Raises:
            UsageError: one makes no sense; the text begins with its name and a colon.
        """

    def started(self) -> None:
        """Act on the start; called once, before the first tick of the robot."""

    def signal_changed(self, name: str, value: Value) -> None:
        """Act on a signal of the robot that has changed; called after the tick in which it did."""

    # ---------------------------------------------------------------- what a subclass may use

    @property
    def title(self) -> str:
        """What messages call it."""
        return self.name or type(self).__name__

    @property
    def held_signal(self) -> str:
        """The signal whose level it determines at every moment; empty if it determines none."""
        return ""

    @property
    def driven_inputs(self) -> list[str]:
        """Inputs of the robot that its settings name; for faults of what it sets."""
        from elitescript.devices.channels.faults import INPUTS

        values = [getattr(self, name) for name in setting_names(type(self))]
        return [value for value in values if isinstance(value, str) and value.partition("[")[0] in INPUTS]

    @property
    def carrier(self) -> Device:
        """What accepts programs at its port or line: itself, or what several devices at one place share."""
        return self

    @property
    def author(self) -> Device:
        """The device whose code ran last on its behalf; for messages about what went wrong."""
        return self

    @property
    def random(self) -> Random:
        """Random numbers; the same in every run, from the seed of the world and the name of the device."""
        if self._random is None:
            from random import Random

            self._random = Random(f"{self._in_world().seed}/{self.title}")
        return self._random

    def after(self, delay_s: float, call: Callable[..., Any], *arguments: Any) -> None:
        """Make a call when so much time has passed; one tick at least."""
        ticks = max(1, ticks_for(delay_s))
        self._in_world().agenda.put(ticks, lambda: call(*arguments), self)

    def every(self, period_s: float, call: Callable[..., Any], *arguments: Any) -> None:
        """Make a call again and again, for the first time after one period.

        Raises:
            UsageError: a period that is not above 0.
        """
        if not period_s > 0.0:
            raise UsageError(f"the period must be > 0 s, got {period_s:g}")
        agenda = self._in_world().agenda
        start, count = agenda.tick, 0

        def act() -> None:
            plan()
            call(*arguments)

        def plan() -> None:
            nonlocal count
            count += 1
            agenda.put(max(1, start + ticks_for(count * period_s) - agenda.tick), act, self)

        plan()

    def log(self, text: str) -> None:
        """Add a line to the record of the run."""
        self._in_world().note(self.title, text)

    def warn(self, text: str) -> None:
        """Add a warning to the record of the run."""
        self._in_world().note(self.title, text, is_warning=True)

    def miss_method(self, written: str, got: str) -> None:
        """Warn that what has come reaches no method of a user's class; once, and not if the class has no methods.

        Args:
            written: how the method that takes it is defined, such as `line_received(self, line)`.
            got: what has come.
        """
        own = sorted(name for name in own_methods(type(self)) if not name.startswith("_"))
        if own and not self._has_missed:
            self._has_missed = True
            names = ", ".join(f"{name}()" for name in own[:4])
            self.warn(
                said(
                    "got {got!r}, and has no {written} that takes it; nothing calls {names}",
                    got=got[:60],
                    written=written,
                    names=names,
                )
            )

    # ---------------------------------------------------------------- called by the world

    def _in_world(self) -> DeviceContext:
        if self._context is None:
            raise UsageError(f"{self.title} is in no world yet; what it does at the start belongs into `started`")
        return self._context

    def join(self, context: DeviceContext) -> None:
        """Become part of a world.

        Raises:
            UsageError: it is part of another one, or its place is taken.
        """
        if self._context is not None:
            raise UsageError(f"{self.title} is part of another world already; make a new one for each robot")
        self.check()
        self._context = context
        self.cell = RobotSignals(context.signals, self)

    def begin(self) -> None:
        """Begin what a kind of devices does by itself; called before `started`."""

    @property
    def is_connected(self) -> bool:
        """Whether it is connected to a port of the robot."""
        return False

    def sets(self, name: str) -> str:
        """Return when it sets a signal of the robot, as a sentence with `it` for the signal; empty if it does not."""
        return f"{self.title} sets it" if name in self.driven_inputs else ""

    @property
    def may_set_any(self) -> bool:
        """Whether its code is somebody else's, which may set any signal."""
        return not _is_ours(type(self))

    def next_output_tick(self, tick: int) -> int | None:
        """Return the next tick after `tick` of which it must get the output although nothing happens in it."""
        return None

    def reads(self, tick: int) -> int:
        """Return the parts of the snapshot of a tick that it reads at a port of the robot, as bits."""
        return 0

    def take_output(self, output: Output) -> None:
        """Take the output of a tick that has run."""

    def run_ended(self) -> None:
        """Report what has come in a run that is over, and is not complete."""

    @property
    def is_gone(self) -> bool:
        """Whether its code has failed: it does nothing any more."""
        return self._is_gone

    def leave(self) -> None:
        """Do nothing any more: its code has failed."""
        self._is_gone = True


def setting_names(device_class: type[_WithSettings]) -> list[str]:
    """Return names of the settings of a class, in the order in which they were written."""
    import inspect

    hidden = {name for owner in device_class.__mro__ for name in vars(owner).get("_kept", ())}
    names: list[str] = []
    for owner in reversed(device_class.__mro__):
        for name in (*inspect.get_annotations(owner), *vars(owner)):
            value = getattr(device_class, name, None)
            is_setting = not callable(value) and not isinstance(value, (property, staticmethod, classmethod))
            if not name.startswith("_") and name not in hidden and name not in names and is_setting:
                names.append(name)
    return names


def own_methods(device_class: type[Device]) -> set[str]:
    """Return the names of the methods of a user's class."""
    return {
        name
        for owner in device_class.__mro__
        if not _is_ours(owner)
        for name, value in vars(owner).items()
        if callable(value)
    }


def misspelt(device_class: type[Device]) -> list[tuple[str, str]]:
    """Return methods of a user's class that are almost called like one of ours, each with that one."""
    own = own_methods(device_class)
    if not own:
        return []
    from difflib import get_close_matches

    ours = {name for owner in device_class.__mro__ if _is_ours(owner) for name in vars(owner) if name[0] != "_"}
    near = {name: get_close_matches(name, ours, 1, _ALIKE) for name in sorted(own - ours) if name[0] != "_"}
    return [(name, found[0]) for name, found in near.items() if found]


def _is_ours(owner: type) -> bool:
    return owner.__module__.partition(".")[0] in ("elitescript", "builtins")


def check_number(name: str, value: object, low: float, high: float, unit: str = "", *, is_whole: bool = False) -> None:
    """Refuse a setting that is no number, or outside its range.

    Raises:
        UsageError: it is; the text begins with the name of the setting.
    """
    limits = said("in [{low:g}, {high:g}] {unit}", low=low, high=high, unit=unit).rstrip()
    kind = "a whole number" if is_whole else "a number"
    if isinstance(value, bool) or not isinstance(value, int if is_whole else (int, float)):
        raise UsageError(f"{name}: must be {kind} {limits}, got {value!r}")
    if not low <= value <= high:
        raise UsageError(f"{name}: must be {limits}, got {value!r}")


def check_text(name: str, value: object) -> None:
    """Refuse a setting that is no text.

    Raises:
        UsageError: it is none.
    """
    if not isinstance(value, str):
        raise UsageError(f"{name}: must be a text, got {value!r}")
