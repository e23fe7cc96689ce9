"""What this debug adapter can do: the answer to `initialize`."""

from __future__ import annotations

from typing import Any, Final

from elitescript.assist.completion import TRIGGERS
from elitescript.debugger.api import ALARM_FILTER, WARNING_FILTER

CAPABILITIES: Final[dict[str, Any]] = {
    "supportsConfigurationDoneRequest": True,
    "supportsFunctionBreakpoints": True,
    "supportsConditionalBreakpoints": True,
    "supportsHitConditionalBreakpoints": True,
    "supportsEvaluateForHovers": True,
    "supportsStepBack": True,
    "supportsSetVariable": True,
    "supportsRestartRequest": True,
    "supportsGotoTargetsRequest": True,
    "supportsStepInTargetsRequest": True,
    "supportsCompletionsRequest": True,
    "completionTriggerCharacters": list(TRIGGERS),
    "supportsExceptionInfoRequest": True,
    "supportTerminateDebuggee": True,
    "supportsLoadedSourcesRequest": True,
    "supportsLogPoints": True,
    "supportsSetExpression": True,
    "supportsTerminateRequest": True,
    "supportsDataBreakpoints": True,
    "supportsCancelRequest": True,
    "supportsBreakpointLocationsRequest": True,
    "supportsClipboardContext": True,
    "exceptionBreakpointFilters": [
        {
            "filter": ALARM_FILTER,
            "label": "Alarms",
            "description": "Stop at an alarm that ends the program, with the calls that led to it; `finally` has run.",
            "default": True,
        },
        {"filter": WARNING_FILTER, "label": "Warnings", "description": "Stop at each warning.", "default": False},
    ],
}
