"""Texts of programs: `loadedSources`, and `source` for those without a file."""

from __future__ import annotations

from typing import Final

from elitescript.dap.adapter import Adapter
from elitescript.dap.handler import WITH_PROGRAM, Handler, WhileRunning
from elitescript.dap.messages import REFUSED, Arguments, Body, RequestError


def loaded_sources(adapter: Adapter, _: Arguments) -> Body:
    """Return the texts that are debugged."""
    return {"sources": [adapter.sources.shown(name) for name in adapter.programs()]}


def source(adapter: Adapter, arguments: Arguments) -> Body:
    """Return a text: as it was when it was launched."""
    given = arguments.inner("source")
    reference = arguments.number("sourceReference", 0)
    text = adapter.sources.text(reference) if reference else None
    if text is None:
        named = next((name for name in adapter.programs() if adapter.sources.is_named(given, name)), "")
        text = adapter.text_of(named) if named else None
    if text is None:
        raise RequestError(REFUSED, "there is no such text")
    return {"content": text}


HANDLERS: Final = {
    "loadedSources": Handler(loaded_sources, WITH_PROGRAM, WhileRunning.INTERRUPT),
    "source": Handler(source, WITH_PROGRAM, WhileRunning.INTERRUPT),
}
