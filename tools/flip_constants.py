"""Change random constants of tables, one at a time, and print the changes that no test notices: `make flips`.

A table that is tested against itself is not tested. So one constant of a module-level table, or one number of a model
file, is replaced by another value in a copy of the repository, the tests of that package are run there, and a change
that they let pass is a *survivor*. Tests that notice a change must pass on the unchanged copy, for a test that always
fails notices everything.

Not changed: texts of more than one word, which are prose; texts that are put together from others (f-strings), whose
parts are changed where they stand. Tests that compare generated pages with the code do not count: the page would be
generated again.

The choice follows the seed alone. `--list` prints what would be changed; `--only` restricts it to some files.
Exit code: 0 if every change was noticed, 1 if one survived, 2 if tests fail without any change.
"""

from __future__ import annotations

import argparse
import ast
import difflib
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Final

from tools.model_tables import module_of, module_path

ROOT: Final = Path(__file__).resolve().parent.parent
SOURCE: Final = ROOT / "src" / "elitescript"

TABLES: Final[dict[str, tuple[str, ...]]] = {
    "controller/tasks.py": ("controller", "kernel"),
    "controller/modes.py": ("controller", "kernel"),
    "controller/safety/states.py": ("controller", "kernel"),
    "controller/safety/limits.py": ("controller",),
    "protocol/device_modes.py": ("protocol",),
    "protocol/rtsi/variables.py": ("protocol",),
    "protocol/rtsi/inputs.py": ("protocol",),
    "protocol/primary/packets.py": ("protocol",),
    "protocol/primary/messages.py": ("protocol",),
    "protocol/primary/commands.py": ("protocol",),
    "protocol/dashboard/verbs.py": ("protocol",),
    "protocol/dashboard/guards.py": ("protocol",),
    "protocol/interpreter.py": ("protocol", "kernel"),
    "modbus/port_map.py": ("modbus", "protocol"),
    "modbus/frames/pdu.py": ("modbus",),
    "messages/signals.py": ("messages", "controller", "protocol"),
    "messages/enums.py": ("messages", "protocol", "controller"),
    "messages/timing.py": ("messages", "controller", "runtime"),
    "services/port_numbers.py": ("services",),
    "devices/channels/faults.py": ("devices", "faults"),
    "environment/line_bindings.py": ("environment",),
    "errors.py": ("test_error_codes_by_hand.py", "language"),
    "kinematics/limits.py": ("kinematics",),
    "kinematics/jacobian.py": ("kinematics",),
    "runtime/threads/scheduler.py": ("runtime",),
    "runtime/connections/sockets.py": ("runtime",),
    "models/common.toml": ("models", "kinematics"),
    "models/cs66.toml": ("models", "kinematics"),
    "models/cs620.toml": ("models", "kinematics"),
}
"""Files with tables, and the tests that must notice a change in them, nearest first."""

EQUIVALENT: Final = {
    ("runtime/threads/scheduler.py", "FLOOR"): "how many spare values lie below the fuel; one is enough",
    ("runtime/threads/scheduler.py", "PORTION"): "how many checkpoints are paid out at a time, not how many there are",
}
"""Constants whose exact value changes nothing that can be seen, with the reason; they are not changed."""

LEFT_OUT: Final = ("test_reference", "test_devices_page", "test_motion_page")
"""Tests that compare generated pages with the code."""

KEPT: Final = (
    "src",
    "tests",
    "tools",
    "docs",
    "examples",
    "benchmarks",
    "pyproject.toml",
    "README.md",
    "README.zh.md",
    "CHANGELOG.md",
    "Makefile",
)
TIMEOUT_S: Final = 600.0


@dataclass(frozen=True, slots=True)
class Flip:
    """One change of one file."""

    file: str
    line: int
    start: int
    end: int
    """Where the constant stands in its line, in bytes of UTF-8."""
    old: str
    new: str

    def __str__(self) -> str:
        return f"{self.file}:{self.line}: {self.old} -> {self.new}"


def flips(file: str, text: str) -> Iterator[Flip]:
    """Yield every change of a constant in the module-level tables of a file, and of the members of its enumerations."""
    if file.endswith(".toml"):
        yield from _numbers(file, text)
        return
    tree = ast.parse(text)
    members, words = _members(tree), _words(tree)
    for statement in tree.body:
        if isinstance(statement, ast.Assign | ast.AnnAssign) and statement.value is not None:
            if (file, _target(statement)) in EQUIVALENT:
                continue
            yield from _flips_in(file, text, statement.value, members, words)
        elif isinstance(statement, ast.ClassDef) and any(_is_enum(base) for base in statement.bases):
            for entry in statement.body:
                if isinstance(entry, ast.Assign):
                    yield from _flips_in(file, text, entry.value, members, words)


def _members(tree: ast.Module) -> dict[str, list[str]]:
    """Return the members of enumerations that a file names, by enumeration."""
    found: dict[str, set[str]] = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.attr.isupper():
            found.setdefault(node.value.id, set()).add(node.attr)
    return {name: sorted(attributes) for name, attributes in found.items() if name[0].isupper()}


def _target(statement: ast.Assign | ast.AnnAssign) -> str:
    return ast.unparse(statement.target if isinstance(statement, ast.AnnAssign) else statement.targets[0])


def _words(tree: ast.Module) -> list[str]:
    """Return the texts of a file that are one word."""
    found = {node.value for node in ast.walk(tree) if isinstance(node, ast.Constant) and _is_word(node.value)}
    return sorted(found)


def _is_word(value: object) -> bool:
    return isinstance(value, str) and value != "" and " " not in value and "*" not in value


_NUMBER: Final = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e-?\d+)?(?![\w.])")
_NO_NUMBERS: Final = re.compile(r'"[^"]*"|#.*|^\[.*\]$')


def _numbers(file: str, text: str) -> Iterator[Flip]:
    """Yield a change of each number of a TOML file by one part in a hundred, so that the file still makes sense."""
    for number, line in enumerate(text.split("\n"), 1):
        bare = _NO_NUMBERS.sub(lambda found: " " * len(found[0]), line)
        for found in _NUMBER.finditer(bare):
            start, end = (len(line[:at].encode()) for at in found.span())
            value = float(found[0])
            yield Flip(file, number, start, end, found[0], f"{value * 1.01 if value else 0.01:.12g}")


def _is_enum(base: ast.expr) -> bool:
    return isinstance(base, ast.Name) and base.id.endswith("Enum")


def _flips_in(file: str, text: str, value: ast.expr, members: dict[str, list[str]], words: list[str]) -> Iterator[Flip]:
    lines = text.split("\n")
    in_formats = {id(part) for node in ast.walk(value) if isinstance(node, ast.JoinedStr) for part in ast.walk(node)}
    for node in ast.walk(value):
        new = None if id(node) in in_formats else _changed(node, members, words)
        if new is None or node.lineno != node.end_lineno:  # type: ignore[attr-defined]
            continue
        start, end = node.col_offset, node.end_col_offset  # type: ignore[attr-defined]
        old = lines[node.lineno - 1].encode()[start:end].decode()  # type: ignore[attr-defined]
        yield Flip(file, node.lineno, start, end, old, new)  # type: ignore[attr-defined]


def _changed(node: ast.AST, members: dict[str, list[str]], words: list[str]) -> str | None:
    """Return another value as source text, a word that looks alike for a word; None for no constant, and for prose."""
    if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
        others = [name for name in members.get(node.value.id, ()) if name != node.attr]
        return f"{node.value.id}.{others[node.col_offset % len(others)]}" if others else None
    if not isinstance(node, ast.Constant):
        return None
    value = node.value
    if isinstance(value, bool):
        return str(not value)
    if isinstance(value, int):
        return str(value + 1)
    if isinstance(value, float):
        return str(value * 1.5 + 1.0)
    if not _is_word(value):
        return None
    near = difflib.get_close_matches(value, [word for word in words if word != value], n=1)
    return repr(near[0] if near else f"{value}x")


def applied(text: str, flip: Flip) -> str:
    """Return the text with one change."""
    lines = text.split("\n")
    line = lines[flip.line - 1].encode()
    lines[flip.line - 1] = (line[: flip.start] + flip.new.encode() + line[flip.end :]).decode()
    return "\n".join(lines)


def noticed_by(copy: Path, flip: Flip) -> list[str]:
    """Return the first tests that fail on a changed copy, nearest first; an empty list if all pass."""
    path = copy / "src" / "elitescript" / flip.file
    original = path.read_text(encoding="utf-8")
    write(path, applied(original, flip))
    try:
        return next((tests for tests in _tests(copy, flip.file) if not _passes(copy, tests)), [])
    finally:
        write(path, original)


def write(path: Path, text: str) -> None:
    """Write a file, and the module that is derived from it."""
    path.write_text(text, encoding="utf-8")
    if path.suffix == ".toml":
        module_path(path).write_text(module_of(path), encoding="utf-8")


def _tests(copy: Path, file: str) -> Iterator[list[str]]:
    tests = copy / "tests"
    own = tests / Path(file).parent / f"test_{Path(file).stem}.py"
    near = [*sorted(own.parent.glob("test_*_by_hand.py")), *([own] if own.is_file() else [])]
    if near:
        yield list(map(str, near))
    for name in TABLES[file]:
        yield [str(tests / name)]


def _passes(copy: Path, tests: list[str]) -> bool:
    ignored = [f"--ignore-glob=*{name}*" for name in LEFT_OUT]
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", *ignored, *tests]
    environment = {**os.environ, "PYTHONDONTWRITEBYTECODE": "1", "PYTHONPATH": str(copy / "src")}
    try:
        done = subprocess.run(command, cwd=copy, env=environment, capture_output=True, timeout=TIMEOUT_S, check=False)
    except subprocess.TimeoutExpired:
        return False
    return done.returncode == 0


def chosen(seed: int, count: int, only: list[str]) -> list[Flip]:
    """Return the changes of a seed: as many from each file as its share of all constants, at least one."""
    files = [file for file in TABLES if not only or file in only]
    possible = {file: _possible(file) for file in files}
    random_ = random.Random(seed)
    first = [random_.choice(entries) for entries in possible.values() if entries]
    rest = [flip for entries in possible.values() for flip in entries if flip not in first]
    random_.shuffle(rest)
    return sorted((first + rest)[:count], key=lambda flip: (flip.file, flip.line, flip.start))


@cache
def _possible(file: str) -> tuple[Flip, ...]:
    return tuple(flips(file, (SOURCE / file).read_text(encoding="utf-8")))


def main() -> int:
    """Make the changes of the command line; return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--only", action="append", default=[], metavar="FILE", help="such as controller/tasks.py")
    parser.add_argument("--list", action="store_true", help="print the changes, run nothing")
    options = parser.parse_args()
    changes = chosen(options.seed, options.count, options.only)
    if options.list:
        print(*changes, sep="\n")
        return 0
    survivors: list[Flip] = []
    sound: set[str] = set()
    with tempfile.TemporaryDirectory(prefix="flips") as folder:
        copy = Path(folder)
        for name in KEPT:
            source = ROOT / name
            if source.is_dir():
                shutil.copytree(source, copy / name, ignore=shutil.ignore_patterns("__pycache__"))
            else:
                shutil.copy(source, copy / name)
        for number, flip in enumerate(changes, 1):
            tests = noticed_by(copy, flip)
            if not sound.issuperset(tests):
                if not _passes(copy, tests):
                    print(f"these tests fail without any change: {' '.join(tests)}")
                    return 2
                sound.update(tests)
            print(f"{number:4}/{len(changes)} {'' if tests else 'SURVIVES '}{flip}", flush=True)
            survivors += [] if tests else [flip]
    print(f"seed {options.seed}: {len(survivors)} of {len(changes)} changes survived")
    for flip in survivors:
        print(f"  {flip}")
    return 1 if survivors else 0


if __name__ == "__main__":
    sys.exit(main())
