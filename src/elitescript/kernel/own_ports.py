"""The robot's own ports for devices that live in its time: connections without sockets.

Only ports whose requests are all for the machine are here; programs, tasks and message windows need a served robot.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib import import_module
from typing import Final

from elitescript.controller.controller import Controller
from elitescript.controller.refusals import refusal_text
from elitescript.controller.views.snapshots import SnapshotBuilder
from elitescript.errors import ScriptError, UsageError
from elitescript.kernel.answers import shown_after
from elitescript.kernel.causes import cause_of
from elitescript.kernel.description import describe
from elitescript.kernel.options import RobotOptions
from elitescript.messages.events import Event, Warned
from elitescript.messages.inputs import Do, Input, VariablesArrived
from elitescript.messages.machine import DisturbInput, EndInputFaults, WriteSignal
from elitescript.messages.outputs import Output, Reply
from elitescript.messages.profile import Profile
from elitescript.messages.signals import Value
from elitescript.messages.snapshot import RobotDescription, TaskPicture
from elitescript.models.model import RobotModel
from elitescript.protocol.connection import Connection
from elitescript.protocol.outcomes import done, refused
from elitescript.runtime.host import ScriptHost

PORTS: Final = {
    "rtsi": ("elitescript.protocol.rtsi.connection:RtsiConnection", "elitescript.protocol.rtsi.recipes:RtsiPort"),
    "modbus": ("elitescript.protocol.modbus_port:ModbusConnection", "elitescript.protocol.modbus_port:ModbusPort"),
}
"""Class of a connection by the name of the port, and of what its clients share."""

_WITH_DESCRIPTION: Final = frozenset({"modbus"})
"""What the clients share is made with the description of the robot."""


class OwnPorts:
    """The robot as its surroundings see it; implements `devices.surroundings.RobotPort`.

    Args:
        controller: the machine.
        host: its programs.
        model: the arm.
        profile: the firmware.
        options: what the robot is made with.
    """

    __slots__ = ("_controller", "_description", "_host", "_options", "_pictures", "_replies", "_shared")

    def __init__(
        self, controller: Controller, host: ScriptHost, model: RobotModel, profile: Profile, options: RobotOptions
    ) -> None:
        self._controller = controller
        self._host = host
        self._description: RobotDescription = describe(options, model, profile)
        self._options = options
        self._pictures: SnapshotBuilder | None = None
        self._shared: dict[str, object] = {}
        self._replies: list[Reply] = []

    @property
    def tick(self) -> int:
        """See `RobotAccess.tick`."""
        return self._controller.tick

    def read(self, name: str, index: int) -> Value:
        """See `RobotAccess.read`."""
        return self._controller.read(name, index)

    def write(self, request: WriteSignal, by: str) -> None:
        """See `RobotAccess.write`."""
        self._controller.put(self._controller.tick, request, by)

    def disturb(self, request: DisturbInput | EndInputFaults) -> None:
        """See `RobotAccess.disturb`."""
        self._controller.put(self._controller.tick, request, "fault")

    def emit(self, event: Event) -> None:
        """See `RobotAccess.emit`."""
        self._controller.emit(event)

    def connect(self, service: str, origin: str) -> Connection:
        """See `RobotAccess.connect`."""
        if service not in PORTS:
            ports = ", ".join(PORTS)
            raise UsageError(f"service: beside a robot in virtual time there are the ports {ports}, not {service!r}")
        connection, shared = map(_loaded, PORTS[service])
        if service not in self._shared:
            self._shared[service] = shared(self._description) if service in _WITH_DESCRIPTION else shared()
        made: Connection = connection(origin, self._description, self._shared[service])
        return made

    def output(self) -> Output:
        """See `RobotAccess.output`."""
        if self._pictures is None:
            self._pictures = SnapshotBuilder(self._controller)
        task = self._controller.task
        name = task.name if task.is_running else ""
        picture = TaskPicture("", name, self._options.configuration, is_saved=True, is_configuration_modified=False)
        snapshot = self._pictures.picture(picture, "", is_remote=self._options.remote, overruns=0)
        replies, self._replies = tuple(self._replies), []
        return Output(self._controller.tick, (), (), replies, snapshot)

    def post(self, inputs: Sequence[Input]) -> None:
        """See `RobotAccess.post`."""
        for item in inputs:
            if isinstance(item, Do):
                self._do(item)
            elif isinstance(item, VariablesArrived):
                self._host.watchdogs.arrived(item.names, self._controller.tick)
            else:
                raise UsageError(f"{type(item).__name__} of {item!r:.60} needs a served robot")

    def _do(self, item: Do) -> None:
        why_not = ""
        try:
            self._controller.request_from(item.request, cause_of(item.origin))
        except (ScriptError, UsageError) as error:
            why_not = refusal_text(item.request, error)
            self._controller.emit(Warned(self._controller.tick, why_not))
        if item.is_answered:
            shown = shown_after(self._controller, self._description.firmware, item.request)
            self._replies.append(Reply(item.origin, refused(why_not) if why_not else done(shown)))


def _loaded(name: str) -> Callable[..., Connection]:
    module, _, attribute = name.partition(":")
    found: Callable[..., Connection] = getattr(import_module(module), attribute)
    return found
