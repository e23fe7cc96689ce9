"""Every request by its name."""

from __future__ import annotations

from typing import Final

from elitescript.dap.adapter import Handler
from elitescript.dap.requests import breakpoints, evaluation, execution, history, inspection, lifecycle, texts

HANDLERS: Final[dict[str, Handler]] = {
    **lifecycle.HANDLERS,
    **breakpoints.HANDLERS,
    **execution.HANDLERS,
    **inspection.HANDLERS,
    **evaluation.HANDLERS,
    **texts.HANDLERS,
    **history.HANDLERS,
}
