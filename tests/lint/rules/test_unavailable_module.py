from __future__ import annotations

import pytest

from tests.lint.checking import body, found, marked, only


@pytest.mark.parametrize(
    ("line", "column"),
    [
        ("import ctypes", 10),
        ("import math, ctypes as c", 16),
        ("from ctypes import cdll", 3),
        ("import os.environ", 10),
        ("import json.decoder", 10),
        ("from . import math", 3),
    ],
)
def test_a_module_that_programs_do_not_get_is_found(line, column):
    assert body(line) == [f"W213 2:{column}"]


@pytest.mark.parametrize(
    "line",
    [
        "import math, time as t",
        "import os.path",
        "from collections.abc import Sequence",
        "import threading",
        "import elicopy",
    ],
)
def test_the_others_are_left_alone(line):
    assert body(line) == []


def test_also_where_the_refusal_is_caught():
    text = "def job():\n  try:\n    import ctypes\n  except ImportError:\n    textmsg(1)\n  end\nend\n"
    assert found(text) == ["W213 3:12"]
    assert marked(text) == "ctypes"


def test_the_network_has_its_own_hint():
    assert "socket_open" in only("def job():\n  import socket\nend\n").hint
    assert only("def job():\n  import ctypes\nend\n").hint == ""


def test_a_slip_is_recognised():
    assert only("def job():\n  import thraeding\nend\n").hint == "is `threading` meant?"


def test_the_list_is_the_one_that_programs_get():
    from elitescript.language.modules import AVAILABLE
    from elitescript.runtime.names import modules as facades

    assert facades.AVAILABLE == AVAILABLE
