"""Sessions of pytest inside tests: with our plugin alone, and with modules that are not loaded again for each."""

from __future__ import annotations

import pkgutil
from importlib import import_module

import pytest

import elitescript
from elitescript.lint.registry import all_rules

_NOT_USED = ("cli", "dap", "debugger", "lsp", "mcp", "studio", "__main__", "services.ssh", "services.child.__main__")


@pytest.fixture(autouse=True, scope="session")
def loaded_modules():
    """Load what inner sessions use: they forget modules that they load, and a second copy has other classes."""
    for found in pkgutil.walk_packages(elitescript.__path__, "elitescript."):
        if not found.name.removeprefix("elitescript.").startswith(_NOT_USED):
            import_module(found.name)
    all_rules()


@pytest.fixture(autouse=True)
def our_plugin_alone(loaded_modules, monkeypatch):
    """Have inner sessions load no plugin by its entry point, but ours as if by its own."""
    monkeypatch.setenv("PYTEST_DISABLE_PLUGIN_AUTOLOAD", "1")
    monkeypatch.delenv("GITHUB_WORKSPACE", raising=False)
    monkeypatch.setenv("PYTEST_PLUGINS", "elitescript.pytest_plugin.plugin")
