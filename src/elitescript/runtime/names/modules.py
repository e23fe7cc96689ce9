"""Lists the modules that a script can import, and imports them.

A facade is a plain object with the public names of a module and nothing behind them. It is made when a program
first imports it, and belongs to that program. Four ways to fill one:

    shared   functions and immutable classes of the installed module itself
    copied   names of a private copy of it (see `stdlib.loader`)
    own      a small module of the runtime, in virtual time or over simulated processes
    refused  everything else
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import nullcontext
from types import FunctionType, ModuleType, SimpleNamespace
from typing import Any, Final, NoReturn, Protocol

from elitescript.language.modules import AVAILABLE, COPIED_NAMES, NETWORK, SHARED, SHARED_NAMES
from elitescript.language.policy import is_attribute_allowed, is_dunder
from elitescript.runtime.stdlib.loader import ABSENT, CopyLoader, forwarded, real
from elitescript.runtime.threads.scheduler import Scheduler, noting_calls
from elitescript.said import said
from elitescript.sealed import Sealed, hidden_slot, no_copy


class Facade(metaclass=Sealed):
    """A module as scripts see it."""

    __slots__ = ("__dict__", "_name")
    __module__ = "builtins"
    __qualname__ = "module"
    __reduce_ex__ = no_copy

    def __init__(self, name: str, names: dict[str, Any]) -> None:
        _name.__set__(self, name)
        self.__dict__.update(names)

    def __getattr__(self, attribute: str) -> NoReturn:
        name = _name.__get__(self)
        raise AttributeError(f"the module {name!r} of the robot has no {attribute!r}{_advice(attribute, self)}")

    def __setattr__(self, attribute: str, value: object) -> NoReturn:
        raise AttributeError(f"the module {_name.__get__(self)!r} cannot be changed")

    def __delattr__(self, attribute: str) -> NoReturn:
        raise AttributeError(f"the module {_name.__get__(self)!r} cannot be changed")

    def __repr__(self) -> str:
        return f"<module {_name.__get__(self)!r}>"


type.__setattr__(Facade, "__name__", "module")
_name = hidden_slot(Facade, "_name")


def _advice(attribute: str, facade: Facade) -> str:
    """Return a similar name, or all names if there are few."""
    from elitescript.language.advice.unknown_names import nearest

    names = sorted(vars(facade))
    if len(names) <= FEW_NAMES:
        return said("; it has {names}", names=", ".join(names))
    meant = nearest(attribute, names)
    return said("; is `{meant}` meant?", meant=meant) if meant else ""


FEW_NAMES: Final = 24
"""Most names of a module that are listed for an unknown one."""


class ModulePort(Protocol):
    """Lists the methods of the program that the shelf calls."""

    def module_names(self, name: str) -> dict[str, Any]:
        """Return the names of one of the `OWN` modules."""

    def copy_replacements(self, is_loading_threads: Callable[[], bool]) -> dict[str, Any]:
        """Return the replacements of modules for private copies: `_thread`, `time`, `random`."""

    def build_class(self, *args: Any, **options: Any) -> type:
        """Make a class, as the statement does."""

    def numbering(self) -> Callable[[Any], int]:
        """Return what gives the number that `id` gives of a value; 0 for one that is its own copy."""

    def copy_names(self) -> dict[str, dict[str, Any]]:
        """Return names that private copies find before they run, by module: `id`."""


class ModuleShelf:
    """The modules of one program, made when they are first imported.

    Args:
        port: the program.
        scheduler: runs its threads.
    """

    __slots__ = ("_facades", "_is_loading_threads", "_is_memo_shown", "_loader", "_port", "_scheduler")

    def __init__(self, port: ModulePort, scheduler: Scheduler) -> None:
        self._port = port
        self._scheduler = scheduler
        self._facades: dict[str, Facade] = {}
        self._loader: CopyLoader | None = None
        self._is_loading_threads = False
        self._is_memo_shown = False

    def import_module(
        self,
        name: str,
        space: object = None,
        names: object = None,
        fromlist: tuple[str, ...] | None = None,
        level: int = 0,
    ) -> Facade:
        """Import a module for a script: `__import__`.

        Raises:
            ImportError: the module is not for scripts, or has no such name.
        """
        if level:
            raise ImportError("a program is no package: write the whole name of the module")
        module = self.facade(name)
        if not fromlist:
            return self.facade(name.partition(".")[0])
        for wanted in fromlist:
            # Otherwise Python would look for a real module `name.wanted` among the loaded ones.
            if wanted not in vars(module):
                raise ImportError(f"cannot import name {wanted!r} from {name!r}: the robot's {name} does not have it")
        return module

    def facade(self, name: str) -> Facade:
        """Return a module.

        Raises:
            ImportError: it is not for scripts.
        """
        found = self._facades.get(name)
        if found is None:
            if name not in AVAILABLE:
                raise ImportError(_refusal(name))
            # Making one takes milliseconds, once in a program.
            meter = self._scheduler.meter
            with nullcontext() if meter is None else meter.pardon():
                found = self._facades[name] = self._make(name)
        return found

    def _make(self, name: str) -> Facade:
        if name == "os.path":
            path: Facade = vars(self.facade("os"))["path"]
            return path
        if name in SHARED_NAMES:
            names = _chosen(real(name), SHARED_NAMES[name])
            if name == "operator":
                names |= _special_names(vars(real(name)), names)
            names = {key: forwarded(item) if type(item) is FunctionType else item for key, item in names.items()}
        elif name in COPIED_NAMES:
            names = _chosen(self.copy(name), COPIED_NAMES[name])
            if name in _FIXES:
                _FIXES[name](names)
            if name == "copy":
                names["deepcopy"] = self._deepcopy(names["deepcopy"])
            if name == "collections":
                names["abc"] = self.facade("collections.abc")
        else:
            names = self._port.module_names(name)
        if name in _LONG:
            scheduler = self._scheduler
            names = {
                key: noting_calls(scheduler, item) if type(item) is FunctionType else item
                for key, item in names.items()
            }
        return Facade(name, names)

    def copy(self, name: str) -> ModuleType:
        """Return the whole private copy of a module; not for scripts."""
        if self._loader is None:
            replacements = self._port.copy_replacements(lambda: self._is_loading_threads)
            self._loader = CopyLoader(
                {**replacements, **_REPLACEMENTS},
                self._port.build_class,
                self._port.copy_names(),
            )
        outer = self._is_loading_threads
        self._is_loading_threads = outer or name in ("queue", "threading")
        try:
            module = self._loader.load(name)
        finally:
            self._is_loading_threads = outer
        if name == "copy" and self._is_memo_shown:
            vars(module)["id"] = self._port.numbering()
        return module

    def show_memo(self) -> None:
        """Have `deepcopy` note objects by the numbers that `id` gives, not by addresses, which are found faster.

        Called before the program can see what a `deepcopy` notes.
        """
        if not self._is_memo_shown:
            self._is_memo_shown = True
            if self._loader is not None:
                self.copy("copy")

    def _deepcopy(self, copied: Callable[..., Any]) -> Callable[..., Any]:
        def deepcopy(x: Any, memo: Any = None) -> Any:
            """Return a copy of the value and of all that it holds."""
            if memo is None:
                return copied(x)
            self.show_memo()
            return copied(x, memo)

        deepcopy.__qualname__ = deepcopy.__name__
        return deepcopy


def _refusal(name: str) -> str:
    if name.partition(".")[0] in NETWORK:
        return said(
            "the module {name!r} is not available to programs; the commands socket_open, "
            "socket_send_string, rpc_factory and their like reach the network",
            name=name,
        )
    return said("the module {name!r} is not available to programs", name=name)


def _chosen(module: ModuleType, wanted: str) -> dict[str, Any]:
    """Return the wanted names of a module that exist; never a module."""
    space = vars(module)
    if wanted == "*":
        public = space.get("__all__") or [name for name in space if not name.startswith("_")]
        return {name: space[name] for name in public if not isinstance(space[name], ModuleType)}
    # Some are made when they are first asked for, such as `typing.Match` since Python 3.13.
    return {name: getattr(module, name) for name in wanted.split() if hasattr(module, name)}


def _special_names(space: dict[str, Any], names: dict[str, Any]) -> dict[str, Any]:
    """Return the functions of `operator` by their other names, as `__lt__` of `lt`, that programs may read.

    Without them those names would lead to the methods of the facade itself.
    """
    special = {f"__{name.strip('_')}__": item for name, item in names.items()}
    return {name: item for name, item in special.items() if space.get(name) is item and is_attribute_allowed(name)}


def _own_wraps(names: dict[str, Any]) -> None:
    """Replace `wraps` by one without lists of attributes, which could name any attribute."""

    def update_wrapper(wrapper: Any, wrapped: Any) -> Any:
        """Give a function the name, the text and the attributes of the one that it wraps."""
        for attribute in ("__name__", "__qualname__", "__doc__"):
            value = getattr(wrapped, attribute, None)
            if type(value) is str:
                setattr(wrapper, attribute, value)
        if type(wrapped) is FunctionType and type(wrapper) is FunctionType:
            wrapper.__dict__.update({name: value for name, value in vars(wrapped).items() if not is_dunder(name)})
        return wrapper

    def wraps(wrapped: Any) -> Callable[[Any], Any]:
        """Decorator that gives a function the name, the text and the attributes of the one that it wraps."""
        return lambda wrapper: update_wrapper(wrapper, wrapped)

    names["update_wrapper"] = update_wrapper
    names["wraps"] = wraps


def _own_json_error(names: dict[str, Any]) -> None:
    """Use the error class of the installed module, which the C parser raises, in the copy too."""
    error = real("json").JSONDecodeError
    for function in (names["loads"], names["JSONDecoder"].decode):
        function.__globals__["JSONDecodeError"] = error
    names["JSONDecodeError"] = error


def _own_user_string(names: dict[str, Any]) -> None:
    """Remove the methods of `UserString` that could read any attribute."""
    for method in ("format", "format_map"):
        delattr(names["UserString"], method)


class _ForwardRef:
    """A type in text form. The one of Python could be evaluated, past the compiler."""

    __slots__ = ("_text",)
    __module__ = "typing"
    __qualname__ = "ForwardRef"

    def __init__(self, text: str, *details: Any, **options: Any) -> None:
        self._text = text

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _ForwardRef) and self._text == other._text

    def __hash__(self) -> int:
        return hash(self._text)

    def __repr__(self) -> str:
        return f"ForwardRef({self._text!r})"


def _without_evaluation(names: dict[str, Any]) -> None:
    """Leave types in text form texts."""
    names["NewType"].__init__.__globals__["ForwardRef"] = _ForwardRef


_LONG: Final = SHARED | {"os", "random", "re", "subprocess", "time"}
"""Modules with functions whose calls may take long; those of copies stay as they are: some look at their caller."""


_FIXES: Final[dict[str, Callable[[dict[str, Any]], None]]] = {
    "collections": _own_user_string,
    "functools": _own_wraps,
    "json": _own_json_error,
    "typing": _without_evaluation,
}


def _annotations(cls: type) -> dict[str, Any]:
    return dict(vars(cls).get("__annotations__", {}))


class _Variables(metaclass=Sealed):
    """Stands for a context of variables, which programs do not have; a thread of Python 3.14 is run in one."""

    __slots__ = ()

    def run(self, function: Callable[..., Any], *args: Any) -> Any:
        """Call a function."""
        return function(*args)


def _signature(cls: type) -> str:
    from elitescript.runtime.stdlib.signatures import signature_of

    return signature_of(cls)


_REPLACEMENTS: Final[dict[str, Any]] = {
    "_contextvars": SimpleNamespace(Context=_Variables, copy_context=_Variables),
    "_queue": ABSENT,
    "inspect": SimpleNamespace(
        get_annotations=_annotations,
        getattr_static=lambda *args: real("inspect").getattr_static(*args),
        signature=_signature,
        unwrap=lambda function: function,
    ),
    "os": SimpleNamespace(),
}
"""Replacements of modules for every copy."""
