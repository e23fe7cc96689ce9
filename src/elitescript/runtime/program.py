"""Holds namespace and resources of one run."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from types import BuiltinFunctionType, CodeType, FunctionType, ModuleType
from typing import TYPE_CHECKING, Any, Final

from elitescript.commands.catalogue import CATALOGUE
from elitescript.commands.definition.context import Machine
from elitescript.errors import ProgramError, ScriptPermissionError
from elitescript.language.compiler import CompiledUnit, Statement, compile_expression, compile_unit
from elitescript.language.diagnostics import line_kept
from elitescript.language.hooks import MAIN
from elitescript.language.options import Options
from elitescript.language.text.source import SourceFile
from elitescript.messages.events import Alarm
from elitescript.messages.profile import Profile
from elitescript.records import replace
from elitescript.runtime.alarms import alarm_of
from elitescript.runtime.environment import ProgramEnvironment
from elitescript.runtime.files import OpenFiles
from elitescript.runtime.names.bindings import Bindings
from elitescript.runtime.names.context import Context, ProgramControl
from elitescript.runtime.names.modules import Facade, ModuleShelf
from elitescript.runtime.probe import witness
from elitescript.runtime.program_globals import ProgramGlobals
from elitescript.runtime.threads.scheduler import Scheduler
from elitescript.runtime.threads.strand import Strand
from elitescript.said import said

if TYPE_CHECKING:
    from elitescript.runtime.probe import Probe
    from elitescript.runtime.stdlib.subprocess_module import ProcessTable

SECONDARIES_KEPT: Final = 16
"""Secondary programs, the newest ones, that are kept for a debugger that may come."""
SOURCES_MAX: Final = 256
"""Texts of `eval` and `exec` that are kept, to show their lines."""

EMPTY: Final[Mapping[str, Any]] = {}

_NOT_SHOWN: Final = (FunctionType, BuiltinFunctionType, type, ModuleType, Facade)
"""Values that the variable monitor leaves out."""


class Program:
    """One run: its globals, built-ins and open resources.

    Args:
        machine: the controller.
        scheduler: runs its threads.
        profile: the firmware.
        world: environment.
        seed: of its random numbers.
        port: the host.
        presets: program globals that have a value before it begins.
        probe: counts its statements.

    Attributes:
        context: for the bodies of commands.
        bindings: predefined names.
        builtins: those of them that its code has named so far.
        globals: its program globals.
        main: the strand of its body.
        units: that have run in it and have probes: the program itself, and the newest secondary programs.
    """

    __slots__ = (
        "_files",
        "_generator",
        "_main",
        "_processes",
        "_profile",
        "_sources",
        "bindings",
        "builtins",
        "context",
        "globals",
        "scheduler",
        "shelf",
        "units",
    )

    def __init__(
        self,
        *,
        machine: Machine,
        scheduler: Scheduler,
        profile: Profile,
        world: ProgramEnvironment,
        seed: int,
        port: ProgramControl,
        presets: dict[str, object],
        probe: Probe | None = None,
    ) -> None:
        self.scheduler = scheduler
        self._profile = profile
        self._generator = _LazyGenerator(seed)
        self.context = Context(machine, scheduler, profile, self._generator, world, port)
        self._files = OpenFiles(world, scheduler.note_call)
        self._sources: dict[str, SourceFile] = {}
        self._main: Strand | None = None
        self.units: list[CompiledUnit] = []
        self._processes: ProcessTable | None = None
        self.shelf = ModuleShelf(self, scheduler)
        self.bindings = Bindings(
            self.context,
            shelf=self.shelf,
            files=self._files,
            evaluate=self._evaluator(),
            execute=self._executor(),
            probe_hooks={} if probe is None else probe.hooks(),
            refused=None if (observing := witness(probe)) is None else observing.refused,
        )
        self.builtins = self.bindings.names
        self.globals = ProgramGlobals({"__name__": "__main__", "__builtins__": self.builtins, **presets})

    @property
    def main(self) -> Strand:
        """The main strand; in a namespace without a program, the strand that runs."""
        strand = self._main or self.scheduler.current
        assert strand is not None
        return strand

    @main.setter
    def main(self, strand: Strand) -> None:
        self._main = strand

    def body_of(self, unit: CompiledUnit, variables: Mapping[str, Any] = EMPTY) -> Callable[[], None]:
        """Return the body of a unit as a function with the names of this program, and with variables to read."""
        self._add_source(unit.source)
        self.bindings.bind(unit.code)
        if unit.shows_hash_order:
            self.bindings.number_classes()
        if unit.probes.size:
            # The first one is the program itself.
            del self.units[1 : len(self.units) - SECONDARIES_KEPT]
            self.units.append(unit)

        def body() -> None:
            if variables:
                outer = self.globals.values
                # Bodies of classes ask a dict alone, past `__missing__`.
                asked = {name: outer[name] for name in _names_of_classes(unit.code) if name in outer}
                names = _Scope(outer, asked | dict(variables))
                dict.__setitem__(names, "__builtins__", self.builtins)
                exec(unit.code, names)
                names.pop(MAIN)()
                return
            exec(unit.code, self.globals.values)
            self.globals.values.pop(MAIN)()

        return body

    def monitor(self) -> dict[str, Any]:
        """Return the variable monitor: program globals that have a value, in the order of their first assignment."""
        return {name: value for name, value in self.globals.own().items() if is_shown(value)}

    def execute(self, statement: Statement, names: Any) -> None:
        """Run a statement of interpreter mode; `names` maps its variables."""
        self._sources[statement.source.name] = statement.source
        self.bindings.bind(statement.code)
        self.bindings.number_classes()
        exec(statement.code, self.globals.values, names)

    def value_of(self, code: CodeType) -> Any:
        """Evaluate a compiled expression; it sees the program globals and changes none by assignment."""
        return self._value(code, _Scope(self.globals.values, {}))

    def value_in(self, code: CodeType, names: dict[str, Any]) -> Any:
        """Evaluate a compiled expression with variables before the program globals."""
        return self._value(code, _Scope(self.globals.values, names))

    def _value(self, code: CodeType, names: _Scope) -> Any:
        self.bindings.bind(code)
        dict.__setitem__(names, "__builtins__", self.builtins)
        return eval(code, names)

    def alarm(self, error: BaseException, strand: Strand) -> Alarm:
        """Return the alarm for an uncaught exception."""
        return alarm_of(
            error,
            clock=lambda: self.context.machine.tick,
            thread=strand.name,
            started_line=strand.started_line,
            builtins=self.builtins,
            known=self.bindings.known(),
            sources=self._sources,
            catalogue=CATALOGUE,
            profile=self._profile,
            missing=self.context.missing,
        )

    @property
    def source(self) -> SourceFile | None:
        """The text of the program; None before it has one."""
        return next(iter(self._sources.values()), None)

    def shown(self, alarm: Alarm) -> Alarm:
        """Return an alarm from outside with the text of the program's line."""
        source = self.source
        if source is None or not alarm.line:
            return alarm
        text = source.line(alarm.line)
        column = len(text) - len(text.lstrip()) + 1
        return replace(alarm, column=column, source_line=line_kept(text, column))

    def close(self) -> None:
        """Release the resources of the program; its globals stay readable."""
        self.context.flush()
        self.context.close_connections()
        self._files.close()
        self.bindings.forget_identities()

    def _add_source(self, source: SourceFile) -> None:
        if len(self._sources) < SOURCES_MAX:
            self._sources.setdefault(source.name, source)

    # ---------------------------------------------------------------- eval and exec

    def _evaluator(self) -> Callable[..., Any]:
        def evaluate(expression: Any, scope: Any = None, inner: Any = None) -> Any:
            """Evaluate an expression with the variables of the calling function and the program globals.

            Raises:
                SyntaxError: no expression, or a forbidden name.
            """
            self.scheduler.note_call()
            if type(expression) is not str:
                raise TypeError(f"eval() takes a str, not {type(expression).__name__}")
            try:
                code = compile_expression(SourceFile("<eval>", expression))
            except ProgramError as error:
                raise _syntax_error(error) from None
            if scope is None:
                # A caller that is not script code has variables that are not the program's.
                frame = sys._getframe(1)
                names = _Scope(self.globals.values, frame.f_locals if frame.f_builtins is self.builtins else {})
            else:
                names = _Scope(_checked_scope(scope), {} if inner is None else _checked_scope(inner))
            return self._value(code, names)

        evaluate.__name__ = evaluate.__qualname__ = "eval"
        return evaluate

    def _executor(self) -> Callable[..., None]:
        def execute(text: Any, *names: Any) -> None:
            """Run statements that share the program globals, and read the variables of the calling function.

            Raises:
                SyntaxError: no program, or a forbidden name.
            """
            self.scheduler.note_call()
            if type(text) is not str:
                raise TypeError(f"exec() takes a str, not {type(text).__name__}")
            if names:
                raise ScriptPermissionError(
                    "exec() takes no dicts of names",
                    command="exec",
                    hint="write `global x` in the text and read x, or compute one value with eval(text, names)",
                )
            try:
                unit = compile_unit(SourceFile(f"<exec {len(self._sources)}>", text), Options(kind="script"))
            except ProgramError as error:
                raise _syntax_error(error) from None
            frame = sys._getframe(1)
            variables = frame.f_locals if frame.f_builtins is self.builtins and not unit.global_names else {}
            self.body_of(unit, variables)()

        execute.__name__ = execute.__qualname__ = "exec"
        return execute

    # ---------------------------------------------------------------- modules

    def module_names(self, name: str) -> dict[str, Any]:
        """Return the names of a module of the runtime."""
        from elitescript.runtime.names.own_modules import own_names

        return own_names(name, self)

    def copy_replacements(self, is_loading_threads: Callable[[], bool]) -> dict[str, Any]:
        """Return the replacements of modules for private copies."""
        from types import SimpleNamespace

        from elitescript.runtime.stdlib.thread_module import thread_module
        from elitescript.runtime.stdlib.time_module import clock_names, copy_clock

        clock = {**clock_names(self.context), "monotonic": copy_clock(self.context)}
        return {
            "_thread": thread_module(self, is_loading=is_loading_threads),
            "random": self.shelf.facade("random"),
            "time": SimpleNamespace(**clock),
        }

    def build_class(self, *args: Any, **options: Any) -> type:
        """See `ModulePort.build_class`."""
        made: type = self.builtins["__build_class__"](*args, **options)
        return made

    def numbering(self) -> Callable[[Any], int]:
        """See `ModulePort.numbering`."""
        return self.bindings.identities.number_for_copies

    def copy_names(self) -> dict[str, dict[str, Any]]:
        """See `ModulePort.copy_names`."""
        return {"threading": {"id": self.bindings.identities.number}}

    def start_thread(self, function: Callable[..., Any], args: tuple[Any, ...], name: str) -> int:
        """See `Context.start_thread`."""
        return self.context.start_thread(function, args, name)

    def thread_failed(self, error: BaseException) -> None:
        """See `Context.thread_failed`."""
        self.context.thread_failed(error)

    def generator(self) -> Any:
        """Return the generator of the program's random numbers, for the module `random`."""
        return self._generator.made()

    @property
    def processes(self) -> ProcessTable:
        """The simulated processes of the program."""
        if self._processes is None:
            from elitescript.runtime.stdlib.subprocess_module import ProcessTable

            self._processes = ProcessTable()
        return self._processes


def _names_of_classes(code: CodeType) -> set[str]:
    """Return the names in the bodies of classes in a code."""
    found: set[str] = set()
    codes = [value for value in code.co_consts if type(value) is CodeType]
    while codes:
        inner = codes.pop()
        if not inner.co_flags & _OPTIMIZED:
            found.update(inner.co_names)
        codes += [value for value in inner.co_consts if type(value) is CodeType]
    return found


def is_shown(value: object) -> bool:
    """Return whether the variable monitor shows a value."""
    return not isinstance(value, _NOT_SHOWN)


_OPTIMIZED: Final = 0x01
"""Flag of the code of a function; that of a class has it not (`inspect.CO_OPTIMIZED`, without importing it)."""


class _LazyGenerator:
    """A random generator that is made when the first number is drawn."""

    __slots__ = ("_made", "_seed")

    def __init__(self, seed: int) -> None:
        self._seed = seed
        self._made: Any = None

    def made(self) -> Any:
        if self._made is None:
            from elitescript.runtime.stdlib.random_module import new_generator

            self._made = new_generator(self._seed)
        return self._made

    def random(self) -> float:
        return float(self.made().random())


class _Scope(dict[str, Any]):
    """Names of an expression: those of the calling function, then the present program globals."""

    __slots__ = ("_outer",)

    def __init__(self, outer: dict[str, Any], own: dict[str, Any]) -> None:
        super().__init__(own)
        self._outer = outer

    def __missing__(self, name: str) -> Any:
        return self._outer[name]


def _checked_scope(scope: Any) -> dict[str, Any]:
    """Return a copy of a dict of names for `eval`.

    Raises:
        ScriptPermissionError: a forbidden name.
    """
    if type(scope) is not dict:
        raise TypeError(f"eval() takes its names from a dict, not {type(scope).__name__}")
    for name in scope:
        if type(name) is not str or name.startswith(("__", "@")):
            raise ScriptPermissionError(said("eval(): {name!r} cannot be a name", name=name), value=str(name))
    return dict(scope)


def _syntax_error(error: ProgramError) -> SyntaxError:
    problem = next(problem for problem in error.problems if problem.is_error)
    return SyntaxError(problem.text)
