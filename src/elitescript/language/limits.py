"""Bounds of the text of a program, known before it is parsed."""

from __future__ import annotations

from typing import Final

MAX_UNIT_BYTES: Final = 16 * 1024 * 1024
"""Bytes of a program."""
