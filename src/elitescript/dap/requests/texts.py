"""Texts of programs: `loadedSources`, and `source` for those without a file."""

from __future__ import annotations

from typing import Final

from elitescript.dap.adapter import Adapter, Handler
from elitescript.dap.messages import REFUSED, Arguments, Body, RequestError
from elitescript.dap.states import WITH_PROGRAM, WhileRunning


def loaded_sources(adapter: Adapter, _: Arguments) -> Body:
    """Return the texts that are debugged."""
    return {"sources": [adapter.sources.shown(name) for name in adapter.debuggee.texts()]}


def source(adapter: Adapter, arguments: Arguments) -> Body:
    """Return a text: as it was when it was launched."""
    reference = arguments.number("sourceReference", 0)
    name = adapter.sources.numbered(reference) or adapter.sources.named(arguments.inner("source"))
    if name is None:
        raise RequestError(REFUSED, "there is no such text")
    return {"content": adapter.debuggee.text_of(name)}


HANDLERS: Final = {
    "loadedSources": Handler(loaded_sources, WITH_PROGRAM, WhileRunning.INTERRUPT),
    "source": Handler(source, WITH_PROGRAM, WhileRunning.INTERRUPT),
}
