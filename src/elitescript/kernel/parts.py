"""The parts that a robot is made of."""

from __future__ import annotations

from elitescript.controller.controller import Controller
from elitescript.kernel.options import RobotOptions
from elitescript.messages.enums import TaskState
from elitescript.messages.events import Event, Popup, TaskStateChanged
from elitescript.messages.profile import Profile
from elitescript.models.model import RobotModel
from elitescript.records import NamedTuple
from elitescript.runtime.host import ScriptHost
from elitescript.runtime.probe import Probe


class PopupWindow:
    """The message window of the pendant.

    Args:
        confirms: whether a popup that blocks is confirmed at once, which leaves nothing to show.

    Attributes:
        text: what is shown; empty while the window is closed.
    """

    __slots__ = ("_confirms", "_is_blocking", "text")

    def __init__(self, confirms: bool) -> None:
        self._confirms = confirms
        self._is_blocking = False
        self.text = ""

    def take(self, event: Event) -> None:
        """Follow an event: a popup opens the window; the end of a program closes one that no thread waits for."""
        if isinstance(event, Popup):
            if not (event.is_blocking and self._confirms):
                self.text, self._is_blocking = event.text, event.is_blocking
        elif isinstance(event, TaskStateChanged) and event.state is TaskState.STOPPED and self._is_blocking:
            self.close()

    def close(self) -> None:
        """Close the window."""
        self.text, self._is_blocking = "", False


class RobotParts(NamedTuple):
    """The parts of one robot."""

    options: RobotOptions
    model: RobotModel
    profile: Profile
    controller: Controller
    host: ScriptHost
    """Runs its programs."""
    popup: PopupWindow
    probe: Probe | None
    """What counts their statements."""
