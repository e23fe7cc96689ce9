"""Texts of outcomes, for ports."""

from __future__ import annotations

from elitescript.messages.outcomes import Debugged, Done, Outcome, Refused, RegistersRead, ShownValue


def refusal_of(outcome: Outcome) -> str | None:
    """Return why a request was not carried out; None if it was."""
    match outcome:
        case Done() | ShownValue() | RegistersRead() | Debugged():
            return None
        case Refused(reason):
            return reason
    return f"the robot answers with {type(outcome).__name__}"


def value_text(outcome: Outcome) -> str:
    """Return the value of an outcome, empty if it has none."""
    return outcome.text if isinstance(outcome, ShownValue) else ""
