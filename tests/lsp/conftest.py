"""Clients for the tests of the language server."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from io import StringIO

import pytest

pytest.importorskip("pygls", reason="needs the extra lsp")

from elitescript.lsp import background
from tests.lsp.memory_client import MemoryClient


@pytest.fixture
def bare(monkeypatch):
    """A client before `initialize`; nothing runs in the background unless a test wants it."""
    monkeypatch.setattr(background, "QUIET_S", 3600.0)
    client = MemoryClient()
    yield client
    client.close()


@pytest.fixture
def client(bare):
    """A client after `initialize`, which asks for nothing special."""
    bare.initialize()
    return bare


@pytest.fixture
def log() -> Iterator[StringIO]:
    """What is logged. The plugin of pytest for it is off: it takes a tenth of a short test, in every test."""
    text = StringIO()
    handler = logging.StreamHandler(text)
    logging.getLogger().addHandler(handler)
    # Import-linter, which other tests call in this process, switches the loggers off that there are.
    for name in [name for name in logging.root.manager.loggerDict if name.startswith("elitescript.")]:
        logging.getLogger(name).disabled = False
    yield text
    logging.getLogger().removeHandler(handler)
