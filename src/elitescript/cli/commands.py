"""`elitescript commands`: the catalogue, from the commands themselves."""

from __future__ import annotations

import argparse
from difflib import get_close_matches

from elitescript.commands.catalogue import CATALOGUE
from elitescript.commands.page import describe, index
from elitescript.errors import UsageError


def commands(options: argparse.Namespace) -> int:
    """Print one command, or the list of all."""
    if options.name is None:
        print(index(CATALOGUE))
        return 0
    command = CATALOGUE.get(options.name)
    if command is None:
        near = get_close_matches(options.name, list(CATALOGUE.names()), n=3)
        hint = f"; did you mean {' or '.join(near)}?" if near else ""
        raise UsageError(f"no command is called {options.name!r}{hint}")
    print(describe(command))
    return 0
