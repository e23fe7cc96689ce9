"""`_thread` for the private copies of `threading` and `queue`: threads are strands, time is virtual.

The names are those that the copies take, on Python 3.11 to 3.14. Scripts never see this module.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from types import SimpleNamespace
from typing import Any, NoReturn, Protocol

from elitescript.messages.timing import ticks_for
from elitescript.runtime.stdlib.locks import TIMEOUT_MAX, lock, new_lock, new_rlock, release_at_end
from elitescript.runtime.threads.scheduler import Scheduler
from elitescript.runtime.threads.strand import ENDED, STOP, Stopped, Strand
from elitescript.sealed import Sealed, hidden_slot, no_copy


class ThreadPort(Protocol):
    """Lists the members of the program that the module uses."""

    scheduler: Scheduler

    @property
    def main(self) -> Strand:
        """The main strand."""

    def start_thread(self, function: Callable[..., Any], args: tuple[Any, ...], name: str) -> int:
        """Start a strand; see `commands.definition.context.Robot.start_thread`."""

    def thread_failed(self, error: BaseException) -> None:
        """Report an exception that has left the function of a thread."""


class ThreadHandle(metaclass=Sealed):
    """The handle of `threading.Thread` of Python 3.13."""

    __slots__ = ("_state",)
    __module__ = "_thread"
    __reduce_ex__ = no_copy

    def __init__(self) -> None:
        _state.__set__(self, _HandleState())

    @property
    def ident(self) -> int:
        """Handle of the strand; 0 before the start."""
        strand = _state_of(self).strand
        return 0 if strand is None else int(strand.handle)

    def is_done(self) -> bool:
        """Return whether the thread has ended."""
        state: _HandleState = _state_of(self)
        return state.is_done or (state.strand is not None and state.strand.state == ENDED)

    def _set_done(self) -> None:
        _state_of(self).is_done = True

    def join(self, timeout: float | None = None) -> None:
        """Wait until the thread has ended, or for a timeout in seconds."""
        state: _HandleState = _state_of(self)
        if self.is_done():
            return
        assert state.strand is not None and state.scheduler is not None
        if state.strand is state.scheduler.current:
            raise RuntimeError("Cannot join current thread")
        if timeout != 0:
            waits_for_ever = timeout is None or timeout < 0
            until = None if waits_for_ever else state.scheduler.now + max(1, ticks_for(timeout or 0.0))
            state.scheduler.join(state.strand, until)


class _HandleState:
    __slots__ = ("is_done", "scheduler", "strand")

    def __init__(self) -> None:
        self.strand: Strand | None = None
        self.scheduler: Scheduler | None = None
        self.is_done = False


_state = hidden_slot(ThreadHandle, "_state")
_state_of = _state.__get__


class local(metaclass=Sealed):
    """Attributes with a value of its own in each thread."""

    __slots__ = ("_space",)
    __module__ = "_thread"
    __reduce_ex__ = no_copy

    def __getattribute__(self, name: str) -> Any:
        values = _values(self)
        return values[name] if name in values else object.__getattribute__(self, name)

    def __setattr__(self, name: str, value: Any) -> None:
        _values(self)[name] = value

    def __delattr__(self, name: str) -> None:
        if name not in _values(self):
            raise AttributeError(f"'local' object has no attribute {name!r}")
        del _values(self)[name]


class _Space:
    __slots__ = ("args", "kwargs", "scheduler", "values")

    def __init__(self, scheduler: Scheduler, args: tuple[Any, ...], kwargs: dict[str, Any]) -> None:
        self.scheduler = scheduler
        self.args = args
        self.kwargs = kwargs
        self.values: dict[int, dict[str, Any]] = {}


_space = hidden_slot(local, "_space")


def _values(instance: local) -> dict[str, Any]:
    space: _Space = _space.__get__(instance)
    strand = space.scheduler.current
    key = -1 if strand is None else strand.order
    values = space.values.get(key)
    if values is None:
        values = space.values[key] = {}
        type(instance).__init__(instance, *space.args, **space.kwargs)
    return values


def thread_module(port: ThreadPort, *, is_loading: Callable[[], bool]) -> SimpleNamespace:
    """Return `_thread` for one program.

    Args:
        port: the program.
        is_loading: whether the copy of `threading` is being loaded; its main thread is the main strand,
            whichever strand imports it first.
    """
    scheduler = port.scheduler

    def current() -> Strand:
        strand = port.main if is_loading() else scheduler.current
        return port.main if strand is None else strand

    def get_ident() -> int:
        return current().handle

    def allocate_lock() -> lock:
        return new_lock(scheduler)

    def set_sentinel() -> lock:
        sentinel = new_lock(scheduler)
        current().at_end.append(lambda: release_at_end(sentinel))
        return sentinel

    def start_new_thread(
        function: Callable[..., Any], args: tuple[Any, ...] = (), kwargs: dict[str, Any] | None = None
    ) -> int:
        call = (lambda *values: function(*values, **kwargs)) if kwargs else function
        return port.start_thread(call, tuple(args), _name_of(function))

    def start_joinable_thread(
        function: Callable[..., Any], handle: ThreadHandle | None = None, daemon: bool = True
    ) -> ThreadHandle:
        handle = ThreadHandle() if handle is None else handle
        _bind(handle, port.start_thread(function, (), _name_of(function)))
        return handle

    def make_thread_handle(ident: int) -> ThreadHandle:
        handle = ThreadHandle()
        _bind(handle, ident)
        return handle

    def _bind(handle: ThreadHandle, ident: int) -> None:
        state = _state_of(handle)
        state.strand = scheduler.find(ident)
        state.scheduler = scheduler
        state.is_done = state.strand is None

    def exit_thread() -> NoReturn:
        strand = scheduler.current
        if strand is not None:
            scheduler.kill(strand)
        raise Stopped

    def excepthook(args: SimpleNamespace) -> None:
        error = args.exc_value
        if isinstance(error, STOP):
            raise error
        port.thread_failed(error)

    def new_local(cls: type, *args: Any, **kwargs: Any) -> local:
        instance: local = object.__new__(cls)
        _space.__set__(instance, _Space(scheduler, args, kwargs))
        return instance

    local_type = Sealed("local", (local,), {"__slots__": (), "__module__": "_thread", "__new__": new_local})
    return SimpleNamespace(
        RLock=lambda: new_rlock(scheduler),
        LockType=allocate_lock,
        TIMEOUT_MAX=TIMEOUT_MAX,
        _ExceptHookArgs=_hook_args,
        _ThreadHandle=ThreadHandle,
        _excepthook=excepthook,
        _get_main_thread_ident=lambda: port.main.handle,
        _is_main_interpreter=lambda: True,
        _local=local_type,
        _make_thread_handle=make_thread_handle,
        _set_sentinel=set_sentinel,
        _shutdown=lambda: None,
        allocate_lock=allocate_lock,
        daemon_threads_allowed=lambda: True,
        error=RuntimeError,
        exit=exit_thread,
        get_ident=get_ident,
        get_native_id=get_ident,
        stack_size=lambda size=0: 0,
        start_joinable_thread=start_joinable_thread,
        start_new_thread=start_new_thread,
    )


def _hook_args(values: Iterable[Any]) -> SimpleNamespace:
    _, exc_value, _, thread = values
    return SimpleNamespace(exc_type=type(exc_value), exc_value=exc_value, exc_traceback=None, thread=thread)


def _name_of(function: Callable[..., Any]) -> str:
    """Return the name of the `Thread` whose method is started, or else of the function."""
    owner = getattr(function, "__self__", None)
    return str(getattr(owner, "_name", "") or getattr(function, "__name__", "thread"))
