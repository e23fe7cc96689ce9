"""Unrestricted Python in the jail; in a process of its own, which is locked in for good."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from elitescript.services.child import jail
from tests.services import hostile

ROOT = Path(__file__).resolve().parent.parent.parent

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="the jail needs Linux")


def outcome(how: str) -> dict[str, object]:
    environment = {**os.environ, "PYTHONPATH": str(ROOT / "src")}
    done = subprocess.run(
        [sys.executable, hostile.__file__, how],
        env=environment,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=False,
        timeout=30,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1])


@pytest.fixture(scope="module")
def jailed():
    return outcome("jail")


@pytest.fixture(scope="module")
def free():
    return outcome("free")


class TestJail:
    def test_has_all_its_layers(self, jailed):
        missing = [f"{name}: {detail}" for name, is_active, detail in jailed["layers"] if not is_active]
        if missing:
            pytest.skip("; ".join(missing))
        assert len(jailed["layers"]) == 5

    @pytest.mark.parametrize("name", hostile.ACTIONS)
    def test_refuses(self, jailed, name):
        missing = [f"{layer}: {detail}" for layer, is_active, detail in jailed["layers"] if not is_active]
        if not jailed["results"][name] and missing:
            pytest.skip("; ".join(missing))
        assert jailed["results"][name]

    def test_lets_the_standard_library_load(self, jailed):
        assert jailed["sum"] == "2"

    @pytest.mark.parametrize("name", hostile.HARMLESS_WHEN_FREE)
    def test_is_what_refuses(self, free, name):
        """The control: outside the jail the same action works."""
        assert free["results"][name] == ""


class TestCopies:
    """A process that may leave copies of itself."""

    def test_only_that_is_allowed(self):
        found = outcome("copies")
        missing = [f"{layer}: {detail}" for layer, is_active, detail in found["layers"] if not is_active]
        if missing:
            pytest.skip("; ".join(missing))
        assert {name for name in hostile.ACTIONS if not found["results"][name]} == {
            "fork",
            "socket_pair",
            "many_descriptors",
        }


class TestConnections:
    """A process that may connect to other computers."""

    def test_only_that_is_allowed(self):
        found = outcome("connections")
        missing = [f"{layer}: {detail}" for layer, is_active, detail in found["layers"] if not is_active]
        if missing:
            pytest.skip("; ".join(missing))
        assert {name for name in hostile.ACTIONS if not found["results"][name]} == {
            "tcp_socket",
            "udp_socket",
            "start_a_thread",
            "many_descriptors",
        }


class TestReport:
    def test_says_why_a_layer_is_missing(self, monkeypatch):
        def fail() -> str:
            raise OSError(38, "Landlock: Function not implemented")

        layer = jail._tried("files", fail)
        assert not layer.is_active
        assert "not implemented" in layer.detail
        assert not jail.is_complete([layer])

    def test_says_that_it_needs_linux(self, monkeypatch):
        monkeypatch.setattr(sys, "platform", "darwin")
        assert jail._tried("system calls", lambda: "active") == ("system calls", False, "needs Linux, this is darwin")

    def test_names_only_places_of_the_interpreter_as_readable(self):
        places = jail.own_modules()
        assert str(ROOT / "src" / "elitescript") in places
        assert not {"/", "/etc", "/home", "/root", "/tmp", "/proc", str(ROOT)} & set(places)
