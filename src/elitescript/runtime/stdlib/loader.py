"""Private copies of installed pure-Python modules, one set for each run.

A copy is executed from the installed module's own code, with some of its imports replaced. `threading` and `queue`
thereby get the exact semantics of CPython with virtual locks and time, and a program that patches a class of a copy
patches it for itself alone.
"""

from __future__ import annotations

import builtins
import sys
from collections.abc import Callable
from functools import cache
from importlib import import_module
from importlib.machinery import PathFinder
from types import CodeType, ModuleType, SimpleNamespace
from typing import Any, Final

from elitescript.errors import InternalError
from elitescript.language import modules

KNOWN_PYTHONS: Final = ((3, 11), (3, 12), (3, 13), (3, 14))
"""Versions whose modules were tested as copies; another one may import other names."""

ABSENT: Final = object()
"""Stands for a module that a copy must not find, so that it takes its own Python code."""


class CopyLoader:
    """Makes and keeps the copies of one run.

    Args:
        replacements: of imported modules, by name; `ABSENT` for none.
        build_class: makes the classes of copies; that of Python if not given.
        names: names that a module finds before it runs, by its name.
    """

    __slots__ = ("_builtins", "_copies", "_names", "_replacements")

    def __init__(
        self,
        replacements: dict[str, Any],
        build_class: Callable[..., type] = builtins.__build_class__,
        names: dict[str, dict[str, Any]] | None = None,
    ) -> None:
        self._copies: dict[str, ModuleType] = {}
        self._replacements = {
            "sys": _system(_Modules({})),
            "warnings": SimpleNamespace(warn=_no_output),
            **replacements,
        }
        own = {"__build_class__": build_class, "__import__": self._import, "print": _no_output}
        self._builtins = {**vars(builtins), **own}
        self._names = names or {}

    def load(self, name: str) -> ModuleType:
        """Return the copy of a module.

        Raises:
            InternalError: this Python is not known.
        """
        module = self._copies.get(name)
        if module is None:
            check_python()
            module = ModuleType(name)
            space = vars(module)
            package = SOURCES.get(name, name)
            space["__package__"] = package if package in PACKAGES else package.rpartition(".")[0]
            space["__builtins__"] = self._builtins
            space.update(self._names.get(name, {}))
            self._copies[name] = module
            try:
                exec(_code_of(package), space)
            except BaseException:
                del self._copies[name]
                raise
        return module

    def _import(
        self,
        name: str,
        space: dict[str, Any] | None = None,
        names: object = None,
        fromlist: tuple[str, ...] | None = (),
        level: int = 0,
    ) -> Any:
        if level:
            assert space is not None
            package = space["__package__"]
            if not name:
                return SimpleNamespace(**{part: self.load(f"{package}.{part}") for part in fromlist or ()})
            name = f"{package}.{name}"
        asked, name = name, _SAME.get(name, name)
        if name in COPIED:
            module = self.load(name)
            if "." in asked and not fromlist:
                package, _, part = name.partition(".")
                setattr(self.load(package), part, module)
                return self.load(package)
            if name in PACKAGES and fromlist:
                parts = {part: f"{name}.{part}" for part in fromlist if f"{name}.{part}" in COPIED}
                return SimpleNamespace(**vars(module), **{part: self.load(full) for part, full in parts.items()})
            return module
        if name == "sys" and space is not None and space["__name__"] == "dataclasses":
            return _system(_Modules(self._copies))
        if name in self._replacements:
            found = self._replacements[name]
            if found is ABSENT:
                raise ImportError(f"no module named {name!r} for a copy")
            return found
        return builtins.__import__(name, None, None, fromlist or (), 0)


COPIED: Final = modules.COPIED | {"_strptime", "json.decoder", "json.encoder", "json.scanner"}
"""Modules that copies of each other find as copies."""

_SAME: Final = {"_collections_abc": "collections.abc"}
"""Modules that copies import by another name."""

PACKAGES: Final = frozenset({"json"})

SOURCES: Final = {"collections.abc": "_collections_abc"}
"""Name of the Python code of a module, if it is another one."""


def check_python(version: tuple[int, int] = sys.version_info[:2]) -> None:
    """Refuse a Python whose modules were never tested as copies.

    Raises:
        InternalError: with the versions that are known.
    """
    if version not in KNOWN_PYTHONS:
        known = ", ".join(f"{major}.{minor}" for major, minor in KNOWN_PYTHONS)
        raise InternalError(
            f"Python {version[0]}.{version[1]} is newer or older than elitescript: its threading and queue "
            f"modules cannot be used in scripts; use Python {known}"
        )


@cache
def _code_of(name: str) -> CodeType:
    """Return the code of an installed module, from its compiled file where there is one."""
    path = None
    if "." in name:
        package = PathFinder.find_spec(name.partition(".")[0])
        path = None if package is None else package.submodule_search_locations
    spec = PathFinder.find_spec(name, path)
    loader: Any = None if spec is None else spec.loader
    code: CodeType | None = None if loader is None else loader.get_code(name)
    if code is None:
        raise InternalError(f"the Python code of the module {name!r} is not installed")
    return code


class _Modules(dict[str, Any]):
    """`sys.modules` for a copy: appears empty.

    Args:
        copies: copies whose names annotations in text form may have: those of `typing` and `dataclasses`.
    """

    __slots__ = ("_copies",)

    def __init__(self, copies: dict[str, ModuleType]) -> None:
        super().__init__()
        self._copies = copies

    def __contains__(self, name: object) -> bool:
        return False

    def __missing__(self, name: str) -> Any:
        return self._copies[name]

    def get(self, name: str, default: Any = None) -> Any:
        """Return a module; for one of a program, what its annotations are compared with."""
        if name in _ANNOTATING:
            return self._copies.get(name, default)
        modules = {name: self._copies[name] for name in _ANNOTATING if name in self._copies}
        names = {key: vars(module)[key] for module in modules.values() for key in _ANNOTATIONS if key in vars(module)}
        return SimpleNamespace(**modules, **names)


_ANNOTATING: Final = ("dataclasses", "typing")
_ANNOTATIONS: Final = ("ClassVar", "InitVar", "KW_ONLY")


def _system(modules: _Modules) -> SimpleNamespace:
    """Return `sys` for a copy, reduced to the names that it uses."""
    return SimpleNamespace(
        _getframe=sys._getframe,
        exc_info=sys.exc_info,
        flags=SimpleNamespace(thread_inherit_context=False),
        excepthook=_no_output,
        float_info=sys.float_info,
        getsizeof=sys.getsizeof,
        hash_info=sys.hash_info,
        intern=sys.intern,
        maxsize=sys.maxsize,
        modules=modules,
        platform="linux",
        setprofile=_no_output,
        settrace=_no_output,
        stderr=None,
        stdout=None,
        version_info=sys.version_info,
    )


def real(name: str) -> ModuleType:
    """Return an installed module itself; never for scripts."""
    return import_module(name)


def forwarded(function: Callable[..., Any]) -> Callable[..., Any]:
    """Wrap a function of an installed module, so that attributes set by a program end with the program."""

    def call(*args: Any, **kwargs: Any) -> Any:
        return function(*args, **kwargs)

    call.__name__ = call.__qualname__ = function.__name__
    call.__doc__ = function.__doc__
    return call


def _no_output(*values: object, **options: object) -> None:
    """Do nothing: `print` and warnings in copies."""
