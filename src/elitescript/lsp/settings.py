"""Reads the settings of a client: the section `elitescript`, whose values may be anything that somebody has typed."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Final

from elitescript.assist.document import Settings
from elitescript.errors import UsageError
from elitescript.messages.profile import profile
from elitescript.models.model import is_model_file, load_model
from elitescript.records import record
from elitescript.world_file import text_settings

SECTION: Final = "elitescript"


@record
class ClientSettings:
    """The settings of one folder, checked.

    Attributes:
        robot: name of an arm, or path of its file; None for any arm.
        firmware: name of a firmware; None for that of the world file, else the newest.
        world: path of a world file; None without one.
        strict: as `check --strict`; None for what the world file says.
        runs_programs: whether programs are run in the background for hints.
    """

    robot: str | None = None
    firmware: str | None = None
    world: str | None = None
    strict: bool | None = None
    runs_programs: bool = True


def read_settings(given: object, folder: Path | None) -> tuple[ClientSettings, list[str]]:
    """Return the settings of a section and, of each value that makes no sense, why; it is as if it were not there.

    Names are those of the section, with dots or as tables: `{"hints.run": false}` is `{"hints": {"run": false}}`. Other
    names are those of the client itself. None, and an empty text, are no value.

    Args:
        given: what the client has sent.
        folder: relative paths count from it.
    """
    if given is None:
        return ClientSettings(), []
    if not isinstance(given, Mapping):
        return ClientSettings(), [f"{SECTION}: must be a table, got {given!r:.60}"]
    inner = given.get(SECTION)
    values = _flat(inner if isinstance(inner, Mapping) else given)
    found: dict[str, Any] = {}
    wrong: list[str] = []
    for name, (attribute, accept) in _ACCEPT.items():
        value = values.get(name, values.get(f"{SECTION}.{name}"))
        if value is None or value == "":
            continue
        try:
            found[attribute] = accept(value, folder)
        except UsageError as error:
            wrong.append(f"{SECTION}.{name}: {error}")
    return ClientSettings(**found), wrong


def document_settings(settings: ClientSettings) -> tuple[Settings, list[str]]:
    """Return what texts are written for, with the options of the world file; and what is wrong with that file."""
    given = {"model": settings.robot, "firmware": settings.firmware, "strict": settings.strict}
    return text_settings({name: value for name, value in given.items() if value is not None}, settings.world)


def _flat(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return nested tables as one, with dots in the names."""
    found: dict[str, Any] = {}
    for name, value in values.items():
        if isinstance(value, Mapping):
            found |= {f"{name}.{inner}": deep for inner, deep in _flat(value).items()}
        else:
            found[str(name)] = value
    return found


def _text(value: object) -> str:
    if not isinstance(value, str):
        raise UsageError(f"must be a text, got {value!r:.60}")
    return value


def _robot(value: object, folder: Path | None) -> str:
    name = _text(value)
    if is_model_file(name):
        name = str((folder or Path()) / name)
    load_model(name)
    return name


def _firmware(value: object, _: Path | None) -> str:
    return profile(_text(value)).name


def _world(value: object, folder: Path | None) -> str:
    path = Path(_text(value)).expanduser()
    return str(path if path.is_absolute() or folder is None else folder / path)


def _switch(value: object, _: Path | None) -> bool:
    if not isinstance(value, bool):
        raise UsageError(f"must be true or false, got {value!r:.60}")
    return value


_ACCEPT: Final[dict[str, tuple[str, Callable[[object, Path | None], Any]]]] = {
    "robot": ("robot", _robot),
    "firmware": ("firmware", _firmware),
    "world": ("world", _world),
    "strict": ("strict", _switch),
    "hints.run": ("runs_programs", _switch),
}
