"""Reads model files: numbers with their sources, in TOML.

In a model file of the package every number stands as `{ value = …, source = "…" }` in SI units, or as
`{ deg = …, source = "…" }` for angles in degrees; `why` may add a reason. The sources are explained once, in
`[sources.<tag>]` tables. Numbers that all arms share stand in `common.toml`; a model file adds to it and may replace
any of its entries.

A file of a user's own arm begins with `base = "CS66"` and holds what differs from that model as plain numbers in SI
units; an angle may stand in degrees under its name with `_deg`. The keys `about`, `evidence` and `date` say once where
its numbers come from.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from importlib import import_module
from math import isfinite, radians
from pathlib import Path
from typing import Any, Final

from elitescript.errors import UsageError, did_you_mean
from elitescript.kinematics.limits import JointVector
from elitescript.records import NamedTuple
from elitescript.untrusted import files as untrusted_files

EVIDENCE: Final = ("documented", "observed", "assumed")
"""Kinds of evidence: written by the maker, seen on a real robot, or chosen here."""

MODEL_FOLDER: Final = Path(__file__).parent
COMMON_FILE: Final = "common.toml"


class NumberSource(NamedTuple):
    """Where a number comes from."""

    source: str
    """Tag of the source, as the model file cites it."""
    evidence: str
    """`documented`, `observed` or `assumed`."""
    why: str
    """Reason or remark of this one number; empty when the source says enough."""
    about: str
    """What the source is."""
    date: str
    """Date or version of the source."""
    trust: str
    """How far it can be trusted, and why."""


class Entry(NamedTuple):
    """One number, or row of numbers, as it stands in a file."""

    file: str
    raw: Any
    in_degrees: bool
    source: str
    why: str


class DataFile:
    """Holds the entries of one model file on top of what it builds on.

    Keys are dotted paths (`arm.d1`, `joints.qd_max`, `links.forearm.mass`).

    Args:
        file: name of the file, for error texts.
        document: its content; it is used up.
        known: keys that a model has.

    Attributes:
        name: of the model; that of the base if the file gives none.
        tables: tables of an own arm that are no numbers of the model (`OTHER_TABLES`), unread.

    Raises:
        UsageError: an entry of the wrong form; the text begins with file and key.
    """

    __slots__ = ("_entries", "_known", "_tags", "file", "name", "tables")

    def __init__(self, file: str, document: dict[str, Any], known: frozenset[str]) -> None:
        self._entries: dict[str, Entry] = {}
        self._tags: dict[str, dict[str, str]] = {}
        self._known = known
        self.file: Final = file
        self.name = ""
        self.tables: Final[dict[str, dict[str, Any]]] = {}
        self._add_document(COMMON_FILE, written_out(COMMON_FILE))
        if "base" in document:
            self._add_own(document)
        else:
            self._refuse_unknown(document)
            self._add_document(file, document)
        if not self.name:
            raise UsageError(
                f'{self.file}: name: missing; a complete model has a name, an arm of your own begins with base = "CS66"'
            )

    def number(self, key: str, *, positive: bool = False) -> float:
        """Return one number in SI units."""
        entry = self._entry(key)
        return self._convert(key, entry, entry.raw, positive)

    def row(self, key: str, count: int, *, positive: bool = False) -> tuple[float, ...]:
        """Return a row of `count` numbers in SI units."""
        entry = self._entry(key)
        if not isinstance(entry.raw, list):
            raise UsageError(f"{entry.file}: {key}: needs {count} numbers in brackets, has {entry.raw!r}")
        if len(entry.raw) != count:
            raise UsageError(f"{entry.file}: {key}: needs {count} numbers, has {len(entry.raw)}")
        return tuple([self._convert(key, entry, raw, positive) for raw in entry.raw])

    def joint_row(self, key: str, *, positive: bool = False) -> JointVector:
        """Return six numbers in SI units, one for each joint."""
        a, b, c, d, e, f = self.row(key, 6, positive=positive)
        return a, b, c, d, e, f

    def vector(self, key: str) -> tuple[float, float, float]:
        """Return three components in SI units."""
        x, y, z = self.row(key, 3)
        return x, y, z

    def __contains__(self, key: str) -> bool:
        return key in self._entries

    def all_keys(self) -> tuple[str, ...]:
        """Return the keys of all entries, sorted."""
        return tuple(sorted(self._entries))

    def refuse_other_keys(self) -> None:
        """Raise UsageError if there is an entry of an unknown key."""
        for key in self._entries:
            if key not in self._known:
                raise UsageError(f"{self._entries[key].file}: {key}: unknown key{did_you_mean(key, self._known)}")

    def source(self, key: str) -> NumberSource:
        """Return the source of an entry.

        Raises:
            UsageError: no such entry.
        """
        entry = self._entries.get(key)
        if entry is None:
            raise UsageError(f"{self.name} has no number {key!r}{did_you_mean(key, self._entries)}")
        tag = self._tags[entry.source]
        return NumberSource(entry.source, tag["evidence"], entry.why, tag["about"], tag["date"], tag["trust"])

    def _entry(self, key: str) -> Entry:
        entry = self._entries.get(key)
        if entry is None:
            raise UsageError(f"{self.file}: {key}: missing")
        return entry

    def _convert(self, key: str, entry: Entry, raw: Any, positive: bool) -> float:
        if isinstance(raw, bool) or not isinstance(raw, (int, float)):
            raise UsageError(f"{entry.file}: {key}: needs a number, has {raw!r}")
        value = float(raw)
        if not isfinite(value):
            raise UsageError(f"{entry.file}: {key}: needs a finite number, has {raw!r}")
        if positive and not value > 0.0:
            raise UsageError(f"{entry.file}: {key}: needs a number above 0, has {raw!r}")
        return radians(value) if entry.in_degrees else value

    def _refuse_unknown(self, document: dict[str, Any]) -> None:
        """Raise UsageError if a complete model has an unknown key outside of its tables."""
        known = {"name", "sources", *(key.partition(".")[0] for key in self._known)}
        for key, item in document.items():
            if key not in known:
                is_model = isinstance(item, str) and item.upper() in known_names()
                meant = "; did you mean 'base'?" if is_model else did_you_mean(key, {*known, "base"})
                raise UsageError(f"{self.file}: {key}: unknown key{meant}")

    def _add_own(self, document: dict[str, Any]) -> None:
        """Add the entries of an own arm: plain numbers on top of its base."""
        base = _text(self.file, "base", document.pop("base"))
        try:
            name, document_of_base = packaged(base)
            self._add_document(name, document_of_base)
        except UsageError as error:
            raise UsageError(f"{self.file}: base: {error}") from None
        self.name = _text(self.file, "name", document.pop("name", self.name))
        tag = {field: _text(self.file, field, document.pop(field, default)) for field, default in _OWN_SOURCE.items()}
        _check_evidence(self.file, "evidence", tag["evidence"])
        self._tags[OWN_SOURCE] = {**tag, "trust": f"as far as {self.file} can be trusted"}
        for name in OTHER_TABLES & document.keys():
            table = document.pop(name)
            if not isinstance(table, dict):
                raise UsageError(f"{self.file}: {name}: needs a table [{name}], has {table!r}")
            self.tables[name] = table
        known = frozenset(self._entries) | _CALIBRATION
        for key, raw in _leaves("", document):
            self._add_plain(key, raw, known)

    def _add_plain(self, key: str, raw: Any, known: frozenset[str]) -> None:
        if isinstance(raw, dict):
            raise UsageError(f"{self.file}: {key}: needs a plain number or a row of numbers, has {raw!r}")
        name = key.removesuffix("_deg")
        in_degrees = name != key
        if name not in known or (in_degrees and name not in ANGLES):
            texts_and_tables = {"base", "name", *_OWN_SOURCE, *OTHER_TABLES}
            near = known | texts_and_tables | {f"{angle}_deg" for angle in ANGLES}
            raise UsageError(f"{self.file}: {key}: unknown key{did_you_mean(key, near)}")
        if name in self._entries and self._entries[name].source == OWN_SOURCE:
            raise UsageError(f"{self.file}: {key}: given twice, in rad and in degrees")
        self._entries[name] = Entry(self.file, raw, in_degrees, OWN_SOURCE, "")

    def _add_document(self, file: str, document: dict[str, Any]) -> None:
        if "name" in document:
            self.name = _text(file, "name", document.pop("name"))
        sources = document.pop("sources", {})
        if not isinstance(sources, dict):
            raise UsageError(f"{file}: sources: needs tables [sources.<tag>], has {sources!r}")
        for tag, text in sources.items():
            if not isinstance(text, dict):
                raise UsageError(f"{file}: sources.{tag}: needs a table, has {text!r}")
            for field in ("evidence", "about", "date", "trust"):
                if field not in text:
                    raise UsageError(f"{file}: sources.{tag}.{field}: missing")
                _text(file, f"sources.{tag}.{field}", text[field])
            _check_evidence(file, f"sources.{tag}.evidence", text["evidence"])
            self._tags[tag] = text
        self._add_table(file, "", document)

    def _add_table(self, file: str, prefix: str, table: dict[str, Any]) -> None:
        for name, item in table.items():
            key = prefix + name
            if not isinstance(item, dict):
                raise UsageError(f'{file}: {key}: needs the form {{ value = …, source = "…" }}, has {item!r}')
            if "value" not in item and "deg" not in item and "source" not in item:
                self._add_table(file, key + ".", item)
                continue
            in_degrees = "deg" in item
            if in_degrees == ("value" in item) or not item.keys() <= _ENTRY_FIELDS:
                raise UsageError(f"{file}: {key}: needs `value` or `deg`, `source`, and if wanted `why`, has {item!r}")
            source = item.get("source")
            if source is None:
                raise UsageError(f"{file}: {key}: no source; say where the number comes from")
            if source not in self._tags:
                raise UsageError(f"{file}: {key}: unknown source {source!r}{did_you_mean(str(source), self._tags)}")
            raw = item["deg"] if in_degrees else item["value"]
            self._entries[key] = Entry(file, raw, in_degrees, source, item.get("why", ""))


NAME_MAX: Final = 255
"""Bytes of the name of a model, and of each part of the path of a file, as most systems have it."""
PATH_MAX: Final = 4096

UNPUBLISHED: Final[Mapping[str, str]] = {
    "CS68": "CS66",
    "CS616-9": "CS616",
    "CS618": "CS616",
    "CS630": "CS625",
    "CS66A": "CS66",
    "CS66AZ": "CS66",
    "CS610A": "CS612",
    "CS612A": "CS612",
    "CS612AZ": "CS612",
    "CS56H": "CS66",
    "CS520H": "CS620",
    "CS525H": "CS625",
    "CS530H": "CS625",
}
"""Arms that the vendor's simulator names and whose numbers are not public, each with the known arm whose payload
is nearest, from which an own arm file may go on."""


def known_names() -> tuple[str, ...]:
    """Return the names of the models that come with the package, small arms first."""
    stems = (path.stem.upper() for path in MODEL_FOLDER.glob("*.toml") if path.name != COMMON_FILE)
    return tuple(sorted(stems, key=lambda stem: (len(stem), stem)))


def packaged(name: str) -> tuple[str, dict[str, Any]]:
    """Return file name and content of a model that comes with the package; capitals do not matter.

    Raises:
        UsageError: no such model.
    """
    check_name(name)
    names = known_names()
    if name.upper() in names:
        file = f"{name.lower()}.toml"
        return file, written_out(file)
    if (arm := name.upper().replace("_", "-")) in UNPUBLISHED:
        raise UsageError(
            f"the arm {arm} exists, but its lengths and limits are not public, so there is no robot model {name!r}; "
            f'with your own numbers write an arm file: base = "{UNPUBLISHED[arm]}" and what differs, such as '
            "[arm] d6 = 0.095; then --robot my_arm.toml (`elitescript fit` finds lengths from taught points; models: "
            f"{', '.join(names)})"
        )
    raise UsageError(
        f"there is no robot model {name!r}{did_you_mean(name.upper(), names)} (models: {', '.join(names)})"
    )


def check_name(name: str) -> None:
    """Refuse what is neither the name of a model nor the path of a file, before anything is looked for.

    Args:
        name: as it was given on a command line, in a file, in a message.

    Raises:
        UsageError: it is too long, or has a character that no name has.
    """
    strange = next((character for character in name if not character.isprintable()), "")
    if strange:
        raise UsageError(f"the name of a robot is one line of text: {_begin(name)!r} has {strange!r}")
    parts = name.replace("\\", "/").split("/")
    if len(name) > PATH_MAX or any(len(part.encode()) > NAME_MAX for part in parts):
        raise UsageError(
            f"the name of a robot has at most {NAME_MAX} bytes, the path of its file {PATH_MAX} characters: "
            f"{_begin(name)!r}... has {len(name)}"
        )


def _begin(name: str) -> str:
    return name[:40]


def written_out(file: str) -> dict[str, Any]:
    """Return the content of a model file of the package, from the module that `make reference` writes of it.

    Reading the TOML would take longer than all else that a model needs.
    """
    document: dict[str, Any] = import_module(f"elitescript.models.tables.{file.replace('.', '_')}").document()
    return document


def read_text(path: Path) -> str:
    """Return the content of a model file.

    Raises:
        UsageError: it cannot be read, is too large for a model file or is not UTF-8.
    """
    check_name(str(path))
    return untrusted_files.read_text(path, untrusted_files.ARM, is_stream_allowed=True)


_ENTRY_FIELDS: Final = frozenset(("value", "deg", "source", "why"))

OWN_SOURCE: Final = "own-arm"
"""Source tag of every number in the file of an own arm."""

_OWN_SOURCE: Final = {"about": "file of an own arm", "date": "unknown", "evidence": "assumed"}
"""Keys of an own arm about its numbers, with their defaults."""

OTHER_TABLES: Final = frozenset(("plant",))
"""Tables of an own arm that are settings of the robot, not numbers of the model."""

_CALIBRATION: Final = frozenset(("calibration.a", "calibration.d", "calibration.alpha"))

ANGLES: Final = frozenset(
    (
        "home",
        "default_joint_speed",
        "default_joint_acceleration",
        "planning_joint_acceleration",
        "stop_joint_deceleration",
        "joints.q_min",
        "joints.q_max",
        "joints.qd_max",
        "joints.qdd_max",
        "calibration.alpha",
    )
)
"""Keys of angles, angular speeds and accelerations, which an own arm may give in degrees."""


def _leaves(prefix: str, table: dict[str, Any]) -> Iterator[tuple[str, Any]]:
    for name, item in table.items():
        if isinstance(item, dict) and not item.keys() & {"value", "deg", "source"}:
            yield from _leaves(f"{prefix}{name}.", item)
        else:
            yield prefix + name, item


def _check_evidence(file: str, key: str, evidence: str) -> None:
    if evidence not in EVIDENCE:
        raise UsageError(f"{file}: {key}: has {evidence!r}, needs one of {', '.join(EVIDENCE)}")


def parsed(file: str, text: str) -> dict[str, Any]:
    """Return the content of a model file from its text.

    Raises:
        UsageError: not TOML.
    """
    # Not at the top: the parser takes longer to import than a model to load.
    from elitescript.untrusted.toml_text import toml_tables

    return toml_tables(text, file, untrusted_files.ARM.noun)


def _text(file: str, key: str, value: Any) -> str:
    if not isinstance(value, str) or not value:
        raise UsageError(f"{file}: {key}: needs a text, has {value!r}")
    return value
