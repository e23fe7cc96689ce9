"""Run the tests of each extra with the lowest versions that it promises: `make lowest` calls `python -m tools.lowest`.

Each extra is installed alone into an environment of its own, so that none leans on what another one brings; a last
environment has all of them. The lowest versions are those of pyproject.toml; what the packages bring is as new as pip
finds it, and the tools of the tests are those of the lock file.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tomllib
import venv
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Final

ROOT: Final = Path(__file__).resolve().parent.parent
FOLDER: Final = ROOT / "build" / "lowest"

SUITES: Final = {
    "serial": (
        "tests/environment/test_serial_channel.py",
        "tests/services/test_serial_ports.py",
        "tests/cli/test_serial.py",
    ),
    "ssh": (
        "tests/services/test_ssh_desk.py",
        "tests/services/test_ssh_server.py",
        "tests/cli/test_ssh_login.py",
        "tests/recorder/test_fetching.py",
    ),
    "lsp": ("tests/lsp",),
    "mcp": ("tests/mcp",),
    "studio": ("tests/studio",),
    "cluster": ("tests/sweep/test_cluster.py",),
    "parquet": ("tests/sweep/test_tables.py", "tests/sweep/test_table_files.py"),
    "optimise": ("tests/sweep/test_optimise.py",),
    "mcap": ("tests/recorder", "tests/audit", "tests/cli/test_audit.py"),
    "pytest": ("tests/pytest_plugin",),
}
"""Tests that need an extra, by its name."""

TOOLS: Final = ("pytest", "pytest-timeout", "pytest-xdist", "hypothesis", "numpy", "coverage")
"""What the tests themselves need."""
MORE_TOOLS: Final = {"lsp": ("pytest-lsp",)}


SETTINGS: Final = """[pytest]
addopts = -p no:logging -p tests.findings --import-mode=importlib -m "not slow"
timeout = 120
elitescript_limit_s = 0
elitescript_wall_limit_s = 600
markers =
    invariants: of the suite
    slow: of the suite
    peers: of the suite
"""
"""Those of the suite need a new pytest, and take warnings of old packages for errors."""


def main(wanted: Sequence[str] = ()) -> int:
    """Install and test; return 1 if a test fails, or if an extra has none that runs.

    Args:
        wanted: names of extras, and `all`; by default everything. `NAME==VERSION` tries another version of a package.
    """
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras: dict[str, list[str]] = {name: project["optional-dependencies"][name] for name in SUITES}
    others = {word.partition("==")[0]: word for word in wanted if "==" in word}
    names = tuple(word for word in wanted if "==" not in word) or (*SUITES, "all")
    verdicts = {}
    for name in names:
        # Together, they are tested by the pytest of the lock file.
        chosen = tuple(each for each in SUITES if each != "pytest") if name == "all" else (name,)
        lowest = [low for each in chosen for low in pinned(extras[each])] + pinned(project["dependencies"])
        lowest = [others.get(low.partition("==")[0], low) for low in lowest]
        verdicts[name] = _tried(name, chosen, lowest)
    print()
    for name, verdict in verdicts.items():
        print(f"{name:<10}{verdict or 'passed'}")
    return 1 if any(verdicts.values()) else 0


def pinned(requirements: Iterable[str]) -> list[str]:
    """Return requirements with the lowest version that each allows, as `mcp==2.0` for `mcp>=2.0`.

    Raises:
        ValueError: one is not of this form.
    """
    found = []
    for requirement in requirements:
        words = re.fullmatch(r"([\w.-]+)\s*>=\s*([\w.]+)", requirement)
        if words is None:
            raise ValueError(f"{requirement}: NAME>=VERSION is needed")
        found.append(f"{words[1]}=={words[2]}")
    return found


def locked(lock: str, names: Iterable[str]) -> list[str]:
    """Return requirements of a lock file, without hashes: those of some packages."""
    return [
        f"{found[1]}=={found[2]}"
        for name in names
        if (found := re.search(rf"^({re.escape(name)})==([\w.]+)", lock, re.MULTILINE))
    ]


def _tried(name: str, chosen: tuple[str, ...], lowest: list[str]) -> str:
    """Install and test extras; return why they do not pass, empty if they do."""
    home = FOLDER / name
    print(f"\n{name}: {', '.join(lowest)}", flush=True)
    venv.create(home, clear=True, with_pip=True)
    python = home / ("Scripts" if sys.platform == "win32" else "bin") / "python"
    tools = [*TOOLS, *(tool for each in chosen for tool in MORE_TOOLS.get(each, ()))]
    pins = {pin.partition("==")[0] for pin in lowest}
    lock = (ROOT / "requirements-dev.lock").read_text(encoding="utf-8")
    constraints = home / "constraints.txt"
    constraints.write_text("\n".join([*lowest, *locked(lock, [tool for tool in tools if tool not in pins])]) + "\n")
    install = [python, "-m", "pip", "install", "-qq", "--disable-pip-version-check", "--constraint", constraints]
    packages = ["--editable", f".[{','.join(chosen)}]", *tools]
    if subprocess.run([*install, *packages], cwd=ROOT, check=False).returncode:
        return "cannot be installed"
    report = home / "report.xml"
    suites = [suite for each in chosen for suite in SUITES[each]]
    settings = home / "pytest.ini"
    settings.write_text(SETTINGS, encoding="utf-8")
    words = [python, "-m", "pytest", "-c", settings, f"--rootdir={ROOT}", "-q", "-p", "no:cacheprovider"]
    words += [f"--junitxml={report}", *suites]
    # An old pytest loads the plugins of conftest.py before its own setting `pythonpath`.
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join((str(ROOT / "src"), str(ROOT)))}
    code = subprocess.run(words, cwd=ROOT, env=environment, check=False).returncode
    if code:
        return f"failed (exit code {code})"
    return "" if _passed(report) else "no test ran"


def _passed(report: Path) -> int:
    """Return how many tests of a report of JUnit's form were run."""
    text = report.read_text(encoding="utf-8")
    tests, skipped = (
        int(found[1]) for found in (re.search(rf'\b{word}="(\d+)"', text) for word in ("tests", "skipped")) if found
    )
    return tests - skipped


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
