"""Settings of a test's robots: the marker `elitescript`, and the header comment of a test script."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

import pytest

from elitescript.errors import UsageError, did_you_mean
from elitescript.kernel.options import DEFAULTS, KEYWORDS, OPTIONS, SECTIONS, accept
from elitescript.pytest_plugin.limits import SETTINGS as LIMITS

MARKER: Final = "elitescript"

ROBOT: Final = "robot"
"""Keyword of the arm: the first argument of `VirtualRobot`, `--robot` of `serve`."""
WORLD: Final = "world"
"""Keyword of what is around the robot."""

NETWORK: Final = "network"
"""Keyword of what programs reach; of `serve`, `--allow-connect`."""

SETTINGS: Final = (ROBOT, WORLD, *KEYWORDS, *LIMITS)


def settings_of(node: pytest.Item) -> dict[str, Any]:
    """Return the settings that the markers of a test give: for each keyword, that of the nearest marker.

    Raises:
        UsageError: a positional argument, or a keyword that is no setting.
    """
    settings: dict[str, Any] = {}
    for marker in node.iter_markers(MARKER):
        if marker.args:
            raise UsageError(
                f"@pytest.mark.{MARKER} takes keywords, such as robot=..., not the positional {marker.args[0]!r}"
            )
        for name, value in marker.kwargs.items():
            check_setting(name, f"@pytest.mark.{MARKER}")
            settings.setdefault(name, value)
    return settings


def check_setting(name: str, where: str, more: tuple[str, ...] = ()) -> None:
    """Refuse a name that is no setting.

    Raises:
        UsageError: it is none of `SETTINGS` and `more`.
    """
    known = (*SETTINGS, *more)
    if name not in known:
        raise UsageError(f"{where} has no setting {name!r}{did_you_mean(name, known)}; there are {', '.join(known)}")


def robot_arguments(settings: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """Return the arguments of `VirtualRobot` for the settings of a test.

    Args:
        settings: by their names. Paths are relative to `folder`; a function as `world` is called for a new one, and a
            table as `plant`, `safety` or `contact` stands for what that section of a world file holds.
        folder: of the test file.

    Raises:
        UsageError: a value that makes no sense.
    """
    arguments = {name: value for name, value in settings.items() if name not in LIMITS}
    if ROBOT in arguments:
        arguments["model"] = _model(arguments.pop(ROBOT), folder)
    world = arguments.get(WORLD)
    if isinstance(world, str | Path):
        arguments[WORLD] = folder / world
    elif callable(world):
        arguments[WORLD] = world()
    for name, section in SECTIONS.items():
        if isinstance(table := arguments.get(name), Mapping):
            arguments[name] = section.from_table(table)
    return arguments


def serve_arguments(settings: Mapping[str, Any], folder: Path) -> list[str]:
    """Return the command line of `serve` for the settings of a test.

    Its programs reach what `network` names, by default this computer, as programs of a robot in this process do.

    Raises:
        UsageError: a setting that `serve` cannot be given.
    """
    words = _reach(settings, folder)
    for name, value in settings.items():
        if name == NETWORK or name in LIMITS:
            continue
        if name == WORLD and isinstance(value, str | Path):
            words += ["--world", str(folder / value)]
            continue
        row = OPTIONS["model" if name == ROBOT else name] if name != WORLD else None
        if row is None or not row.flag or "serve" not in row.commands:
            raise UsageError(f"served_robot cannot be given {name}={value!r}; write it into the file of world=")
        if isinstance(value, bool):
            words += [row.flag] * value if name != "remote" else [row.flag] * (not value)
        elif isinstance(value, list | tuple):
            words.append(f"{row.flag}={','.join(map(repr, value))}")
        else:
            words.append(f"{row.flag}={_model(value, folder) if name == ROBOT else value}")
    return words


def _reach(settings: Mapping[str, Any], folder: Path) -> list[str]:
    """Return the options of `serve` for what programs reach; none if the world file says it."""
    # Few tests have a controller of their own.
    from elitescript.services.channels.connect_policy import policy_values
    from elitescript.world_file import load_world_file

    network = settings.get(NETWORK)
    if network is None:
        world = settings.get(WORLD)
        if isinstance(world, str | Path) and NETWORK in load_world_file(folder / world, with_world=False).options:
            return []
        network = DEFAULTS[NETWORK]
    return [f"--allow-connect={value}" for value in policy_values((), accept(NETWORK, network, NETWORK))]


def _model(value: Any, folder: Path) -> Any:
    """Return a model; the path of a file is relative to the test's folder."""
    from elitescript.models.model import is_model_file

    is_file = isinstance(value, Path) or (isinstance(value, str) and is_model_file(value))
    return str(folder / value) if is_file else value
