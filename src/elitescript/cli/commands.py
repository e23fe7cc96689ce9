"""`elitescript commands`: the catalogue of robot commands."""

from __future__ import annotations

import json
from difflib import get_close_matches

from elitescript.commands.catalogue import CATALOGUE
from elitescript.commands.definition.page import describe, index, matches, record, row_of
from elitescript.errors import UsageError

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse


def commands(options: argparse.Namespace) -> int:
    """Print one command in full, those that a word finds, or the list of all."""
    word = options.name
    command = None if word is None else CATALOGUE.get(word)
    if command is not None:
        found = [command]
    elif word is not None:
        found = matches(CATALOGUE, word)
        if not found:
            raise UsageError(f"no command has {word!r} in its name, parameters or description{_near(word)}")
    else:
        found = sorted(CATALOGUE, key=lambda item: item.name)
    if options.json:
        print(json.dumps([record(item) for item in found], ensure_ascii=False, allow_nan=False))
    elif word is None:
        print(index(CATALOGUE))
    elif command is not None:
        print(describe(command))
    else:
        print("\n".join(map(row_of, found)))
        print(f"{len(found)} command{'' if len(found) == 1 else 's'}; elitescript commands NAME shows one in full")
    return 0


def _near(word: str) -> str:
    near = get_close_matches(word, list(CATALOGUE.names()), n=3)
    return f"; did you mean {' or '.join(near)}?" if near else ""
