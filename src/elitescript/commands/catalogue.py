"""The catalogue, complete: importing this module registers every command of every family."""

from __future__ import annotations

from typing import Final

from elitescript.commands.registry import REGISTRY, Catalogue

CATALOGUE: Final[Catalogue] = REGISTRY
