"""Compiles text to Python code.

`compile_unit` compiles a text to one function; calling it runs the program. The body is compiled as
the body of a function, even without a `def` around it: names are local to it and visible to the
functions inside it, and `global` makes them program globals, which the variable monitor shows.
"""

from __future__ import annotations

import ast
import warnings
from collections.abc import Callable, Mapping, Sequence
from types import CodeType
from typing import Final

from elitescript.errors import ProgramError
from elitescript.language.advice.syntax_errors import explain
from elitescript.language.checkpoints import insert_checkpoints
from elitescript.language.diagnostics import Diagnostic, diagnostic, in_order
from elitescript.language.garbage import without_collection
from elitescript.language.hash_order import shows_hash_order
from elitescript.language.hooks import MAIN
from elitescript.language.kept_units import KeptUnits
from elitescript.language.limits import too_deep
from elitescript.language.nodes import FUNCTIONS, Census
from elitescript.language.options import DEFAULT, LINE, Options
from elitescript.language.parser import NO_FILE, Parsed, character_offset, parse, parse_without, read_again, syntax_tree
from elitescript.language.policy import first_too_deep, guard_attributes, obey_futures, review
from elitescript.language.probes import (
    ATTACH_PROBES,
    NO_PROBES,
    CountedStatement,
    ProbeTable,
    insert_probes,
    number_statements,
)
from elitescript.language.text.source import SourceFile
from elitescript.records import NamedTuple, record, replace
from elitescript.said import said

_SCRIPT_NAME: Final = "main"
"""The name of an unnamed program in qualified names and stack listings."""


@record
class CompiledUnit:
    """A program that can run.

    Attributes:
        source: the text.
        kind: `program`, `secondary`, `script` or `line`.
        name: the name behind `def` or `sec`; empty for a script or a line.
        code: module code; executing it in a dict binds one function, `MAIN`, and nothing else.
            Names of `HOOKS` must be among the builtins. Default values of the program's
            parameters are computed while it executes.
        global_names: names that the text declares `global`, anywhere.
        diagnostics: warnings, in the order of the text.
        has_line_marks: it calls the `@line` hook.
        shows_hash_order: it may show the order of a set; see `language.hash_order`.
        probes: what its probes count; none unless `Options.probes` asks for them.
        findings: all of `check`, in the order of the text; None if the text was compiled without.
    """

    source: SourceFile
    kind: str
    name: str
    code: CodeType
    global_names: frozenset[str]
    diagnostics: tuple[Diagnostic, ...]
    has_line_marks: bool
    shows_hash_order: bool
    probes: ProbeTable = NO_PROBES
    findings: tuple[Diagnostic, ...] | None = None

    @property
    def statements(self) -> Sequence[CountedStatement]:
        """The statements that its probes count, in the order of the text."""
        return self.probes.statements


KEPT: Final[KeptUnits[CompiledUnit]] = KeptUnits()
"""Units of texts that this process has compiled; a unit has no state."""


@without_collection
def compile_unit(source: SourceFile, options: Options = DEFAULT) -> CompiledUnit:
    """Compile a text.

    Raises:
        ProgramError: it is not a program; holds all findings, errors and warnings, in the order
            of the text.
    """
    return compile_parsed(parse(source, options))


def compile_task(source: SourceFile, options: Options = DEFAULT) -> CompiledUnit:
    """Compile a text that is about to run, and report if nothing in it runs.

    The same text with the same options gives the unit of the last time, if that is still kept: see `kept_units`.

    Raises:
        ProgramError: as `compile_unit`; in a strict run also a text in which nothing runs.
    """
    if options.probes or source.notes or source.tree is not None:
        # Numbers of probes belong to one robot; notes are about files beside the text, lines of a tree about its file.
        return _compile_task(source, options)
    key = (source.name, source.text, source.places, options)
    unit = KEPT.get(key)
    if unit is None:
        unit = _compile_task(source, options)
        KEPT.put(key, unit, len(source.text))
    return unit


@without_collection
def _compile_task(source: SourceFile, options: Options) -> CompiledUnit:
    parsed = parse(source, options)
    problem = None
    if len(parsed.tree.body) > 1 and not parsed.has_errors:
        from elitescript.language.idle import calls_something, idle_problem

        problem = idle_problem(parsed, calls_something)
    unit = compile_parsed(parsed)
    if problem is None:
        return unit
    problems = in_order((*unit.diagnostics, problem))
    if problem.is_error:
        raise ProgramError(problems)
    return replace(unit, diagnostics=problems)


@without_collection
def compile_parsed(parsed: Parsed, census: Census | None = None) -> CompiledUnit:
    """Compile a text that was read. Uses up the tree: analyse it before.

    Args:
        parsed: the text.
        census: of its tree, if there is one already.

    Raises:
        ProgramError: as `compile_unit`.
    """
    made = _compile(parsed, census)
    if made.code is None or any(problem.is_error for problem in made.problems):
        raise ProgramError(made.problems)
    return CompiledUnit(
        parsed.source,
        parsed.kind,
        parsed.name,
        made.code,
        made.global_names,
        made.problems,
        parsed.has_line_marks,
        made.shows_hash_order,
        made.probes,
    )


@without_collection
def check_unit(source: SourceFile, options: Options = DEFAULT) -> tuple[Diagnostic, ...]:
    """Return all findings about a text, errors and warnings, in its order; never raises `ProgramError`."""
    return _compile(parse(source, options)).problems


@without_collection
def problems_in(parsed: Parsed, census: Census) -> tuple[Diagnostic, ...]:
    """Return all findings about a text that was read, as `check_unit`, and leave its tree as it is.

    Args:
        parsed: the text.
        census: of its tree.
    """
    if parsed.is_complete and first_too_deep(census) is None:
        try:
            _python(_wrapped(parsed), "exec")
            return in_order([*parsed.diagnostics, *_breaches(parsed, census)])
        except (SyntaxError, RecursionError, MemoryError, ValueError, OverflowError):
            # What is wrong is found by leaving out lines.
            pass
        finally:
            if parsed.unit is not None:
                parsed.unit.name = parsed.name
    return _compile(read_again(parsed) if parsed.is_complete else parsed).problems


def compile_expression(source: SourceFile) -> CodeType:
    """Compile one expression under the same policy, with checkpoints, for `eval`.

    Raises:
        ProgramError: it is not an expression, or names what programs may not use.
    """
    parsed = parse(SourceFile(source.name, source.text.strip(" \t")), Options(kind=LINE))
    problems = list(parsed.diagnostics)
    statements = parsed.tree.body
    if not parsed.has_errors and not (len(statements) == 1 and isinstance(statements[0], ast.Expr)):
        hint = "it takes one value, such as 1 + 2"
        problems.append(diagnostic("E001", 1, 1, "this is not an expression", hint=hint))
    elif not parsed.has_errors:
        assert isinstance(statements[0], ast.Expr)
        tree = ast.Expression(statements[0].value)
        census = Census(tree)
        problems += review(parsed.source, census)
        if not any(problem.is_error for problem in problems):
            guard_attributes(tree, census)
            insert_checkpoints(census)
            code = _code_or_problem(tree, "eval", parsed.source, "expression", problems)
            if code is not None:
                return code
    raise ProgramError(in_order(problems))


@record
class Statement:
    """A line of interpreter mode that can run.

    Attributes:
        source: the text.
        code: module code; its names are looked up where it is executed.
        calls: names that it calls, anywhere.
    """

    source: SourceFile
    code: CodeType
    calls: frozenset[str]


def compile_statement(source: SourceFile, has_global: Callable[[str], bool]) -> Statement:
    """Compile a line of interpreter mode: one or more statements, blocks closed by `end` on the same line.

    Args:
        source: the line.
        has_global: whether a program global exists; `global` makes no new ones.

    Raises:
        ProgramError: it does not compile.
    """
    parsed = parse(source, Options(kind=LINE, one_line_blocks=True))
    problems = list(parsed.diagnostics)
    if parsed.is_complete and not parsed.has_errors:
        census = Census(parsed.tree)
        problems += review(parsed.source, census)
        for node in census.of(ast.Global):
            problems += [
                diagnostic(
                    "E001",
                    node.lineno,
                    1,
                    said("there is no program global {name!r}, and none can be made here", name=name),
                )
                for name in node.names
                if not has_global(name)
            ]
        calls = frozenset(node.func.id for node in census.of(ast.Call) if isinstance(node.func, ast.Name))
        if first_too_deep(census) is None and not any(problem.is_error for problem in problems):
            obey_futures(census)
            guard_attributes(parsed.tree, census)
            insert_checkpoints(census)
            code = _code_or_problem(parsed.tree, "exec", parsed.source, "statement", problems)
            if code is not None:
                return Statement(source, code, calls)
    raise ProgramError(in_order(problems))


def column_of(source: SourceFile, line: int, byte_offset: int) -> int:
    """Return the column, from 1, in characters, of a UTF-8 offset in a line, as code objects and tracebacks count."""
    return character_offset(source.line(line), byte_offset) + 1


# The steps


class _Compiled(NamedTuple):
    code: CodeType | None
    """None if there is none."""
    global_names: frozenset[str]
    problems: tuple[Diagnostic, ...]
    shows_hash_order: bool
    probes: ProbeTable = NO_PROBES


def _compile(parsed: Parsed, census: Census | None = None) -> _Compiled:
    problems = list(parsed.diagnostics)
    if not parsed.is_complete:
        return _Compiled(None, frozenset(), in_order(problems), True)
    if census is None:
        census = Census(parsed.tree)
    shows = shows_hash_order(census)
    global_names = frozenset(name for node in census.of(ast.Global) for name in node.names)
    problems += _breaches(parsed, census)
    if first_too_deep(census) is not None:
        return _Compiled(None, global_names, in_order(problems), shows)
    probes = NO_PROBES
    numbers: Mapping[ast.stmt, int] = {}
    if not any(problem.is_error for problem in problems):
        obey_futures(census)
        guard_attributes(parsed.tree, census)
        options = parsed.options
        if options.probes == ATTACH_PROBES:
            probes, numbers = number_statements(parsed.body, parsed.source, options.first_probe)
        elif options.probes:
            probes = insert_probes(census, parsed.body, parsed.source, options.probes, options.first_probe)
        insert_checkpoints(census)
    code = _code(parsed, problems, numbers)
    return _Compiled(code, global_names, in_order(problems), shows, probes)


def _breaches(parsed: Parsed, census: Census) -> list[Diagnostic]:
    """Return what Python would accept, but not a robot."""
    problems = review(parsed.source, census) + _header_problems(parsed)
    if census.by_kind[ast.Yield] or census.by_kind[ast.YieldFrom]:
        problems += _own_yields(parsed)
    return problems


def _header_problems(parsed: Parsed) -> list[Diagnostic]:
    """Report parameters of a unit that have no default value, as a program gets no arguments."""
    if parsed.unit is None:
        return []
    args = parsed.unit.args
    positional = [*args.posonlyargs, *args.args]
    missing = positional[: len(positional) - len(args.defaults)]
    missing += [arg for arg, default in zip(args.kwonlyargs, args.kw_defaults, strict=True) if default is None]
    return [
        diagnostic(
            "E107",
            argument.lineno,
            column := column_of(parsed.source, argument.lineno, argument.col_offset),
            said("the parameter `{arg}` of the program has no default value", arg=argument.arg),
            end_column=column + len(argument.arg),
            hint=said(
                "a `def` at the start of a line is a program of its own and gets no arguments; put a "
                "function into the `def` that calls it, or write {arg}=...",
                arg=argument.arg,
            ),
        )
        for argument in missing
    ]


def _own_yields(parsed: Parsed) -> list[Diagnostic]:
    """Report `yield` in the body of the program, which would make it a generator that never runs."""
    problems = []
    stack: list[ast.AST] = list(parsed.body)
    while stack:
        node = stack.pop()
        if isinstance(node, (ast.Yield, ast.YieldFrom)):
            column = column_of(parsed.source, node.lineno, node.col_offset)
            text = "`yield` cannot stand in the body of the program itself"
            problems.append(
                diagnostic("E001", node.lineno, column, text, end_column=column + 5, hint="put it into a function")
            )
        if not isinstance(node, (*FUNCTIONS, ast.AsyncFunctionDef, ast.ClassDef)):
            stack.extend(ast.iter_child_nodes(node))
    return problems


def _code(parsed: Parsed, problems: list[Diagnostic], numbers: Mapping[ast.stmt, int]) -> CodeType | None:
    """Compile; report a mistake that only Python's compiler finds, and leave it out to find the next.

    Args:
        parsed: the text.
        problems: gets what is found.
        numbers: of the statements that a debugger may look at later; see `switches`.
    """
    known = {(problem.code, problem.line, problem.column) for problem in problems}
    blamed = {problem.line for problem in problems if problem.is_error}
    current: Parsed | None = parsed
    while current is not None and current.is_complete:
        module = _wrapped(current)
        if numbers:
            from elitescript.language.switches import with_switches

            module = with_switches(module, numbers)
        try:
            return _named(_python(module, "exec"), parsed.source.name, parsed.name or _SCRIPT_NAME)
        except SyntaxError as error:
            from elitescript.language.hoisting import hoist_late_globals

            late = hoist_late_globals(current)
            fresh = [item for item in late if (item.code, item.line, item.column) not in known]
            problems += fresh
            known.update((item.code, item.line, item.column) for item in fresh)
            if late:
                continue
            problem = _syntax_problem(error, parsed.source)
            # A variable may be missing only because the line that makes it is left out.
            is_consequence = error.msg.startswith("no binding for nonlocal") and _is_hidden(current, error.msg)
            if problem.line not in blamed and not is_consequence:
                problems.append(problem)
                blamed.add(problem.line)
            current = parse_without(current, error.lineno or 1)
        except (RecursionError, MemoryError, ValueError, OverflowError) as error:
            problems.append(diagnostic("E001", 1, 1, too_deep(parsed.source.text, error, "compiled")))
            return None
    return None


def _code_or_problem(
    tree: ast.AST, mode: str, source: SourceFile, what: str, problems: list[Diagnostic]
) -> CodeType | None:
    """Compile a tree; None if that fails, with the reason added to `problems`."""
    try:
        return _named(_python(tree, mode), source.name, "")
    except SyntaxError as error:
        problems.append(_syntax_problem(error, source))
    except (RecursionError, MemoryError, ValueError, OverflowError):
        problems.append(diagnostic("E001", 1, 1, said("the {what} is nested too deeply to be compiled", what=what)))
    return None


def _is_hidden(parsed: Parsed, message: str) -> bool:
    """Return whether the name in Python's message stands in a line that was left out."""
    name = message.split("'")[1]
    lines = (parsed.translation.lines[index] for index in parsed.hidden)
    return any(name in parsed.source.line(row) for line in lines for row in range(line.line, line.last_line + 1))


def _python(tree: ast.AST, mode: str) -> CodeType:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        code = compile(tree, NO_FILE, mode, dont_inherit=True, optimize=0)  # type: ignore[call-overload]
    assert isinstance(code, CodeType)
    return code


def _wrapped(parsed: Parsed) -> ast.Module:
    """Return a module that defines the program as the function `MAIN`."""
    unit = parsed.unit
    if unit is None:
        definition = syntax_tree("def main(): pass").body[0]
        assert isinstance(definition, ast.FunctionDef)
        if parsed.tree.body:
            definition.body = parsed.tree.body
        unit = definition
    unit.name = MAIN
    return ast.Module(body=[unit], type_ignores=[])


def _named(code: CodeType, file: str, name: str) -> CodeType:
    """Set the names of the file and of the program wherever Python shows one."""
    constants = tuple(_named(item, file, name) if isinstance(item, CodeType) else item for item in code.co_consts)
    qualified = code.co_qualname
    if qualified != MAIN and not qualified.startswith(f"{MAIN}."):
        return code.replace(co_filename=file, co_consts=constants)
    own = name + qualified[len(MAIN) :]
    # The body of a class carries its qualified name as a constant.
    constants = tuple(own if item == qualified else item for item in constants)
    short = name if code.co_name == MAIN else code.co_name
    return code.replace(co_filename=file, co_consts=constants, co_qualname=own, co_name=short)


def _syntax_problem(error: SyntaxError, source: SourceFile) -> Diagnostic:
    line = min(max(1, error.lineno or 1), len(source.lines))
    row = source.line(line)
    column = min(column_of(source, line, max(0, (error.offset or 1) - 1)), len(row) + 1)
    text, hint = explain(error.msg, row)
    end = None
    if error.end_lineno == line and error.end_offset:
        end = max(column + 1, column_of(source, line, max(0, error.end_offset - 1)))
    return diagnostic("E001", line, column, text, end_column=end, hint=hint)
