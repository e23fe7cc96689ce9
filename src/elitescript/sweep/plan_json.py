"""Plans, choices and rows as JSON has them, and back, checked field by field."""

from __future__ import annotations

from typing import Any

from elitescript.sweep.plan import Choices, Plan, Row


def plan_data(plan: Plan) -> dict[str, Any]:
    """Return a plan as JSON has it."""
    raise NotImplementedError


def plan_of(data: Any) -> Plan:
    """Return the plan of such data.

    Raises:
        UsageError: not a plan; the text names the field.
    """
    raise NotImplementedError


def plan_digest(plan: Plan) -> str:
    """Return 16 hexadecimal digits that are the same for equal plans alone."""
    raise NotImplementedError


def choices_data(choices: Choices) -> dict[str, Any]:
    """Return choices as JSON has them."""
    raise NotImplementedError


def choices_of(data: Any) -> Choices:
    """Return the choices of such data.

    Raises:
        UsageError: not choices; the text names the field.
    """
    raise NotImplementedError


def row_data(row: Row) -> list[Any]:
    """Return a row as JSON has it."""
    raise NotImplementedError


def row_of(data: Any) -> Row:
    """Return the row of such data.

    Raises:
        UsageError: not a row; the text names the field.
    """
    raise NotImplementedError
