"""Python files of a plan: imported from their texts, for devices of its world and for its properties."""

from __future__ import annotations

import ast
import sys
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec
from pathlib import Path, PurePosixPath
from types import CodeType, ModuleType
from typing import Any, Final

from elitescript.errors import UsageError
from elitescript.untrusted.files import PYTHON, read_text

BYTES_MAX: Final = PYTHON.bytes_max
"""Texts of Python files, and files of the task folder, that a plan holds at most."""


def python_texts(folder: Path, named: Iterable[str]) -> dict[str, str]:
    """Return the texts of Python files by name, with those beside them that they import.

    Args:
        folder: that names count from.
        named: files.

    Raises:
        UsageError: one cannot be read, or all together are too large.
    """
    texts: dict[str, str] = {}
    wanted = list(named)
    while wanted:
        name = PurePosixPath(wanted.pop()).as_posix()
        if name in texts:
            continue
        path = folder / name
        texts[name] = read_text(path, PYTHON)
        if sum(map(len, texts.values())) > BYTES_MAX:
            raise UsageError(f"the Python files beside {path} are larger than {BYTES_MAX / 1e6:g} MB")
        beside = (PurePosixPath(name).parent / f"{module}.py" for module in _imported_names(texts[name]))
        wanted += [file.as_posix() for file in beside if (folder / file).is_file()]
    return dict(sorted(texts.items()))


def _imported_names(text: str) -> set[str]:
    """Return the names of the modules that a text imports; none if it is no Python, which is refused later."""
    try:
        nodes = list(ast.walk(ast.parse(text)))
    except (SyntaxError, ValueError):
        return set()
    names = {alias.name for node in nodes if isinstance(node, ast.Import) for alias in node.names}
    return names | {
        node.module for node in nodes if isinstance(node, ast.ImportFrom) and node.module and not node.level
    }


class PythonFiles:
    """Imports the Python files of a plan, anew each time it is asked.

    So nothing that a file keeps in its module reaches another run.

    Args:
        texts: by name, relative to one folder.
    """

    __slots__ = ("_codes", "_texts")

    def __init__(self, texts: Mapping[str, str]) -> None:
        self._texts = texts
        self._codes: dict[str, CodeType] = {}

    def modules(self, names: Iterable[str]) -> dict[str, ModuleType]:
        """Return new modules by the names of their files.

        Raises:
            UsageError: a file is missing or cannot be imported; the text names file and line.
        """
        names = list(names)
        found: dict[str, ModuleType] = {}
        if names:
            with self.importing(names):
                for name in names:
                    if name not in found:
                        found[name] = self._imported(name, f"elitescript_world_{PurePosixPath(name).stem}")
        return found

    def _imported(self, name: str, called: str) -> ModuleType:
        module = ModuleType(called)
        module.__file__ = name
        sys.modules[called] = module  # dataclasses of the file look for their own module
        self.execute(name, module)
        return module

    def execute(self, name: str, module: ModuleType) -> None:
        """Run the text of a file in a module.

        Raises:
            UsageError: there is no such file, or it fails; the text names file and line.
        """
        if name not in self._texts:
            raise UsageError(f"there is no file {name}")
        try:
            if name not in self._codes:
                self._codes[name] = compile(self._texts[name], name, "exec", dont_inherit=True)
            exec(self._codes[name], module.__dict__)
        except UsageError:
            raise
        except Exception as error:
            line = error.lineno if isinstance(error, SyntaxError) else _line_in(error, name)
            text = error.msg if isinstance(error, SyntaxError) else str(error)
            raise UsageError(f"{name}:{line}: {type(error).__name__}: {text}") from error

    @contextmanager
    def importing(self, names: Iterable[str]) -> Iterator[None]:
        """Let files import those beside them while the body runs; no such module stays behind."""
        finder = _Beside(self, {PurePosixPath(name).parent for name in names}, self._texts)
        # Last: a file called queue.py does not stand in for the standard library's.
        sys.meta_path.append(finder)
        try:
            yield
        finally:
            sys.meta_path.remove(finder)
            for name in finder.made:
                sys.modules.pop(name, None)


class _Beside(MetaPathFinder):
    """Finds modules among the texts of a plan, and loads them."""

    def __init__(self, files: PythonFiles, folders: set[PurePosixPath], texts: Mapping[str, str]) -> None:
        self._files = files
        self._folders = folders
        self._texts = texts
        self.made: list[str] = []

    def find_spec(self, name: str, path: Any = None, target: Any = None) -> ModuleSpec | None:
        for folder in self._folders:
            file = (folder / f"{name}.py").as_posix()
            if path is None and file in self._texts:
                self.made.append(name)
                return ModuleSpec(name, self, origin=file)  # type: ignore[arg-type]
        return None

    def create_module(self, _spec: ModuleSpec) -> None:
        """Let a module be made as any other."""

    def exec_module(self, module: ModuleType) -> None:
        """Run the text of a module."""
        assert module.__spec__ is not None
        module.__file__ = module.__spec__.origin
        self._files.execute(str(module.__spec__.origin), module)


def _line_in(error: BaseException, name: str) -> int:
    line = 0
    trace = error.__traceback__
    while trace is not None:
        if trace.tb_frame.f_code.co_filename == name:
            line = trace.tb_lineno
        trace = trace.tb_next
    return line
