"""The arm of a robot, by its name or by its file."""

from __future__ import annotations

from pathlib import Path

from elitescript.kernel.options import RobotOptions
from elitescript.models.datafile import read_text
from elitescript.models.model import RobotModel, is_model_file, load_model, parse_model


def named_model(name: str | Path) -> tuple[RobotModel, dict[str, str]]:
    """Return an arm by its name or by the path of its file, and the options of a robot that has it.

    Raises:
        UsageError: there is no such model, or its file is wrong.
    """
    if not is_model_file(name):
        model = load_model(name)
        return model, {"model": model.name}
    # A robot in another process cannot read files of this computer: it gets the text of the file.
    options = {"model": Path(name).name, "model_text": read_text(Path(name))}
    return parse_model(options["model"], options["model_text"]), options


def model_of(options: RobotOptions) -> RobotModel:
    """Return the arm that the options name.

    Raises:
        UsageError: there is no such model, or the file of an own arm is wrong.
    """
    return parse_model(options.model, options.model_text) if options.model_text else load_model(options.model)
