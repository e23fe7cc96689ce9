"""Settings for every test."""

from __future__ import annotations

from hypothesis import settings

pytest_plugins = ["pytester", "tests.findings", "tests.specification.plugin"]

# The same examples in every run, on every machine; a shared machine is no reason to fail.
settings.register_profile("elitescript", derandomize=True, deadline=None, database=None)
settings.load_profile("elitescript")
