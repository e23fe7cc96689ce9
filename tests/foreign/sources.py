"""Finds CPython's own tests, and reads their modules as pieces: statements with the names that they give."""

from __future__ import annotations

import ast
import importlib.util
import re
import symtable
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Final

STAND_INS: Final = "stand_ins"
"""The module of ours that is there beside CPython's."""
GROUPS: Final = {
    "language": "test_abc test_augassign test_baseexception test_binop test_bool test_builtin test_call test_class"
    " test_compare test_contains test_decorators test_descr test_dictcomps test_dynamic test_except_star"
    " test_exception_group test_exception_variations test_exceptions test_extcall test_fstring test_funcattrs"
    " test_generator_stop test_generators test_genericalias test_genericclass test_global test_grammar test_hash"
    " test_index test_int_literal test_isinstance test_iter test_keywordonlyarg test_listcomps test_metaclass"
    " test_named_expressions test_opcodes test_patma test_positional_only_arg test_property test_raise test_richcmp"
    " test_scope test_setcomps test_string_literals test_subclassinit test_super test_syntax test_type_annotations"
    " test_typechecks test_types test_unicode_identifiers test_unpack test_unpack_ex test_utf8source test_with"
    " test_yield_from",
    "numbers": "test_abstract_numbers test_cmath test_complex test_decimal test_float test_fractions test_int test_long"
    " test_math test_numeric_tower test_pow test_random test_statistics test_strtod test_unary",
    "texts": "test_base64 test_binascii test_bytes test_format test_hashlib test_re test_string test_struct"
    " test_textwrap test_unicode test_userstring",
    "containers": "test_bisect test_collections test_copy test_defaultdict test_deque test_dict test_dictviews"
    " test_enumerate test_functools test_heapq test_iterlen test_itertools test_list test_operator test_ordered_dict"
    " test_range test_set test_slice test_sort test_tuple test_userdict test_userlist",
    "threads": "test_queue test_sched test_thread test_threading test_threading_local",
    "json": "test_json",
    "classes": "test_contextlib test_dataclasses test_enum test_typing",
    "time": "datetimetester test_strptime test_time",
    "files": "test_file test_genericpath test_os test_posixpath test_signal",
}
"""Modules of the package `test` by group. Those that an installed Python does not have are left out."""

_FRESH = re.compile(r"(?:import_helper\.)?\bimport_(?:fresh_)?module\(\s*(['\"])(\w+)\1[^()]*\)")
_HELPER = re.compile(r"\bsupport\.(?:os|threading|warnings|import|script)_helper\b(?=\.)(?<!test\.)")
_IMPORTS: Final = (ast.Import, ast.ImportFrom)
_MODULE: Final = "foreign_module_"


@dataclass(slots=True, eq=False)
class Piece:
    """One statement at the level of its module.

    Attributes:
        names: what it gives a value to, or changes.
        node: its tree.
        text: its text, whole lines; of a class that is cut, see `Slicer`.
        index: its place in the module.
        taken: (module, name) where it is an import of another module of the tests; the name is "" for the module.
    """

    names: tuple[str, ...]
    node: ast.stmt
    text: str
    index: int
    taken: tuple[str, str] | None = None


@dataclass(slots=True, eq=False)
class Module:
    """One module of the tests, as pieces by the names that they give."""

    name: str
    lines: list[str]
    pieces: list[Piece]
    by_name: dict[str, list[Piece]] = field(default_factory=dict)
    stars: list[str] = field(default_factory=list)
    """Modules of which all names are imported."""
    has_text_annotations: bool = False

    def class_of(self, name: str) -> Piece | None:
        """Return the class of a name, if one statement of the module defines it."""
        found = [piece for piece in self.by_name.get(name, ()) if isinstance(piece.node, ast.ClassDef)]
        return found[-1] if found else None


class Library:
    """Reads modules of the tests once each.

    Args:
        folder: of the package `test`.
    """

    __slots__ = ("_modules", "folder")

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._modules: dict[str, Module | None] = {}

    def module(self, name: str) -> Module | None:
        """Return a module by its name below `test`, such as `test_json.test_float`; None if there is none."""
        if name not in self._modules:
            self._modules[name] = self._read(name)
        return self._modules[name]

    def _read(self, name: str) -> Module | None:
        if name == STAND_INS:
            return read_module(name, (Path(__file__).parent / "stand_ins.py").read_text(encoding="utf-8"))
        path = self.folder / name.replace(".", "/")
        for file in (path.with_name(path.name + ".py"), path / "__init__.py"):
            if file.is_file():
                return read_module(name, file.read_text(encoding="utf-8", errors="replace"))
        return None

    def names_of(self, group: str) -> list[str]:
        """Return the modules of a group that are there; of a package, its modules."""
        found = []
        for name in GROUPS[group].split():
            folder = self.folder / name
            if folder.is_dir():
                found += [name, *(f"{name}.{file.stem}" for file in sorted(folder.glob("test_*.py")))]
            elif (self.folder / f"{name}.py").is_file():
                found.append(name)
        return found


def tests_folder() -> Path | None:
    """Return the folder of the package `test` of this Python; None if it is not installed, as in Debian."""
    spec = importlib.util.find_spec("test")
    for place in (spec.submodule_search_locations or ()) if spec else ():
        if (Path(place) / "test_grammar.py").is_file():
            return Path(place)
    return None


def read_module(name: str, text: str) -> Module:
    """Cut the text of a module into pieces."""
    text = _FRESH.sub(lambda found: f"{_MODULE}{found[2]}", _HELPER.sub("support", text))
    tree = ast.parse(text)
    lines = text.split("\n")
    module = Module(name, lines, [])
    last = 0
    firsts = [*(first_line(node) for node in tree.body), len(lines) + 2]
    for place, node in enumerate(tree.body):
        is_alone = last < firsts[place] and (node.end_lineno or 0) < firsts[place + 1]
        if isinstance(node, ast.If) and "__name__" in ast.unparse(node.test):
            continue
        last = node.end_lineno or 0
        if isinstance(node, _IMPORTS):
            _add_import(module, node)
            continue
        segment = "\n".join(lines[firsts[place] - 1 : last])
        whole = segment if is_alone and not segment.rstrip().endswith(";") else ast.unparse(node)
        module.pieces.append(Piece(tuple(_names(node)), node, whole, len(module.pieces)))
    imported = {name for piece in module.pieces if isinstance(piece.node, _IMPORTS) for name in piece.names}
    for piece in module.pieces:
        if not isinstance(piece.node, _IMPORTS) and not isinstance(piece.node, ast.Try | ast.If):
            piece.names = tuple(name for name in piece.names if name not in imported)
    for found in sorted(set(re.findall(rf"{_MODULE}(\w+)", text))):
        line = f"import {found} as {_MODULE}{found}"
        module.pieces.append(Piece((_MODULE + found,), ast.parse(line).body[0], line, -1))
    for piece in module.pieces:
        for name in piece.names:
            module.by_name.setdefault(name, []).append(piece)
    return module


def first_line(node: ast.stmt) -> int:
    """Return the line where a statement begins, its decorators included."""
    return min([node.lineno, *(part.lineno for part in getattr(node, "decorator_list", ()))])


def _add_import(module: Module, node: ast.Import | ast.ImportFrom) -> None:
    package = module.name.rpartition(".")[0]
    for alias in node.names:
        bound = alias.asname or alias.name.partition(".")[0]
        spelt = f"{alias.name} as {alias.asname}" if alias.asname else alias.name
        index = len(module.pieces)
        if isinstance(node, ast.Import):
            taken = _test_module(alias.name) if alias.asname or alias.name == "unittest" else None
            origin = None if taken is None else (taken, "")
            module.pieces.append(Piece((bound,), node, f"import {spelt}", index, origin))
            continue
        source = node.module or ""
        if source == "__future__":
            module.has_text_annotations |= alias.name == "annotations"
            continue
        if node.level:
            source = ".".join(part for part in ("test", package, source) if part)
        if alias.name == "*":
            module.stars.append(source)
            continue
        whole = f"{source}.{alias.name}"
        taken = _test_module(whole if source == "test" or whole.endswith("_helper") else source)
        is_module = source == "test" or whole.endswith("_helper")
        origin = None if taken is None else (taken, "" if is_module else alias.name)
        module.pieces.append(Piece((bound,), node, f"from {source} import {spelt}", index, origin))


def _test_module(name: str) -> str | None:
    """Return which module stands for one that is imported; None for a module of the library."""
    if name in ("unittest", "test.support") or (name.startswith("test.support.") and name.endswith("_helper")):
        return STAND_INS
    return name.removeprefix("test.") if name.startswith("test.") else None


def _names(node: ast.stmt) -> list[str]:
    """Return the names that a statement gives a value to in its own scope, or whose value it changes."""
    if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
        return [node.name]
    found: list[str] = []
    pending: list[ast.AST] = [node]
    while pending:
        part = pending.pop()
        if isinstance(part, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            found.append(part.name)
            continue
        if isinstance(part, ast.Lambda | ast.ListComp | ast.SetComp | ast.DictComp | ast.GeneratorExp):
            continue
        if isinstance(part, ast.Name) and isinstance(part.ctx, ast.Store):
            found.append(part.id)
        elif isinstance(part, ast.Attribute | ast.Subscript) and isinstance(part.ctx, ast.Store):
            found += _root(part)
        elif isinstance(part, ast.Expr) and isinstance(part.value, ast.Call):
            found += _root(part.value.func)
        elif isinstance(part, ast.alias):
            found.append(part.asname or part.name.partition(".")[0])
        elif isinstance(part, ast.ExceptHandler) and part.name:
            found.append(part.name)
        pending += ast.iter_child_nodes(part)
    return list(dict.fromkeys(found))


def _root(node: ast.expr) -> list[str]:
    """Return the name at the left of `a.b[0].c`, but for a plain name: a call of a function changes nothing of it."""
    is_plain = True
    while isinstance(node, ast.Attribute | ast.Subscript):
        node, is_plain = node.value, False
    return [node.id] if isinstance(node, ast.Name) and not is_plain else []


@dataclass(frozen=True, slots=True)
class Words:
    """What a text names: names that it takes from around it, names that it declares global, and all its words."""

    free: frozenset[str]
    declared: frozenset[str]
    all: frozenset[str]


_WORD = re.compile(r"[^\W\d]\w*")


@lru_cache(maxsize=20_000)
def words_of(text: str) -> Words:
    """Return what the text of a statement names."""
    free: set[str] = set()
    declared: set[str] = set()
    pending = [symtable.symtable(text, "piece", "exec")]
    while pending:
        table = pending.pop()
        is_top = table.get_type() == "module"
        for symbol in table.get_symbols():
            if (symbol.is_global() or is_top) and symbol.is_referenced():
                free.add(symbol.get_name())
            if symbol.is_declared_global():
                declared.add(symbol.get_name())
                free.add(symbol.get_name())
        pending += table.get_children()
    return Words(frozenset(free), frozenset(declared), frozenset(_WORD.findall(text)))
