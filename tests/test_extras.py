"""The packages of extras: one table, one hint, whatever needs them and whatever is wrong with them."""

from __future__ import annotations

import importlib.abc
import importlib.machinery
import re
import sys
import tomllib
from collections.abc import Callable
from pathlib import Path

import pytest

from elitescript import extras, page
from elitescript.cli.main import main
from elitescript.environment.local_channels import LocalChannels
from elitescript.errors import UsageError
from elitescript.extras import EXTRAS, is_older, require, state_of
from elitescript.recorder.mcap_file import read_recording
from elitescript.sweep import sweep
from elitescript.sweep.engines.cluster import ClusterEngine
from tests.cli.calls import CALLS as COMMANDS
from tests.cli.calls import prepare

ROOT = Path(__file__).resolve().parent.parent
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
TOOLS = {"dev", "docs", "dist", "node", "browser", "lowest"}
"""Extras of this repository, which no code of the package imports."""
BROUGHT = {
    "_typeshed",
    "greenlet",
    "lsprotocol",
    "cattrs",
    "typing_extensions",
    "mcp_types",
    "pydantic",
    "_pytest",
    "pluggy",
}
"""What the package imports beside the packages of extras: its dependency, and what those bring."""

PROGRAM = "def p():\n  sleep(0.1)\nend\n"

OPTIONS: dict[str, list[list[str]]] = {
    "serial": [
        ["run", "p.script", "--serial", "tool=/dev/null"],
        ["serve", "--serial", "tool=/dev/null", "--port", "all=0"],
    ],
    "ssh": [
        ["serve", "--ssh", "--port", "all=0"],
        ["record", "127.0.0.1", "--fetch-program", "x", "--ssh-password", "x", "--out", "new.mcap"],
        ["shadow", "127.0.0.1", "--fetch-program", "x", "--ssh-password", "x"],
    ],
    "lsp": [["lsp", "--tcp", "0"]],
    "studio": [["serve", "--studio", "--port", "all=0"]],
    "cluster": [["sweep", "p.script", "--runs", "2", "--dask", "tcp://127.0.0.1:1"]],
    "parquet": [
        ["sweep", "p.script", "--runs", "2", "--out", "t.parquet"],
        ["run", "p.script", "--trace", "t.parquet"],
    ],
    "mcap": [["record", "127.0.0.1", "--out", "new.mcap"]],
}
"""Calls with options that need the package of an extra, beside those of the table of all commands."""

BY_MODULE = {module.partition(".")[0]: name for name, extra in EXTRAS.items() for module in extra.modules}
CALLS = [
    *((BY_MODULE[module], list(call.words), call) for call in COMMANDS for module in call.extras if not call.beside),
    *((extra, words, None) for extra, calls in OPTIONS.items() for words in calls),
]
"""Calls that need the package of an extra, each with its row of the table."""

PYTHON: dict[str, Callable[[], object]] = {
    "serial": lambda: LocalChannels({"tool": "/dev/null"}),
    "cluster": lambda: ClusterEngine("tcp://127.0.0.1:1").__enter__(),
    "mcap": lambda: read_recording("r.mcap"),
    "parquet": lambda: sweep("p.script", runs=2, out="t.parquet"),
}


class _Blocked(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """Finds a package that raises an error when it is imported, or none."""

    def __init__(self, name: str, error: Exception | None) -> None:
        self._name, self._error = name, error

    def find_spec(self, name: str, path: object = None, target: object = None) -> object:
        if name.partition(".")[0] != self._name:
            return None
        if self._error is None:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)
        return importlib.machinery.ModuleSpec(name, self, is_package=True)

    def exec_module(self, module: object) -> None:
        assert self._error is not None
        raise self._error


@pytest.fixture
def package(monkeypatch, tmp_path):
    """Give the package of an extra another version, no files, or an error at its import."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "p.script").write_text(PROGRAM)
    (tmp_path / "r.mcap").write_bytes(b"")

    def change(extra: str, version: str | None, error: Exception | None = None, *, is_there: bool = False) -> None:
        found = EXTRAS[extra]
        monkeypatch.setattr(extras, "installed_version", lambda name: version if name == found.package else "99")
        if is_there:
            return
        name = found.modules[0].partition(".")[0]
        for loaded in [loaded for loaded in sys.modules if loaded.partition(".")[0] == name]:
            monkeypatch.delitem(sys.modules, loaded)
        monkeypatch.setattr(sys, "meta_path", [_Blocked(name, error), *sys.meta_path])

    return change


def lowered(version: str) -> str:
    """Return a version that is a bit older."""
    numbers = [int(part) for part in version.split(".")]
    at = max(index for index, number in enumerate(numbers) if number)
    return ".".join(map(str, [*numbers[:at], numbers[at] - 1, 99]))


class TestTheTable:
    def test_pip_asks_for_the_same(self):
        named = {
            name: [requirement.replace(" ", "") for requirement in requirements]
            for name, requirements in PROJECT["optional-dependencies"].items()
            if name not in TOOLS
        }
        assert named == {
            name: [f"{package}>={least}" for package, least in ((extra.package, extra.least), *extra.also)]
            for name, extra in EXTRAS.items()
        }

    def test_the_working_copy_asks_for_nothing_older(self):
        dev = dict(
            re.fullmatch(r"([\w-]+)>=([\d.]+)", text).groups() for text in PROJECT["optional-dependencies"]["dev"]
        )
        for extra in EXTRAS.values():
            assert not is_older(dev[extra.package], extra.least)

    def test_it_has_whatever_the_package_imports(self):
        known = BROUGHT | {module.partition(".")[0] for extra in EXTRAS.values() for module in extra.modules}
        statement = re.compile(r"^ *(?:import|from) ([a-zA-Z_]\w*)(?: import |[.]|$)", re.MULTILINE)
        outside = {}
        for path in sorted((ROOT / "src").rglob("*.py")):
            for name in set(statement.findall(path.read_text(encoding="utf-8"))):
                if name not in sys.stdlib_module_names and name != "elitescript" and name not in known:
                    outside[name] = path.name
        assert outside == {}

    def test_no_other_place_tells_how_to_install(self):
        here = [
            path.name
            for path in sorted((ROOT / "src").rglob("*.py"))
            if re.search(r"pip install(?! 'elitescript\[\w+\]'\"\n)", path.read_text(encoding="utf-8"))
            and path.name not in ("extras.py", "arguments.py")
        ]
        assert here == []


SITUATIONS = {
    "missing": (
        None,
        None,
        "needs {package} {least} or newer, which is not installed: pip install 'elitescript[{extra}]'",
    ),
    "old": ("{older}", None, "{package} {older} is installed; "),
    "broken": (
        "{least}.7",
        AttributeError("module 'x' has no attribute 'y'"),
        "{package} {least}.7 is installed, but importing it fails (AttributeError: module 'x' has no attribute 'y')",
    ),
    "without what it needs": (
        "{least}.7",
        ModuleNotFoundError("No module named 'zzz'", name="zzz"),
        "{package} {least}.7 is installed, but importing it fails (ModuleNotFoundError: No module named 'zzz')",
    ),
}


@pytest.mark.parametrize("situation", SITUATIONS)
@pytest.mark.parametrize(
    ("extra", "words", "call"), CALLS, ids=[f"{extra}-{' '.join(words[:2])}" for extra, words, _ in CALLS]
)
def test_a_call_without_its_package_says_what_it_needs_and_what_is_there(
    extra, words, call, situation, package, capsys, tmp_path
):
    if call is not None:
        prepare(call, tmp_path)
        if call.needs_page and not page.is_built():
            pytest.skip("needs the built page")
    version, error, expected = SITUATIONS[situation]
    found = EXTRAS[extra]
    names = {"extra": extra, "older": lowered(found.least), **found._asdict()}
    package(extra, version and version.format(**names), error)
    assert main(words) == 2
    told = capsys.readouterr().err
    assert expected.format(**names) in told
    if situation == "old":
        assert f"needs {found.least} or newer: pip install '{found.package}>={found.least}'" in told
    assert len(told.splitlines()) == 1


@pytest.mark.parametrize("situation", SITUATIONS)
@pytest.mark.parametrize("extra", PYTHON)
def test_so_does_a_call_from_python(extra, situation, package):
    version, error, expected = SITUATIONS[situation]
    words = {"extra": extra, "older": lowered(EXTRAS[extra].least), **EXTRAS[extra]._asdict()}
    package(extra, version and version.format(**words), error)
    with pytest.raises(UsageError, match=re.escape(expected.format(**words))):
        PYTHON[extra]()


def test_every_extra_has_a_call():
    assert {extra for extra, *_ in CALLS} == set(EXTRAS) - {"pytest"}


@pytest.mark.parametrize("extra", EXTRAS)
def test_the_lowest_version_is_enough(extra, package):
    package(extra, EXTRAS[extra].least, is_there=True)
    assert state_of(extra) == "installed"


def test_doctor_tells_what_is_too_old(package, capsys):
    package("mcp", "1.30.0", is_there=True)
    assert state_of("mcp") == "too old (mcp 1.30.0, needs 2.0)"


def test_a_package_that_pip_has_not_installed_is_taken(package):
    package("serial", None, is_there=True)
    require("serial")


@pytest.mark.parametrize(
    ("version", "least", "older"),
    [
        ("1.30.0", "2.0", True),
        ("2.0", "2.0", False),
        ("2", "2.0", False),
        ("2.0.0", "2.0", False),
        ("2.0.0rc1", "2.0", True),
        ("2.0.0.dev3", "2.0", True),
        ("2.0.post1", "2.0", False),
        ("2.0+local", "2.0", False),
        ("2.1b1", "2.0", False),
        ("10.0", "9.5", False),
        ("1!1.0", "2.0", True),
        ("2026.10.0", "2026.9", False),
        ("unknown", "2.0", False),
    ],
)
def test_versions_are_compared_by_their_numbers(version, least, older):
    assert is_older(version, least) is older
