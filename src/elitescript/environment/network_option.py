"""The option `network` as it is written where a robot was made: in a call, a marker, a file or a window."""

from __future__ import annotations

from typing import Final

from elitescript.records import NamedTuple


class Way(NamedTuple):
    """Names the option `network` as it is written where a robot was made; `{}` is the place of the value.

    Attributes:
        named: the option with the value that it has.
        allowing: the option with the value that it needs.
        opens_closed: whether `allowing` lets connections out of closed runs; nothing else does.
    """

    named: str
    allowing: str
    opens_closed: bool = False


COMMAND_LINE: Final = Way("--network {}", "--network {}")
PYTHON: Final = Way('network="{}"', 'network="{}"')
MARKER: Final = Way('network="{}"', '@pytest.mark.elitescript(network="{}")')
COMMENT: Final = Way("network={}", "# elitescript: network={}")
LAUNCH: Final = Way('"network": "{}"', '"network": "{}"')
WORLD_FILE: Final = Way('network = "{}"', '[robot] network = "{}"')
STUDIO: Final = Way('network = "{}"', "Allow connections", opens_closed=True)
