"""What a client has said of itself in `initialize`, and places as it counts them."""

from __future__ import annotations

from elitescript.dap.messages import WRONG_ARGUMENTS, Arguments, Body, RequestError
from elitescript.records import record


@record
class ClientSettings:
    """What a client understands; at first what the protocol assumes.

    Attributes:
        first_line, first_column: numbers of the first ones, 0 or 1.
        has_types: whether it shows types of variables.
        has_invalidated: whether it knows the event `invalidated`.
    """

    first_line: int = 1
    first_column: int = 1
    has_types: bool = False
    has_invalidated: bool = False

    def line_from(self, line: int) -> int:
        """Return a line of the client as we count it, from 1."""
        return line + 1 - self.first_line

    def column_from(self, column: int) -> int:
        """Return a column of the client as we count it, from 1."""
        return column + 1 - self.first_column

    def place(self, line: int, column: int, end_line: int = 0, end_column: int = 0) -> Body:
        """Return a place for the client; numbers that are 0 are left out."""
        found: Body = {}
        if line:
            found["line"] = line - 1 + self.first_line
        if column:
            found["column"] = column - 1 + self.first_column
        if end_line:
            found["endLine"] = end_line - 1 + self.first_line
        if end_column:
            found["endColumn"] = end_column - 1 + self.first_column
        return found


def client_settings(arguments: Arguments) -> ClientSettings:
    """Read the arguments of `initialize`."""
    if (form := arguments.text("pathFormat", "path")) != "path":
        raise RequestError(WRONG_ARGUMENTS, f"initialize: pathFormat must be 'path', got {form!r}")
    return ClientSettings(
        int(arguments.flag("linesStartAt1", True)),
        int(arguments.flag("columnsStartAt1", True)),
        arguments.flag("supportsVariableType"),
        arguments.flag("supportsInvalidatedEvent"),
    )
