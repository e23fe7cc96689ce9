"""Lists the modules that a program can import, by how they are provided.

Plain data, shared by the checker and the runtime.
"""

from __future__ import annotations

from typing import Final

SHARED: Final = frozenset(
    "base64 binascii bisect cmath copy decimal hashlib heapq math operator struct".split()  # noqa: SIM905
)
"""Functions and immutable classes of the installed module itself."""

COPIED: Final = frozenset(
    """
    collections collections.abc dataclasses datetime enum fractions functools json queue statistics string textwrap
    threading
    """.split()  # noqa: SIM905
)
"""Private copies of the installed module, one for each run."""

OWN: Final = frozenset(
    "elicopy itertools os os.path random re signal subprocess sys time typing".split()  # noqa: SIM905
)
"""Small modules in virtual time and over virtual processes."""

AVAILABLE: Final = SHARED | COPIED | OWN
"""Every name that `import` finds."""

NETWORK: Final = frozenset(("http", "socket", "ssl", "urllib", "xmlrpc"))
"""Packages that are refused because commands of the robot do their work."""
