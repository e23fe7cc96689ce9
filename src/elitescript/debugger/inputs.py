"""Changes that the user makes at a stop: inputs of the run, made again whenever it comes to that position."""

from __future__ import annotations

import ast
from collections.abc import Callable
from types import FrameType
from typing import Any, Final

from elitescript.controller.controller import Controller
from elitescript.controller.views.signals import Signals
from elitescript.debugger.api import Position
from elitescript.debugger.looking import CallFrame, Look
from elitescript.errors import DebugError, ElitescriptError, ProgramError
from elitescript.language.compiler import compile_expression, compile_statement
from elitescript.language.text.source import SourceFile
from elitescript.messages.signals import SIGNALS
from elitescript.records import record
from elitescript.runtime.host import ScriptHost
from elitescript.runtime.program import Program
from elitescript.runtime.threads.scheduler import FLOOR
from elitescript.runtime.threads.strand import is_stop
from elitescript.values.concrete import own_fields, parsed

WORK_MAX: Final = 100_000
"""Most checkpoints of a statement that is run at a stop. They are not those of the thread."""

CONSOLE: Final = "<console>"


@record
class Input:
    """A change by the user.

    Attributes:
        position: where it was made.
        thread: in whose variables; 0 for none.
        depth: calls above the outermost one of that thread.
        target: variable, item or signal to which the value is assigned; empty for a text that is run.
        text: an expression; without `target` an expression or a statement.
    """

    position: Position
    thread: int
    depth: int
    target: str
    text: str


def apply_input(change: Input, look: Look, controller: Controller, host: ScriptHost) -> Any:
    """Make a change in a run that stands at its position; return the value.

    Raises:
        DebugError: it cannot be made; what it has changed by then is to be dropped with the run.
    """
    call = look.call_at(change.thread, change.depth)
    if not change.target:
        return _run(change.text, look, call, host)
    value = look.value(change.text, call)
    _assign(parsed(change.target), value, look, call, controller, host)
    return value


def _assign(
    target: ast.expr, value: Any, look: Look, call: CallFrame | None, controller: Controller, host: ScriptHost
) -> None:
    if isinstance(target, ast.Name):
        _assign_name(target.id, value, look, call, controller, host)
        return
    if not isinstance(target, ast.Subscript | ast.Attribute):
        raise DebugError(f"{ast.unparse(target)} is nothing that can be set")
    held = target.value
    if isinstance(held, ast.Name) and held.id in SIGNALS and not _is_own(held.id, look, call):
        _set_signal(ast.unparse(target), value, controller)
        return
    if not _is_part(held, look, call):
        raise DebugError(f"{ast.unparse(target)} cannot be set: it is no part of a variable of the program")
    holder = look.value(ast.unparse(held), call)
    if isinstance(target, ast.Attribute):
        fields = own_fields(holder)
        if target.attr not in fields:
            raise DebugError(f"there is no attribute {target.attr!r} that can be set")
        fields[target.attr] = value
        return
    if type(holder) not in (list, dict):
        raise DebugError(f"items of a {type(holder).__name__} cannot be set")
    key = look.value(ast.unparse(target.slice), call)
    try:
        holder[key] = value
    except (LookupError, TypeError, ValueError) as error:
        raise DebugError(f"{type(error).__name__}: {error}") from None


def _is_part(node: ast.expr, look: Look, call: CallFrame | None) -> bool:
    """Return whether an expression names a variable of the program or a part of one, and not a copy."""
    while isinstance(node, ast.Attribute | ast.Subscript):
        if isinstance(node, ast.Subscript) and isinstance(node.slice, ast.Slice):
            return False
        node = node.value
    return isinstance(node, ast.Name) and _is_own(node.id, look, call)


def _is_own(name: str, look: Look, call: CallFrame | None) -> bool:
    return name in look.locals_of(call) or name in look.globals_of(call)


def _assign_name(
    name: str, value: Any, look: Look, call: CallFrame | None, controller: Controller, host: ScriptHost
) -> None:
    if call is not None and name in _local_names(call.frame):
        set_local(call.frame, name, value)
    elif name in look.globals_of(call):
        names = call.frame.f_globals if call is not None else _program(host).globals.values
        names[name] = value
    elif name in SIGNALS:
        _set_signal(name, value, controller)
    else:
        raise DebugError(f"there is no variable {name!r} here")


def _local_names(frame: FrameType) -> frozenset[str]:
    code = frame.f_code
    return frozenset((*code.co_varnames, *code.co_cellvars, *code.co_freevars))


def set_local(frame: FrameType, name: str, value: Any) -> None:
    """Set a variable of a function that is being run."""
    frame.f_locals[name] = value
    if _to_fast is not None:
        _to_fast(frame)


def _old_python() -> Callable[[FrameType], None] | None:
    """Return what writes `f_locals` back; from Python 3.13 on they are the variables themselves."""
    import ctypes
    import sys

    if sys.version_info >= (3, 13):
        return None
    write = ctypes.pythonapi.PyFrame_LocalsToFast
    write.argtypes, write.restype = (ctypes.py_object, ctypes.c_int), None
    return lambda frame: write(frame, 0)


_to_fast: Final = _old_python()


def _set_signal(name: str, value: Any, controller: Controller) -> None:
    try:
        Signals(controller)[name.replace(" ", "")] = value
    except ElitescriptError as error:
        raise DebugError(str(error)) from None


def _program(host: ScriptHost) -> Program:
    if host.program is None:
        raise DebugError("no program has begun")
    return host.program


def _run(text: str, look: Look, call: CallFrame | None, host: ScriptHost) -> Any:
    """Run a text in the place of a call, as if the program had it there; nothing in it may wait."""
    program, scheduler = _program(host), host.scheduler
    before = look.locals_of(call)
    names = dict(before)
    source = SourceFile(CONSOLE, text.strip())
    current, scheduler.current = scheduler.current, scheduler.current if call is None else call.strand
    scheduler.fuel[:] = [*[False] * FLOOR, *[True] * WORK_MAX]
    value = None
    try:
        try:
            code = compile_expression(source)
        except ProgramError:
            statement = compile_statement(source, program.globals.has)
            program.execute(statement, names)
        else:
            value = program.value_in(code, names)
    except ProgramError as error:
        raise DebugError(error.problems[0].text) from None
    except BaseException as error:
        if is_stop(error):
            raise DebugError(
                "refused: it waits or does not end, and the robot stands while the run is stopped"
            ) from None
        if isinstance(error, KeyboardInterrupt):
            raise
        # Also those that leave `except Exception`, such as SystemExit: nothing that a user writes ends this process.
        raise DebugError(_described(error)) from None
    finally:
        scheduler.current = current
    for name, new in names.items():
        if name not in before or new is not before[name]:
            if call is not None and name in _local_names(call.frame):
                set_local(call.frame, name, new)
            elif not name.startswith(("__", "@")):
                program.globals.values[name] = new
    return value


def _described(error: BaseException) -> str:
    """Return an exception in words; a class of the program may have any `__str__`."""
    name = type(error).__name__
    try:
        return f"{name}: {error}"
    except BaseException as failed:
        if isinstance(failed, KeyboardInterrupt):
            raise
        return name
