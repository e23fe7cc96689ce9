"""Cases: runs that failed, as files that a person can read and edit, and that `run --case` and pytest play again.

# the program waited in line 12 for ever
program = "cell.script"             # relative to this file
digest = "0c1d5e2f9a3b4c6d"         # of its text
world = "cell.toml"
run = 17
seed = 9241874192837412             # of this run
version = "1.0.0"
until_s = 60.0

[options]                           # of the robot
model = "CS66"

[set]                               # what was varied
"box.0.x" = 0.41

[[fault]]                           # as in a world file; also [[stop]] and [[person]]
kind = "drop"
on = 5000
at_s = 3.0
count = 1
direction = "to_robot"

[expect]
property = "never_stuck"
state = "time_limit"
line = 12
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterable, Mapping, Sequence
from errno import EEXIST
from pathlib import Path
from typing import Any, Final

from elitescript import __version__
from elitescript.environment.start_values import parse_settings
from elitescript.errors import UsageError
from elitescript.kernel.options import OPTIONS
from elitescript.messages.signals import Value
from elitescript.outputs.writing import write_file
from elitescript.paths import real_path
from elitescript.records import field, record
from elitescript.shown import encodable, with_bytes
from elitescript.sweep.chaos.applying import check, disturbance_of, in_order, settings_of
from elitescript.sweep.chaos.kinds import KINDS, is_fault
from elitescript.sweep.plans.plan import Choices, Disturbance, Failure
from elitescript.sweep.plans.toml_text import TomlText
from elitescript.untrusted.files import CASE, read_text

SUFFIX: Final = ".case.toml"
FILE_NAME: Final = "CASE.toml"
"""Names of cases: this one, and those that end so."""

SECTIONS: Final = ("fault", "stop", "person")
_KEYS: Final = (
    "program",
    "digest",
    "world",
    "task_dir",
    "run",
    "seed",
    "sweep_seed",
    "version",
    "until_s",
    "step_s",
    "settings",
    "options",
    "set",
    "plain",
    *SECTIONS,
    "expect",
)
_EXPECTED: Final = ("property", "state", "code", "line", "text")
_INT_MAX: Final = 2**63 - 1


@record
class Case:
    """One run that failed, and what it takes to play it again.

    Attributes:
        program: path, from the folder of the case.
        failure: what is expected to come again.
        digest: of the text of the program.
        run: its number in the sweep.
        seed: of the run.
        values: what was varied, by name.
        disturbances: in the order of time.
        world: path of the world file; empty without one.
        task_dir: path of the task folder; empty for that of the program.
        options: of the robot; the path of an own arm is from the folder of the case.
        settings: `NAME=VALUE`, as of `--set`.
        plain: values of the same names in the plain run of the sweep.
        sweep_seed: of the sweep, and so of that run.
        until_s: limit of virtual time, s.
        step_s: time between two rows that properties over time see, s; None for each tick.
        version: of elitescript that has written it.
    """

    program: str
    failure: Failure
    digest: str = ""
    run: int = 0
    seed: int = 0
    values: Mapping[str, Value | str] = field(default_factory=dict)
    disturbances: tuple[Disturbance, ...] = ()
    world: str = ""
    task_dir: str = ""
    options: Mapping[str, Any] = field(default_factory=dict)
    settings: tuple[str, ...] = ()
    until_s: float | None = None
    step_s: float | None = None
    plain: Mapping[str, Value | str] = field(default_factory=dict)
    sweep_seed: int = 0
    version: str = __version__

    @property
    def choices(self) -> Choices:
        """What makes the run differ from the others of its sweep."""
        return Choices(self.run, self.seed, self.values, self.disturbances)


def is_case(name: str) -> bool:
    """Return whether a file is a case, by its name."""
    return name == FILE_NAME or name.endswith(SUFFIX)


def digest_of(program: str) -> str:
    """Return 16 hexadecimal digits of a text, whatever its line ends."""
    return hashlib.sha256(program.replace("\r\n", "\n").encode("utf-8", "surrogatepass")).hexdigest()[:16]


# ---------------------------------------------------------------- reading


def read_case(path: str | Path) -> Case:
    """Return the case of a file.

    Raises:
        UsageError: no such file, or what makes no sense in it; the text names file and line.
    """
    return case_of(read_text(path, CASE), str(path))


def case_of(text: str, file: str) -> Case:
    """Return the case of a text.

    Args:
        text: TOML.
        file: its name, for messages.

    Raises:
        UsageError: something makes no sense; the text names file and line.
    """
    toml = TomlText(text, file, CASE.noun)
    toml.check_keys((), _KEYS)
    toml.check_keys(("expect",), _EXPECTED)
    if "expect" not in toml.tables:
        raise toml.error(("expect",), "is missing; it says which property fails: [expect], property = ...")
    failure = Failure(
        toml.text(("expect", "property")),
        toml.text(("expect", "state"), ""),
        toml.text(("expect", "code"), ""),
        toml.whole(("expect", "line"), 0, _INT_MAX, 0),
        text=toml.text(("expect", "text"), ""),
    )
    options = dict(toml.table(("options",)))
    for name in options:
        if name not in OPTIONS or OPTIONS[name].kind is None:
            raise toml.unknown(("options", name), [name for name, row in OPTIONS.items() if row.kind is not None])
    settings = toml.value(("settings",)) or []
    if not isinstance(settings, list) or not all(isinstance(item, str) for item in settings):
        raise toml.error(("settings",), f'must be a list such as ["standard_digital_in[3]=true"], got {settings!r:.60}')
    try:
        parse_settings(settings, "")
    except UsageError as error:
        raise toml.error(("settings",), str(error).strip()) from None
    return Case(
        with_bytes(toml.text(("program",))),
        failure,
        toml.text(("digest",), ""),
        toml.whole(("run",), 0, _INT_MAX, 0),
        toml.whole(("seed",), -_INT_MAX, _INT_MAX, 0),
        _values(toml, "set"),
        in_order(_disturbances(toml)),
        with_bytes(toml.text(("world",), "")),
        with_bytes(toml.text(("task_dir",), "")),
        options,
        tuple(settings),
        _seconds(toml, "until_s"),
        _seconds(toml, "step_s"),
        _values(toml, "plain"),
        toml.whole(("sweep_seed",), -_INT_MAX, _INT_MAX, 0),
        toml.text(("version",), ""),
    )


def _values(toml: TomlText, section: str) -> dict[str, Value | str]:
    values = dict(toml.table((section,)))
    for name, value in values.items():
        if not isinstance(value, bool | int | float | str):
            raise toml.error((section, name), f"must be a number, true, false or a text, got {value!r:.60}")
    return values


def _seconds(toml: TomlText, key: str) -> float | None:
    return None if toml.value((key,)) is None else toml.number((key,), 0.0, 1e9)


def _disturbances(toml: TomlText) -> Iterable[Disturbance]:
    for section in SECTIONS:
        for index, row in enumerate(toml.rows(section)):
            kind = toml.text((section, index, "kind"))
            of_section = [name for name, known in KINDS.items() if known.table == section]
            if kind in KINDS and kind not in of_section:
                raise toml.error((section, index, "kind"), f"{kind} belongs into [[{KINDS[kind].table}]]")
            if kind not in of_section and not (section == "fault" and is_fault(kind)):
                raise toml.unknown((section, index, "kind"), of_section, kind)
            try:
                yield check(disturbance_of(row))
            except UsageError as error:
                key, colon, words = str(error).partition(": ")
                path = (section, index, key) if colon and key in row else (section, index)
                raise toml.error(path, words if colon and key in row else str(error)) from None


# ---------------------------------------------------------------- writing


def text_of(case: Case, story: Sequence[str] = ()) -> str:
    """Return a case as TOML.

    Args:
        case: what is written.
        story: lines of a comment before it.
    """
    out = [f"# {line}".rstrip() for line in story]
    out += [""] if story else []
    rows: dict[str, Any] = {
        "program": case.program,
        "digest": case.digest,
        "world": case.world,
        "task_dir": case.task_dir,
        "run": case.run,
        "seed": case.seed,
        "sweep_seed": case.sweep_seed,
        "version": case.version,
        "until_s": case.until_s,
        "step_s": case.step_s,
        "settings": list(case.settings),
    }
    out += [f"{name} = {toml_value(value)}" for name, value in rows.items() if value not in ("", None, [])]
    for name, table in (("options", case.options), ("set", case.values), ("plain", case.plain)):
        if table:
            out += ["", f"[{name}]", *(f"{_key(key)} = {toml_value(value)}" for key, value in table.items())]
    for disturbance in case.disturbances:
        section = KINDS[disturbance.kind].table if disturbance.kind in KINDS else "fault"
        rows = settings_of(disturbance)
        out += ["", f"[[{section}]]", *(f"{key} = {toml_value(value)}" for key, value in rows.items())]
    failure = case.failure
    expected = {
        "property": failure.expression,
        "state": failure.state,
        "code": failure.code,
        "line": failure.line,
        "text": failure.text,
    }
    out += [
        "",
        "[expect]",
        *(f"{key} = {toml_value(value)}" for key, value in expected.items() if value not in ("", 0)),
    ]
    return "\n".join(out) + "\n"


def write_case(path: Path, case: Case, story: Sequence[str] = ()) -> bool:
    """Write a case, with the story as a comment; return whether its name was free.

    Another sweep may take it at the same moment.

    Raises:
        UsageError: the file cannot be written.
    """
    try:
        write_file(path, text_of(case, story), is_new=True)
    except OSError as error:
        if error.errno == EEXIST:
            return False
        raise UsageError(f"{path}: {error.strerror or error}") from error
    return True


def relative_to(path: str | Path, folder: Path) -> str:
    """Return a path as it is seen from the folder of a case; whole if there is no way, as on another drive."""
    try:
        return Path(os.path.relpath(path, folder)).as_posix()
    except ValueError:
        return real_path(path).as_posix()


def toml_value(value: Any) -> str:
    """Return a value as TOML writes it."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(toml_value, value))}]"
    if isinstance(value, int | float):
        return repr(value)
    if isinstance(value, bytes):
        value = value.decode("latin-1")
    return _quoted(str(value))


def _key(name: str) -> str:
    return name if name.replace("_", "").isalnum() and name.isascii() else _quoted(name)


_ESCAPES: Final = {"\\": "\\\\", '"': '\\"', "\n": "\\n", "\r": "\\r", "\t": "\\t"}


def _quoted(text: str) -> str:
    signs = encodable(text)  # half a surrogate pair is no character of TOML
    return '"' + "".join(_ESCAPES.get(sign) or (sign if sign.isprintable() else _escape(sign)) for sign in signs) + '"'


def _escape(sign: str) -> str:
    number = ord(sign)
    return f"\\u{number:04X}" if number <= 0xFFFF else f"\\U{number:08X}"
