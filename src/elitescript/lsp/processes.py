"""Tells whether a process is still there."""

from __future__ import annotations

import os
import sys


def is_alive(number: int) -> bool:
    """Return whether there is a process with this number."""
    if sys.platform == "win32":
        return _is_alive_on_windows(number)
    try:
        os.kill(number, 0)
    except ProcessLookupError:
        return False
    except (PermissionError, OverflowError):
        return True
    return True


def _is_alive_on_windows(number: int) -> bool:
    """As `is_alive`: there, signal 0 would end the process."""
    import ctypes

    synchronize, timeout = 0x100000, 0x102
    kernel = ctypes.windll.kernel32  # type: ignore[attr-defined,unused-ignore]
    handle = kernel.OpenProcess(synchronize, False, number)
    if not handle:
        return False
    try:
        return bool(kernel.WaitForSingleObject(handle, 0) == timeout)
    finally:
        kernel.CloseHandle(handle)
