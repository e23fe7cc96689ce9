"""Remote procedure calls (manual 2.10 chapter 5.2)."""

from __future__ import annotations

from typing import Annotated, Any

from elitescript.commands.quantities import Anything, Choice, Str
from elitescript.commands.registry import command
from elitescript.errors import NotSimulatedError


@command(family="rpc", manual="5.2.1", is_simulated=False)
def rpc_factory(type: Annotated[str, Choice("xmlrpc")], url: Str) -> Annotated[Any, Anything("RPC handle")]:
    """Handle whose methods are the procedures of a server; it connects when the first method is called.

    Args:
        type: protocol.
        url: `<address>:<port>` or `http://<address>:<port>/<path>`.

    Returns:
        The handle.
    """
    raise NotSimulatedError("remote procedure calls are not simulated yet")
