from __future__ import annotations

import pytest

from tests.lint.checking import body


@pytest.mark.parametrize(
    "lines",
    [
        (
            "import threading",
            "lock = threading.Lock()",
            "def count():",
            "  lock.acquire()",
            "end",
            "count()",
            "count()",
            "with lock:",
            "  sync()",
            "end",
        ),
        (
            "from threading import Lock",
            "lock = Lock()",
            "lock.acquire()",
            "while True:",
            "  with lock:",
            "    sync()",
            "  end",
            "end",
        ),
        (
            "import threading",
            "lock = threading.Lock()",
            "def w():",
            "  lock.acquire()",
            "  if get_flag(0):",
            "    return",
            "  end",
            "  lock.release()",
            "end",
            "w()",
        ),
    ],
    ids=str,
)
def test_it_is_found(lines):
    assert [problem.split()[0] for problem in body(*lines)] == ["W238"]


@pytest.mark.parametrize(
    "lines",
    [
        (
            "import threading",
            "lock = threading.Lock()",
            "with lock:",
            "  sync()",
            "end",
        ),
        (
            "import threading",
            "lock = threading.Lock()",
            "lock.acquire()",
            "sync()",
            "lock.release()",
        ),
        (
            "import threading",
            "lock = threading.Lock()",
            "if lock.acquire(False):",
            "  sync()",
            "end",
        ),
        (
            "import threading",
            "lock = threading.Lock()",
            "def w():",
            "  lock.acquire()",
            "  try:",
            "    if get_flag(0):",
            "      return",
            "    end",
            "  finally:",
            "    lock.release()",
            "  end",
            "end",
            "w()",
        ),
        (
            "import threading",
            "lock = threading.Lock()",
            "def w():",
            "  lock.acquire()",
            "  if get_flag(0):",
            "    lock.release()",
            "    return",
            "  end",
            "  lock.release()",
            "end",
            "w()",
        ),
    ],
    ids=str,
)
def test_what_almost_is_one_is_not_found(lines):
    assert "W238" not in [problem.split()[0] for problem in body(*lines)]
