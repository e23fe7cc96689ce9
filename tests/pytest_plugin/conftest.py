"""Sessions of pytest inside tests: with our plugin alone, and quick, since the robot is imported before them."""

from __future__ import annotations

import pytest

import elitescript.pytest_plugin.failures
import elitescript.pytest_plugin.measuring
import elitescript.pytest_plugin.script_files
import elitescript.pytest_plugin.served
import elitescript.pytest_plugin.strictness
import elitescript.testing.world  # noqa: F401


@pytest.fixture(autouse=True)
def our_plugin_alone(monkeypatch):
    """Have inner sessions load no plugin by its entry point, but ours as if by its own."""
    monkeypatch.setenv("PYTEST_DISABLE_PLUGIN_AUTOLOAD", "1")
    monkeypatch.setenv("PYTEST_PLUGINS", "elitescript.pytest_plugin.plugin")
