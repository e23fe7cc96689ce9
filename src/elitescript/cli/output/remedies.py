"""Adds the verbs of `elitescript ctl` to the advice in refusals of a served robot."""

from __future__ import annotations

from typing import Final

from elitescript.controller.modes import SWITCH_ON
from elitescript.messages.events import Alarm, Event, Warned
from elitescript.records import replace
from elitescript.said import replaced

VERBS_OF: Final = {
    SWITCH_ON: "brakes",
    "(signal emergency_stop to False)": "release",
    "(unlock_protective_stop)": "unlock",
    "(restart_safety)": "restart",
}
"""Advice of the machine, and the verb of `ctl` that does it."""


def with_verbs(text: str) -> str:
    """Return a text of the machine with the call of `ctl` behind each piece of advice."""
    for words, verb in VERBS_OF.items():
        how = f"(`elitescript ctl {verb}`)"
        text = replaced(text, words, how if words.startswith("(") else f"{words} {how}")
    return text


def served(event: Event) -> Event:
    """Return an event of a served robot with the verbs of `ctl` in its advice."""
    if isinstance(event, Warned):
        return replace(event, text=with_verbs(event.text), hint=with_verbs(event.hint))
    if isinstance(event, Alarm):
        details = dict(event.details)
        if "hint" in details:
            details["hint"] = with_verbs(details["hint"])
        if "hints" in details:
            details["hints"] = [with_verbs(hint) for hint in details["hints"]]
        return replace(event, text=with_verbs(event.text), details=details)
    return event
