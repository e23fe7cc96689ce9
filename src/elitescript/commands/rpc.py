"""Remote procedure calls (manual 2.10 chapter 5.2)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

from elitescript.commands.definition.quantities import Anything, Choice, Str
from elitescript.commands.definition.registry import command
from elitescript.commands.definition.results import COMPUTED

if TYPE_CHECKING:
    from elitescript.commands.definition.context import Robot


@command(family="rpc", manual="5.2.1")
def rpc_factory(
    robot: Robot, type: Annotated[str, Choice("xmlrpc")], url: Str
) -> Annotated[Any, Anything("RPC handle"), COMPUTED]:
    """Return a handle whose methods are the procedures of a server; it connects when the first method is called.

    A call that fails is an alarm with the server's text; `except Exception as error` finds the number and the text of a
    fault in `error.faultCode` and `error.faultString`.

    Args:
        type: protocol.
        url: `<address>:<port>` or `http://<address>:<port>/<path>`.

    Returns:
        The handle.
    """
    return robot.remote_procedures(url)
