"""Cuts programs out of modules of tests: one test method, and what it needs of its class and its module."""

from __future__ import annotations

import ast
import builtins
import importlib
import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Final

from tests.foreign.sources import STAND_INS, Library, Module, Piece, first_line, words_of

BASE: Final = "TestCase"
ALWAYS: Final = frozenset(
    "setUp tearDown setUpClass tearDownClass asyncSetUp doCleanups failureException _testMethodName".split()  # noqa: SIM905
)
"""Members of a class of tests that are called although a test does not name them."""
RUNNER: Final = ("Namespace", "foreign_run", "foreign_notes", "foreign_end")
SUPPORT: Final = ("support", "support.os_helper", "support.threading_helper", "support.warnings_helper")
"""Modules that give what has no stand-in."""
SEEDED: Final = "import random as foreign_random\nforeign_random.seed(1)"
"""Stands before the tests that draw numbers, so that both sides draw the same."""
INSIDE: Final = re.compile(r"^\s*(?:import|from) _(?:test\w+|xx\w+|ctypes)\b", re.MULTILINE)
"""An import of modules that CPython has for its own tests alone."""
TEXT_MAX: Final = 200_000
"""Characters of a program; the data of some tests are larger than any program."""
BUILT_IN: Final = frozenset(dir(builtins)) | {"__name__", "__file__", "__doc__"}


@dataclass(frozen=True, slots=True)
class Case:
    """One test method as a program.

    Attributes:
        name: module, class and method.
        group: of `sources.GROUPS`.
        text: of the program.
        why: why there is no program; empty if there is one.
    """

    name: str
    group: str
    text: str
    why: str = ""


class Unsliced(Exception):
    """A test cannot be cut out; the text says why."""


@dataclass(frozen=True, slots=True)
class Link:
    """A class in the chain from a class of tests to its bases."""

    module: Module
    piece: Piece


def cases(library: Library, group: str, modules: list[str] | None = None) -> Iterator[Case]:
    """Yield the test methods of the modules of a group, in their order."""
    for name in library.names_of(group) if modules is None else modules:
        module = library.module(name)
        if module is None:
            continue
        for piece in module.pieces:
            if isinstance(piece.node, ast.ClassDef):
                yield from _cases_of(library, group, module, piece)


def _cases_of(library: Library, group: str, module: Module, piece: Piece) -> Iterator[Case]:
    chain = chain_of(library, module, piece)
    if not any(link.module.name == STAND_INS and link.piece.names[0] == BASE for link in chain):
        return
    methods = dict.fromkeys(
        member.name
        for link in chain
        for member in _body(link.piece)
        if isinstance(member, ast.FunctionDef) and member.name.startswith("test")
    )
    for method in methods:
        name = f"{module.name}.{piece.names[0]}.{method}"
        try:
            yield Case(name, group, sliced(library, module, chain, method))
        except Unsliced as error:
            yield Case(name, group, "", str(error))


def _body(piece: Piece) -> list[ast.stmt]:
    assert isinstance(piece.node, ast.ClassDef)
    return piece.node.body


def chain_of(library: Library, module: Module, piece: Piece) -> list[Link]:
    """Return a class and its bases, as far as they are written in modules of tests."""
    found: dict[int, Link] = {}
    pending = [Link(module, piece)]
    while pending:
        link = pending.pop(0)
        if id(link.piece) in found:
            continue
        found[id(link.piece)] = link
        assert isinstance(link.piece.node, ast.ClassDef)
        for base in link.piece.node.bases:
            other = _class_at(library, link.module, base)
            if other is not None:
                pending.append(other)
    return list(found.values())


def _class_at(library: Library, module: Module, base: ast.expr) -> Link | None:
    if isinstance(base, ast.Name):
        return _class_named(library, module, base.id)
    if isinstance(base, ast.Attribute) and isinstance(base.value, ast.Name):
        for piece in module.by_name.get(base.value.id, ()):
            if piece.taken is not None and not piece.taken[1]:
                other = library.module(piece.taken[0])
                return None if other is None else _class_named(library, other, base.attr)
    return None


def _class_named(library: Library, module: Module, name: str) -> Link | None:
    piece = module.class_of(name)
    if piece is not None:
        return Link(module, piece)
    for piece in module.by_name.get(name, ()):
        if piece.taken is not None and piece.taken[1]:
            other = library.module(piece.taken[0])
            return None if other is None else _class_named(library, other, piece.taken[1])
    return None


def sliced(library: Library, module: Module, chain: list[Link], method: str) -> str:
    """Return the program of one test method.

    Raises:
        Unsliced: it needs something that cannot be cut out.
    """
    text = _Slice(library, module, chain, method).text()
    if INSIDE.search(text):
        raise Unsliced("it needs a module that CPython has for its own tests alone")
    if len(text) > TEXT_MAX:
        raise Unsliced("the data of the test are too long for a program")
    return text


class _Slice:
    """Collects the pieces of one program, until they name nothing further."""

    __slots__ = ("asked", "chain", "chosen", "library", "method", "module", "stars", "words")

    def __init__(self, library: Library, module: Module, chain: list[Link], method: str) -> None:
        self.library = library
        self.module = module
        self.chain = {id(link.piece) for link in chain}
        self.method = method
        self.chosen: dict[int, tuple[Module, Piece]] = {id(chain[0].piece): (module, chain[0].piece)}
        self.words: set[str] = {method}
        self.asked: dict[int, set[str]] = {}
        """Names that are taken of a module that stands as a whole, by its import."""
        self.stars: dict[str, str] = {}

    def text(self) -> str:
        stand_ins = self._module(STAND_INS)
        for name in RUNNER:
            self._choose(stand_ins, name)
        while True:
            before = (len(self.chosen), len(self.words), sum(map(len, self.asked.values())), len(self.stars))
            for module, piece in list(self.chosen.values()):
                self._follow(module, self._shown(module, piece))
            after = (len(self.chosen), len(self.words), sum(map(len, self.asked.values())), len(self.stars))
            if before == after:
                return self._written()

    def _module(self, name: str) -> Module:
        module = self.library.module(name)
        if module is None:
            raise Unsliced(f"it needs the module test.{name}")
        return module

    def _follow(self, module: Module, text: str) -> None:
        words = words_of(text)
        self.words |= words.all
        for name in words.free:
            if name in module.by_name or name not in BUILT_IN:
                self._choose(module, name)
        for piece in [piece for owner, piece in self.chosen.values() if owner is module]:
            if piece.taken is not None and not piece.taken[1] and piece.names[0] in words.free:
                for attribute in re.findall(rf"\b{piece.names[0]}\s*\.\s*(\w+)", text):
                    self.asked.setdefault(id(piece), set()).add(attribute)
                    self._choose(self._module(piece.taken[0]), attribute)

    def _choose(self, module: Module, name: str) -> None:
        pieces = module.by_name.get(name)
        if pieces is None:
            for star in module.stars:
                if name in _names_of(star):
                    self.stars[name] = f"from {star} import {name}"
                    return
            if module.name == STAND_INS:
                self._choose_of_support(name)
            return
        for piece in pieces:
            self.chosen[id(piece)] = (module, piece)
            if piece.taken is not None and piece.taken[1]:
                self._choose(self._module(piece.taken[0]), piece.taken[1])

    def _choose_of_support(self, name: str) -> None:
        """Take from `test.support` what has no stand-in."""
        for path in SUPPORT:
            module = self.library.module(path)
            if module is not None and name in module.by_name:
                self._choose(module, name)
                return
        raise Unsliced(f"it needs unittest.{name}" if name == "mock" else f"it needs test.support.{name}")

    def _shown(self, module: Module, piece: Piece) -> str:
        """Return the text of a piece, a class of tests without what nothing names."""
        if piece.taken is not None:
            return "pass"
        if id(piece) not in self.chain or not isinstance(piece.node, ast.ClassDef):
            return piece.text
        body = piece.node.body
        if body[0].lineno == piece.node.lineno:
            return piece.text
        lines = module.lines[first_line(piece.node) - 1 : first_line(body[0]) - 1]
        while lines and not lines[-1].rstrip().endswith(":"):
            lines = lines[:-1]  # comments between the head and the body
        kept = [member for member in body if self._is_kept(member)]
        indent = " " * body[0].col_offset
        for member in kept:
            lines += module.lines[first_line(member) - 1 : member.end_lineno]
        return "\n".join([*lines, *([] if kept else [f"{indent}pass"])])

    def _is_kept(self, member: ast.stmt) -> bool:
        if isinstance(member, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            name = member.name
            if name.startswith("test") and name != self.method and isinstance(member, ast.FunctionDef):
                return False
            return name in self.words or name in ALWAYS or name == "__init__"
        if isinstance(member, ast.Assign | ast.AnnAssign | ast.Delete):
            names = [node.id for node in ast.walk(member) if isinstance(node, ast.Name) and not _is_load(node)]
            return any(name in self.words or name in ALWAYS for name in names)
        return not isinstance(member, ast.Expr)

    def _written(self) -> str:
        parts: list[str] = []
        declared: set[str] = set()
        given: dict[str, tuple[str, bool]] = {}
        whole: dict[str, str] = {}
        for module, piece in self._in_order():
            text = self._written_piece(piece, whole) if piece.taken is not None else self._shown(module, piece)
            if not text:
                continue
            is_replaceable = isinstance(piece.node, ast.ClassDef) or text.startswith(("import ", "from "))
            for name in piece.names if piece.taken is None and module.name != STAND_INS else ():
                owner, was_replaceable = given.setdefault(name, (module.name, is_replaceable))
                if owner != module.name and not (is_replaceable and was_replaceable):
                    raise Unsliced(f"two modules define `{name}`")
            declared |= words_of(text).declared
            parts.append(text)
        names = {name for _, piece in self.chosen.values() for name in piece.names}
        shared = sorted((declared & names) | {"foreign_notes", "foreign_end"})
        first = ["from __future__ import annotations"] if self.module.has_text_annotations else []
        seeded = [SEEDED] if "random" in self.words else []
        owner = next(iter(self.chosen.values()))[1].names[0]
        last = f"foreign_run({owner}, {self.method!r})\n"
        return "\n".join([*first, f"global {', '.join(shared)}", *seeded, *self.stars.values(), *parts, last])

    def _in_order(self) -> list[tuple[Module, Piece]]:
        """Return what was chosen, modules that are imported before those that import them."""
        modules: dict[str, None] = {}

        def visit(name: str, path: tuple[str, ...]) -> None:
            if name in modules or name in path:
                return
            for owner, piece in self.chosen.values():
                if owner.name == name and piece.taken is not None:
                    visit(piece.taken[0], (*path, name))
            modules[name] = None

        for name in (STAND_INS, *SUPPORT):
            visit(name, ())
        for owner, _ in self.chosen.values():
            visit(owner.name, ())
        places = {name: place for place, name in enumerate(modules)}
        return sorted(self.chosen.values(), key=lambda found: (places[found[0].name], found[1].index))

    def _written_piece(self, piece: Piece, whole: dict[str, str]) -> str:
        """Return what stands for an import of another module of the tests; `whole` has those that were written."""
        assert piece.taken is not None
        (source, name), bound = piece.taken, piece.names[0]
        if name:
            return "" if name == bound else f"{bound} = {name}"
        same = [other for _, other in self.chosen.values() if other.taken == piece.taken and other.names == piece.names]
        inner = sorted({each for other in same for each in self.asked.get(id(other), ())})
        if whole.setdefault(bound, source) != source:
            raise Unsliced(f"two modules define `{bound}`")
        return f"{bound} = Namespace({', '.join(f'{each}={each}' for each in inner)})"


def _is_load(node: ast.Name) -> bool:
    return isinstance(node.ctx, ast.Load)


@lru_cache(maxsize=200)
def _names_of(module: str) -> frozenset[str]:
    """Return what `from module import *` gives."""
    try:
        found = importlib.import_module(module)
    except Exception:
        return frozenset()
    return frozenset(getattr(found, "__all__", None) or (name for name in vars(found) if name[:1] != "_"))
