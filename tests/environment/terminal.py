"""A pseudo-terminal in place of a serial port."""

from __future__ import annotations

import os
from select import select


class Terminal:
    """A pseudo-terminal: what is at the far end of the line, and the name of the near one."""

    def __init__(self) -> None:
        # The near end stays open here too: without anybody there, the far end cannot be read.
        self.far, self._near = os.openpty()
        self.name = os.ttyname(self._near)

    def write(self, data: bytes) -> None:
        os.write(self.far, data)

    def read(self, size: int) -> bytes:
        data = b""
        while len(data) < size:
            assert select([self.far], [], [], 10)[0], data
            data += os.read(self.far, size - len(data))
        return data

    def hang_up(self) -> None:
        if self.far >= 0:
            os.close(self.far)
            self.far = -1

    def close(self) -> None:
        self.hang_up()
        os.close(self._near)
