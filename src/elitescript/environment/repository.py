"""The repository that this process works in: reports for CI services name files from its root."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Final

from elitescript.paths import real_path

WORKSPACE: Final = "GITHUB_WORKSPACE"
"""Variable in which GitHub's runner names the folder that paths of findings are relative to."""


def repository_root(environment: Mapping[str, str] = os.environ) -> Path:
    """Return the root of the repository, without links.

    It is the folder that GitHub's runner names; without one the top of the git work tree that the working directory is
    in, and outside of every work tree the working directory.
    """
    named = environment.get(WORKSPACE, "")
    if named and os.path.isabs(named) and os.path.isdir(named):  # noqa: PTH112, PTH117
        return real_path(named)
    here = real_path(".")
    # A folder in the main work tree, a file in others and in submodules.
    return next((folder for folder in (here, *here.parents) if (folder / ".git").exists()), here)


def from_root(path: str | Path, root: Path) -> Path:
    """Return a path relative to the root of the repository; absolute if it is outside.

    Of a link to a file inside, what it leads to: that is what the repository has lines of.

    Args:
        path: relative to the working directory, or absolute.
        root: of `repository_root`.
    """
    leads_to = real_path(path)
    for found in (leads_to, real_path(Path(path).parent) / Path(path).name):
        if found.is_relative_to(root):
            return found.relative_to(root)
    return leads_to
