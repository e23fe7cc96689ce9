"""The process of `served_robot`: `elitescript serve`, ended when the process of the tests is gone, however that ended.

Its standard input is a pipe of the tests' process, which closes with it.
"""

from __future__ import annotations

import os
import signal
from runpy import run_module
from threading import Thread


def _end_with_input() -> None:
    while os.read(0, 1):
        pass
    os.kill(os.getpid(), signal.SIGTERM)


if __name__ == "__main__":
    Thread(target=_end_with_input, name="end of the tests", daemon=True).start()
    run_module("elitescript", run_name="__main__")
