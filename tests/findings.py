"""What long sweeps and comparisons have found, kept as a record for the documents.

A test says with the fixture `finding` what it tried, how, and what was the nearest to a limit. With
`ELITESCRIPT_RECORD=FILE` the session leaves all of it in that file, as JSON, together with the date and the versions.
"""

from __future__ import annotations

import json
import os
import platform
from collections.abc import Callable
from datetime import date
from pathlib import Path
from time import monotonic

import pytest

from elitescript import __version__

Finding = Callable[[str, str, str], None]

_FOUND = pytest.StashKey[dict[str, dict[str, str]]]()
_BEGAN = pytest.StashKey[float]()


def pytest_configure(config: pytest.Config) -> None:
    """Begin with an empty record."""
    config.stash[_FOUND] = {}
    config.stash[_BEGAN] = monotonic()


@pytest.fixture
def finding(request: pytest.FixtureRequest) -> Finding:
    """Called with what was tried, how (how often, or against which package), and what was found.

    Of several notes on the same subject the last one stays.
    """

    def note(what: str, how: str, found: str) -> None:
        request.config.stash[_FOUND][what] = {"what": what, "how": how, "found": found}

    return note


def pytest_sessionfinish(session: pytest.Session) -> None:
    """Leave the record, if one is asked for."""
    path = os.environ.get("ELITESCRIPT_RECORD")
    reporter = session.config.pluginmanager.get_plugin("terminalreporter")
    if not path or reporter is None:
        return
    counts = {name: len(reporter.stats.get(name, [])) for name in ("passed", "failed", "error", "skipped")}
    record = {
        "date": date.today().isoformat(),
        "version": __version__,
        "cases": os.environ.get("ELITESCRIPT_INVARIANTS", ""),
        "python": f"Python {platform.python_version()}",
        "passed": counts["passed"],
        "failed": counts["failed"] + counts["error"],
        "skipped": counts["skipped"],
        "minutes": round((monotonic() - session.config.stash[_BEGAN]) / 60.0, 1),
        "findings": list(session.config.stash[_FOUND].values()),
    }
    Path(path).write_text(json.dumps(record, indent=2, ensure_ascii=False) + "\n", encoding="utf-8", newline="\n")
