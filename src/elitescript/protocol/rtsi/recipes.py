"""Recipes of RTSI: variables, order and rate of packages; and the state that clients share.

A recipe is prepared once, as a compiled layout and a list of readers, so that a package is cheap. Clients with the same
variables get the same bytes, which are packed once in a tick.
"""

from __future__ import annotations

import struct
from collections.abc import Iterable
from operator import attrgetter, is_
from typing import Final

from elitescript.messages.outputs import Output
from elitescript.messages.snapshot import Snapshot
from elitescript.messages.snapshot_parts import TIME
from elitescript.messages.timing import TICKS_PER_S
from elitescript.protocol.binary import Field, FieldList, Number, WireValue
from elitescript.protocol.rtsi.inputs import INPUTS, effects_of
from elitescript.protocol.rtsi.variables import OUTPUTS, Reader

FREQUENCY_MIN_HZ: Final = 1.0
FREQUENCY_MAX_HZ: Final = 250.0
"""*Documented*; that a frequency outside is clamped is *assumed*."""

HEAD: Final = struct.Struct(">HBB")
"""Size of the message, command, number of the recipe."""

SAID_MAX: Final = 100
"""Texts about clients that are remembered."""

DATA_PACKAGE: Final = ord("U")


_discrete_state: Final = attrgetter(
    "robot.robot_mode",
    "robot.safety_mode",
    "robot.task_state",
    "robot.tcp_offset",
    "robot.payload",
    "robot.gravity",
    "robot.speed_scale",
    "joint_voltages",
    "robot_voltage",
    "io_current",
    "tool_current",
    "signals",
    "domains",
    "tool_analog_mode",
    "tool_pin_modes",
    "is_remote",
    "is_freedrive",
    "popup",
    "task",
    "is_guided_by_input",
)
"""Returns what of a snapshot is in no part; see `messages.snapshot_parts`."""
_UNKNOWN: Final[tuple[object, ...]] = (object(),)
_NEVER: Final = 1 << 62
"""A tick that does not come."""


class RecipeSchedule:
    """Ticks at which a recipe is due, exact for any frequency.

    In any n ticks after the first package there are floor(n * frequency / 250) more.

    Args:
        frequency_hz: 1 to 250.
    """

    __slots__ = ("_denominator", "_due", "_numerator", "_start")

    def __init__(self, frequency_hz: float) -> None:
        numerator, denominator = frequency_hz.as_integer_ratio()
        self._numerator = numerator
        self._denominator = denominator * TICKS_PER_S
        self._start = _NEVER
        """Tick of the first package."""
        self._due = 0
        """First tick at which the next one is due."""

    def reset(self) -> None:
        """Start again: a package is due at the next tick."""
        self._start, self._due = _NEVER, 0

    def will_be_due(self, tick: int) -> bool:
        """Return whether `is_due` will be True for this tick."""
        return not self._start <= tick < self._due

    def is_due(self, tick: int) -> bool:
        """Return whether a package is due at this tick, once; missed packages are not made up for."""
        if self._start <= tick < self._due:
            return False
        self._start = min(self._start, tick)
        count = (tick - self._start) * self._numerator // self._denominator
        self._due = self._start - (-(count + 1) * self._denominator // self._numerator)
        return True

    def falls_on(self, tick: int) -> bool:
        """Return whether a package falls on this tick after the first, whether it has been asked for or not."""
        since = tick - self._start
        return since * self._numerator // self._denominator > (since - 1) * self._numerator // self._denominator

    def next_tick(self, tick: int) -> int:
        """Return the first tick after `tick` at which a package is due."""
        return max(self._due, tick + 1)


class OutputRecipe:
    """Variables that are sent to a client.

    Args:
        ident: number of the recipe, 1 to 254.
        names: known names, in the order of the package; a name may come twice.
        frequency_hz: 1 to 250.
    """

    __slots__ = (
        "_changing",
        "_discrete",
        "_discrete_state",
        "_layout",
        "_values",
        "ident",
        "key",
        "names",
        "new_before",
        "newest",
        "parts",
        "schedule",
        "size",
    )

    def __init__(self, ident: int, names: tuple[str, ...], frequency_hz: float) -> None:
        rows = [OUTPUTS[name] for name in names]
        self.ident = ident
        self.names = names
        self.key = f"{ident},{','.join(names)}"
        """The same for recipes with the same packages; other than a tuple of names it is hashed once."""
        self.schedule = RecipeSchedule(frequency_hz)
        self.parts = TIME
        """Of the snapshot, as bits of `messages.snapshot_parts`."""
        for row in rows:
            self.parts |= row.parts
        self.new_before = 0
        """Before this tick it is not sent with an older snapshot."""
        self.newest = b""
        """The last package since `begin`; empty before the first."""
        self._layout = struct.Struct(">" + "".join(row.type.layout for row in rows))
        self._values: list[Number] = []
        """Of the last package; those of the discrete state stay while it does."""
        self._discrete_state: tuple[object, ...] = _UNKNOWN
        self._changing: list[tuple[Reader, int, int]] = []
        """Readers of parts of the snapshot, where their values begin, and where a vector ends; 0 for one value."""
        self._discrete: list[tuple[Reader, int, int]] = []
        """Readers of the discrete state alone; likewise."""
        for row in rows:
            at = len(self._values)
            count = len(struct.unpack(f">{row.type.layout}", bytes(struct.calcsize(f">{row.type.layout}"))))
            self._values += [0] * count
            (self._changing if row.parts else self._discrete).append(
                (row.read, at, at + count if row.type.is_vector else 0)
            )
        self.size = HEAD.size + self._layout.size
        """Size of a package in bytes."""

    def begin(self) -> None:
        """Start anew: a package is due at the next tick."""
        self.schedule.reset()
        self.newest = b""

    def packed(self, output: Output) -> bytes:
        """Return the values at a tick, without head."""
        snapshot = output.snapshot
        state = _discrete_state(snapshot)
        # Equal is not enough: 0.0 and -0.0 have other bytes.
        if not all(map(is_, state, self._discrete_state)):
            self._read(self._discrete, snapshot)
            self._discrete_state = state
        self._read(self._changing, snapshot)
        return self._layout.pack(*self._values)

    def _read(self, readers: list[tuple[Reader, int, int]], snapshot: Snapshot) -> None:
        values = self._values
        for read, at, end in readers:
            if end:
                values[at:end] = read(snapshot)  # type: ignore[assignment]
            else:
                values[at] = read(snapshot)  # type: ignore[assignment]

    def package(self, body: bytes) -> bytes:
        """Return the message with packed values."""
        return HEAD.pack(self.size, DATA_PACKAGE, self.ident) + body


class InputRecipe:
    """Variables that a client sends.

    Args:
        ident: number of the recipe, 1 to 254.
        names: known names, in the order of the package; the last value of a repeated name counts.
    """

    __slots__ = ("_fields", "effects", "ident", "is_looked_at", "names", "size")

    def __init__(self, ident: int, names: tuple[str, ...]) -> None:
        self.ident = ident
        self.names = names
        self._fields = FieldList(*(Field(name, INPUTS[name]) for name in names))
        self.effects = effects_of(names)
        self.is_looked_at = False
        """Whether a package has come, and the log has said what of it has no effect."""
        self.size = HEAD.size + self._fields.size
        """Size of a package in bytes."""

    def values(self, body: bytes) -> dict[str, WireValue]:
        """Return the values of a package by variable.

        Args:
            body: as long as the recipe needs, without head.
        """
        return dict(zip(self.names, self._fields.unpack(body), strict=True))


class InputClaims:
    """Owners of the inputs of a robot: an input belongs to one client at a time."""

    __slots__ = ("_owners",)

    def __init__(self) -> None:
        self._owners: dict[str, str] = {}

    def is_free(self, origin: str, name: str) -> bool:
        """Return whether a client may claim an input: it has no owner, or this one."""
        return self._owners.get(name, origin) == origin

    def owner(self, name: str) -> str:
        """Return the client that has claimed an input; empty if none has."""
        return self._owners.get(name, "")

    def claim(self, origin: str, names: Iterable[str]) -> None:
        """Give free inputs to a client."""
        for name in names:
            self._owners[name] = origin

    def release(self, origin: str) -> None:
        """Release all inputs of a client."""
        for name in [name for name, owner in self._owners.items() if owner == origin]:
            del self._owners[name]


class PackageCache:
    """The packages of the newest tick: the values of recipes, packed once for all clients."""

    __slots__ = ("_bodies", "_output", "_packages")

    def __init__(self) -> None:
        self._output: Output | None = None
        self._bodies: dict[tuple[str, ...], bytes] = {}
        self._packages: dict[str, bytes] = {}

    def package(self, recipe: OutputRecipe, output: Output) -> bytes:
        """Return the package of a recipe at a tick."""
        if output is not self._output:
            self._output = output
            self._bodies, self._packages = {}, {}
        package = self._packages.get(recipe.key)
        if package is None:
            body = self._bodies.get(recipe.names)
            if body is None:
                body = self._bodies[recipe.names] = recipe.packed(output)
            package = self._packages[recipe.key] = recipe.package(body)
        return package


class RtsiPort:
    """State that all clients of one robot's port share."""

    __slots__ = ("_said", "claims", "packages")

    def __init__(self) -> None:
        self.claims = InputClaims()
        self.packages = PackageCache()
        self._said: dict[str, int] = {}
        """Tick at which the log has said a text."""

    def may_say(self, text: str, tick: int) -> bool:
        """Return whether the log may say a text about a client, and note it: not twice within a second."""
        last = self._said.get(text)
        if last is not None and 0 <= tick - last < TICKS_PER_S:
            return False
        if len(self._said) >= SAID_MAX:
            self._said.clear()
        self._said[text] = tick
        return True
