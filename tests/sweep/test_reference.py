"""The reference run shows what a computer's sine and cosine do in their last bit."""

from __future__ import annotations

import subprocess
import sys

import pytest

from elitescript import __version__
from elitescript.sweep.engines import reference
from elitescript.sweep.engines.reference import platform_here, platform_of_child


def test_a_child_process_is_of_the_same_platform_as_this_one():
    here = platform_here()
    assert here.version == __version__
    assert here.python == f"{sys.version_info.major}.{sys.version_info.minor}"
    assert len(here.digits) == 16
    assert platform_of_child() == here


def test_one_last_bit_changes_the_digest(monkeypatch: pytest.MonkeyPatch):
    before = platform_here().digits
    # 0.3 and the number after it.
    monkeypatch.setattr(reference, "PROGRAM", reference.PROGRAM.replace("x = 0.3\n", "x = 0.30000000000000004\n"))
    assert platform_here().digits != before


def test_a_child_that_fails_says_why(monkeypatch: pytest.MonkeyPatch):
    def run(*_: object, **__: object) -> subprocess.CompletedProcess[bytes]:
        return subprocess.CompletedProcess([], 1, b"", b"no room\n")

    monkeypatch.setattr("elitescript.sweep.engines.reference.subprocess.run", run)
    with pytest.raises(RuntimeError, match="no room"):
        platform_of_child()
