"""Time, flags and power (manual 2.10 chapter 6.4)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

from elitescript.commands.definition.quantities import Bool, Choice, Number, Seconds, Str, signal_index
from elitescript.commands.definition.registry import command
from elitescript.commands.definition.results import SIGNAL, STATE
from elitescript.messages.machine import PowerDown
from elitescript.messages.timing import PERIOD_S, ticks_for

if TYPE_CHECKING:
    from elitescript.commands.definition.context import Robot

_FlagNumber = Annotated[int, signal_index("flag")]


@command(family="system", manual="6.4.1", waits=True, works_in_sec=False)
def sleep(robot: Robot, t: Seconds) -> None:
    """Let the calling thread wait; the others continue.

    The time is rounded up to whole control periods.

    Args:
        t: time; 0 does not wait.

    Raises:
        ScriptStateError: called in a secondary program.
    """
    robot.wait_ticks(ticks_for(t))


@command(family="system", waits=True, works_in_sec=False, evidence="observed")
def sync(robot: Robot) -> None:
    """Wait for the next control period.

    No manual describes it; manual 2.14 lists it among the calls that take time, and the vendor's own programs call it.
    """
    robot.wait_ticks(1)


@command(family="system", manual="6.4.2")
def set_flag(robot: Robot, n: _FlagNumber, b: Bool) -> None:
    """Set an internal flag; flags keep their value from one program to the next.

    Args:
        n: number of the flag.
        b: value.
    """
    robot.machine.write("flag", n, b)


@command(family="system", manual="6.4.3")
def get_flag(robot: Robot, n: _FlagNumber) -> Annotated[Bool, SIGNAL]:
    """Return the value of an internal flag.

    Args:
        n: number of the flag.

    Returns:
        The value.
    """
    return bool(robot.machine.read("flag", n))


@command(family="system", manual="6.4.4")
def get_steptime() -> Annotated[Seconds, STATE]:
    """Return the length of the control period.

    Returns:
        0.004 (*observed*: the manual prints no number).
    """
    return PERIOD_S


@command(family="system", since="2.14", manual="2.14: 9.5.5")
def controller_timestamp(robot: Robot) -> Annotated[Seconds, STATE]:
    """Return the clock of the controller.

    Returns:
        Seconds since 1970-01-01 UTC, as Python's `time.localtime` takes them.
    """
    return robot.machine.timestamp_s()


@command(family="system", manual="6.4.5")
def rtsi_set_watchdog(
    robot: Robot,
    variable: Str,
    frequency: Annotated[float, Number("Hz", 0.0, is_low_open=True)],
    action: Annotated[str, Choice("ignore", "pause", "stop")],
) -> None:
    """Watch how often a client writes an RTSI input, until the program ends.

    Args:
        variable: name of the RTSI input.
        frequency: lowest rate that is acceptable.
        action: what happens below it: `"ignore"`, `"pause"` or `"stop"` the program.

    Raises:
        InvalidValueError: no RTSI input has that name.
    """
    robot.watch(variable, frequency, action)


@command(family="system", manual="6.4.7")
def powerdown(robot: Robot) -> None:
    """Stop the arm, then switch off arm and control box; the program ends here."""
    robot.request(PowerDown())
    robot.halt()


@command(family="system", manual="3.57")
def get_task_path(robot: Robot) -> Annotated[Str, STATE]:
    """Return the folder in which the pendant keeps tasks; files that programs open live there.

    Returns:
        The path, ending in `/` (*assumed*: the manual names no path).
    """
    return robot.task_path
