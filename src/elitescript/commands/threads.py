"""Script threads (manual 2.10 chapter 6.1)."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Annotated, Any

from elitescript.commands.definition.quantities import Bool, Quantity, Whole
from elitescript.commands.definition.registry import command
from elitescript.commands.definition.results import HANDLE
from elitescript.said import said

if TYPE_CHECKING:
    from elitescript.commands.definition.context import Robot


class _Function(Quantity):
    """A function of the script."""

    __slots__ = ()

    def __init__(self) -> None:
        super().__init__("function")

    def coerce(self, value: Any) -> Any:
        if not callable(value):
            error = self.wrong_type(value, "a function")
            error.hint = "write the name of the function without parentheses: start_thread(work, ())"
            raise error
        return value


class _Arguments(Quantity):
    """Arguments of a thread's function: a tuple; a list stands for one (*assumed*)."""

    __slots__ = ()

    def __init__(self) -> None:
        super().__init__("tuple")

    def coerce(self, value: Any) -> tuple[Any, ...]:
        if not isinstance(value, (tuple, list)):
            error = self.wrong_type(value, "a tuple")
            written = value if isinstance(value, (bool, int, float)) else "x"
            error.hint = said("a tuple of one element needs a comma: ({written},)", written=written)
            raise error
        return tuple(value)


@command(family="thread", manual="6.1.1", spellings={"fundef": "function", "arg": "args"}, works_in_sec=False)
def start_thread(
    robot: Robot,
    function: Annotated[Callable[..., Any], _Function()],
    args: Annotated[tuple[Any, ...], _Arguments()] = (),
    detach_mode: Bool = True,
) -> Annotated[Whole, HANDLE]:
    """Run a function beside the calling thread; what it returns is lost.

    All threads end with the program. Firmware 2.10 runs at most 15 at a time, 2.14 at most 20 (*observed*).

    Args:
        function: the function, without parentheses.
        args: its arguments, a tuple; a single one needs the comma, `(1,)`. A list stands for a tuple (*assumed*).
        detach_mode: no effect here: the handle can be joined and stopped either way.

    Returns:
        Handle for `join_thread` and `stop_thread`, never 0.

    Raises:
        ArgumentTypeError: `function` cannot be called, or `args` is neither tuple nor list.
        ScriptStateError: too many threads.
    """
    return robot.start_thread(function, args, getattr(function, "__name__", "thread"))


@command(family="thread", since="2.14", manual="2.14: 9.1.2", waits=True, works_in_sec=False)
def join_thread(robot: Robot, thread_id: Whole) -> None:
    """Wait until a thread ends; returns at once for 0, an unknown or an ended one.

    Args:
        thread_id: what `start_thread` returned.

    Raises:
        ScriptStateError: the thread would wait for itself.
    """
    robot.join_thread(thread_id)


@command(family="thread", manual="6.1.2")
def stop_thread(robot: Robot, thread_id: Whole) -> None:
    """End a thread where it stands and brake the move it waits for; no effect on 0, an unknown or an ended one.

    Args:
        thread_id: what `start_thread` returned.
    """
    robot.stop_thread(thread_id)
