"""Locks of files: one process at a time writes to them."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import BinaryIO


def lock(descriptor: int) -> None:
    """Lock an open file until it is closed.

    Raises:
        BlockingIOError: another process has it.
        OSError: the file system has no locks.
    """
    if sys.platform == "win32":
        import msvcrt

        # Behind everything that is in the file: nobody else can write the byte that is locked.
        place = os.lseek(descriptor, 0, os.SEEK_CUR)
        os.lseek(descriptor, 1 << 40, os.SEEK_SET)
        try:
            msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
        except OSError as error:
            raise BlockingIOError(str(error)) from error
        finally:
            os.lseek(descriptor, place, os.SEEK_SET)
    else:
        import fcntl

        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)


def locked(path: Path) -> BinaryIO:
    """Return a file, made if there is none, that is locked until it is closed.

    Raises:
        BlockingIOError: another process has it.
        OSError: it cannot be opened, or the file system has no locks.
    """
    file = path.open("ab")
    try:
        lock(file.fileno())
    except BaseException:
        file.close()
        raise
    return file
