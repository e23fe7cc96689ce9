"""The paths of a command line: what each argument reads or writes, checked and claimed before anything runs.

`cli.arguments` says of each argument whose value is a path what it `reads` or `writes`: a key of `READS` or `WRITES`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, Final

from elitescript.errors import ElitescriptError, ScriptError, UsageError
from elitescript.outputs.call_paths import FILE, NEW, ORDINARY, PAGE, REWRITTEN, Read, Written, check_paths
from elitescript.outputs.writing import Output
from elitescript.paths import PROGRAM_SUFFIX, is_program_name, is_task_name, real_path, stream_of
from elitescript.untrusted.files import PROGRAM, read_text

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse

    from elitescript.cli.plain_call import PathArgument


@contextmanager
def outputs_of(options: argparse.Namespace) -> Iterator[None]:
    """Check the paths of a call, and hold its outputs until its end.

    `options.outputs` has an `Output` for each option with a file that is written at once or in the end, by the name of
    the option in `options`. What the command has not finished is dropped.

    Raises:
        UsageError: an output cannot be written, would destroy an input or another output, or another process writes it.
    """
    arguments: dict[str, PathArgument] = options.paths
    is_rewriting = any(row.writes == "programs" and getattr(options, name) for name, row in arguments.items())
    reads = list(_reads(options, arguments, "programs" if is_rewriting else ""))
    held: dict[str, Output] = {}
    claimed: list[tuple[str, Written]] = []
    written: list[Written] = []
    for name, argument in arguments.items():
        value = getattr(options, name, None)
        if argument.writes and value not in (None, False):
            rows = list(WRITES[argument.writes](value, argument.flag, options))
            written += rows
            if argument.writes in CLAIMED:
                claimed.append((name, rows[0]))
    reads += _named_by_programs(options, arguments, written)
    check_paths(reads, written, is_forced=getattr(options, "force", False))
    options.outputs = held
    try:
        for name, row in claimed:
            held[name] = Output(row.path, row.called)
        yield
    finally:
        for output in held.values():
            output.drop()


def files_read(options: argparse.Namespace) -> dict[Path, bool]:
    """Return the files that a call reads, as far as they are known, each with whether the call may write it too."""
    arguments: dict[str, PathArgument] = options.paths
    is_rewriting = any(row.writes == "programs" and getattr(options, name) for name, row in arguments.items())
    found: dict[Path, bool] = {}
    for read in _reads(options, arguments, ""):
        path = Path(read.path)
        if path.is_dir():
            from elitescript.cli.program_texts import program_paths

            found.update(dict.fromkeys(program_paths(path, options.command), is_rewriting))
        elif stream_of(read.path) is None:
            found[path] = is_rewriting and read.noun == A_PROGRAM
    for path in [path for path in found if is_program_name(path.name)]:
        folder = Path(getattr(options, "task_dir", None) or real_path(path).parent)
        with suppress(ElitescriptError, OSError, ValueError):
            # Programs may write what they name.
            found.update({folder / name: True for name in _files_named_in(read_text(path, PROGRAM), path.name)})
    return found


def _reads(options: argparse.Namespace, arguments: dict[str, PathArgument], left_out: str) -> Iterator[Read]:
    for name, argument in arguments.items():
        value = getattr(options, name, None)
        if argument.reads in ("", left_out) or value in (None, False):
            continue
        read = READS[argument.reads]
        for text in value if isinstance(value, list) else [value]:
            if isinstance(text, str) and text:
                # What cannot be read is refused by what reads it.
                with suppress(ElitescriptError, OSError, ValueError):
                    yield from read(text, argument.flag)


def _named_by_programs(
    options: argparse.Namespace, arguments: dict[str, PathArgument], written: list[Written]
) -> Iterator[Read]:
    """Yield the files of the task folder that a program names, as far as outputs are called so too."""
    names = {Path(path).name for row in written if row.kind != REWRITTEN for path in (row.path, *row.beside)}
    for argument, value in ((row, getattr(options, name, None)) for name, row in arguments.items()):
        if argument.reads not in ("program", "program or trace") or not isinstance(value, str):
            continue
        with suppress(ElitescriptError, OSError, ValueError):
            if _is_ordinary(value) and any(name in (text := read_text(value, PROGRAM)) for name in names if name):
                folder = Path(getattr(options, "task_dir", None) or real_path(value).parent)
                for name in _files_named_in(text, value):
                    yield Read(folder / name, f"{argument.flag} {value}", f"{name}, which the program names")


def _files_named_in(text: str, name: str) -> Iterator[str]:
    """Yield the files of the task folder that a program names, as far as that is known before it runs."""
    from elitescript.language.parser import parse
    from elitescript.language.text.source import SourceFile
    from elitescript.lint.outside import FILE as FILE_NAME
    from elitescript.lint.outside import outside_names
    from elitescript.lint.program import AnalysedProgram
    from elitescript.messages.profile import profile
    from elitescript.runtime.environment import relative_name

    for named in outside_names(AnalysedProgram(parse(SourceFile(name, text)), profile())):
        if named.kind == FILE_NAME and named.name:
            # A path that leads out of the folder is refused when the program runs.
            with suppress(ElitescriptError, ScriptError):
                yield relative_name(named.name)


# ---------------------------------------------------------------- what is read

A_PROGRAM: Final = "a program"

_Reads = Callable[[str, str], Iterator[Read]]


def _file(noun: str) -> _Reads:
    def read(value: str, flag: str) -> Iterator[Read]:
        yield Read(value, f"{flag} {value}", noun)

    return read


def _nothing(_value: str, _flag: str) -> Iterator[Read]:
    yield from ()


def _is_ordinary(value: str) -> bool:
    """Return whether a file may be looked at: a stream could be read once only."""
    return Path(value).is_file() and stream_of(value) is None


def _world(value: str, flag: str) -> Iterator[Read]:
    yield Read(value, f"{flag} {value}", "the world file")
    if _is_ordinary(value):
        from elitescript.world_file import files_read

        for path in files_read(value)[1:]:
            yield Read(path, f"{flag} {value}", f"{path.name}, which the world file names")


def _arm(value: str, flag: str) -> Iterator[Read]:
    if value.endswith(".toml"):
        yield Read(value, f"{flag} {value}", "the arm file")


def _case(value: str, flag: str) -> Iterator[Read]:
    yield Read(value, f"{flag} {value}", "the case")
    if not _is_ordinary(value):
        return
    from elitescript.sweep.failures.cases import read_case

    case, folder = read_case(value), Path(value).parent
    yield Read(folder / case.program, f"{flag} {value}", "the program that the case names")
    if isinstance(model := case.options.get("model"), str) and model.endswith(".toml"):
        yield Read(folder / model, f"{flag} {value}", "the arm file that the case names")
    if function := _function_file(case.failure.expression):
        yield Read(folder / function, f"{flag} {value}", "the Python file that the case names")
    if case.world:
        for read in _world(str(folder / case.world), flag):
            yield read._replace(called=f"{flag} {value}")


def _profile(value: str, flag: str) -> Iterator[Read]:
    if value.endswith(".toml") or Path(value).is_file():
        yield Read(value, f"{flag} {value}", "the profile")


def _function_file(expression: str) -> str:
    """Return the file of `FILE.py:FUNCTION`; empty if it is another expression."""
    from elitescript.properties.parsing import function_place

    place = function_place(expression)
    return "" if place is None else place[0]


def _expression(value: str, flag: str) -> Iterator[Read]:
    # As it is, or behind the name of a column.
    for text in (value, value.partition("=")[2]):
        if file := _function_file(text):
            yield Read(file, f"{flag} {value}", "the Python file")


def _recording(value: str, flag: str) -> Iterator[Read]:
    yield Read(value, f"{flag} {value}", "the recording")
    if _is_ordinary(value):
        from elitescript.recorder.mcap_file import files_of

        for path in files_of(Path(value))[1:]:
            yield Read(path, f"{flag} {value}", "a file of the recording")


def _password(value: str, flag: str) -> Iterator[Read]:
    if value.startswith("@"):
        yield Read(value[1:], f"{flag} {value}", "the password file")


def _programs(value: str, flag: str) -> Iterator[Read]:
    if value != "-":
        yield Read(value, f"{flag} {value}", A_PROGRAM)


def _program(noun: str, *, is_run: bool = True) -> _Reads:
    """Return what reads a program: of a graphical one, the files of configurations and the script beside it too."""

    def read(value: str, flag: str) -> Iterator[Read]:
        yield Read(value, f"{flag} {value}", noun)
        if is_task_name(value) and _is_ordinary(value):
            for path in sorted(Path(value).parent.glob("*.configuration*")):
                yield Read(path, f"{flag} {value}", f"{path.name}, a configuration beside the task")
            script = Path(f"{value}{PROGRAM_SUFFIX}")
            if is_run and script.is_file():
                yield Read(script, f"{flag} {value}", f"{script.name}, the script that the pendant has written")

    return read


READS: Final[dict[str, _Reads]] = {
    "program": _program("the program"),
    "program or trace": _program("the file that is to be plotted"),
    "task": _program("the task", is_run=False),
    "other task": _file("the task that is compared"),
    "compared": _file("the file that is compared"),
    "programs": _programs,
    "world": _world,
    "arm": _arm,
    "case": _case,
    "profile": _profile,
    "expression": _expression,
    "recording": _recording,
    "session": _file("the journal"),
    "points": _file("the file of points"),
    "urdf": _file("the description of the arm"),
    "password": _password,
    # Folders hold files of which a call cannot say all; devices and addresses are no files that are written.
    "folder": _nothing,
    "device": _nothing,
    "address": _nothing,
    "elsewhere": _nothing,
}
"""What is read, by what `cli.arguments` calls it: the paths of one value."""

# ---------------------------------------------------------------- what is written

_Writes = Callable[[Any, str, "argparse.Namespace"], Iterator[Written]]


def _written(kind: str) -> _Writes:
    def write(value: str, flag: str, _options: argparse.Namespace) -> Iterator[Written]:
        yield Written(value, f"{flag} {value}", kind)

    return write


def _page_of_plot(value: str, flag: str, options: argparse.Namespace) -> Iterator[Written]:
    """Yield the page of `plot`, whose name is that of what is plotted."""
    if not value:
        value = f"{Path(options.case or options.file or '').stem}.plot.html"
    yield Written(value, f"{flag} {value}", PAGE)


def _page_of_sweep(value: str, flag: str, options: argparse.Namespace) -> Iterator[Written]:
    """Yield the page of a sweep, once the pages beside it may be written too.

    Raises:
        UsageError: they may not.
    """
    from elitescript.sweep.failures.cases import is_case
    from elitescript.sweep.results.page import REPLAYS

    called = f"{flag} {value}"
    yield Written(value, called, PAGE)
    if is_case(Path(value).name):
        raise UsageError(f"{called}: sweeps write the cases of their failures under such names; give it another one")
    if stream_of(value) is not None or not Path(value).name:
        return
    folder = Path(value).with_name(Path(value).stem + REPLAYS)
    try:
        is_taken = folder.exists() and not folder.is_dir()
        pages = sorted(folder.glob("run-*.html"))
    except OSError as error:
        raise UsageError(f"{called}: {error.strerror}: {folder.name}") from error
    if is_taken:
        raise UsageError(f"{called}: the replays go into the folder {folder}, and there is a file of this name")
    for page in pages:
        yield Written(page, f"{called}, which writes into {folder}", PAGE)


def _table(value: str, flag: str, _options: argparse.Namespace) -> Iterator[Written]:
    beside: tuple[Path, ...] = ()
    if Path(value).name:
        from elitescript.sweep.results.table_files import TableFiles

        beside = tuple(TableFiles(Path(value)))[1:]
    yield Written(value, f"{flag} {value}", ORDINARY, beside)


def _state(value: str, flag: str, options: argparse.Namespace) -> Iterator[Written]:
    for path in _of_each_robot(value, options):
        name = Path(path).name
        beside = (Path(path).with_name(f"{name}.lock"),) if name else ()
        yield Written(path, f"{flag} {value}", ORDINARY, beside)


def _journal(value: str, flag: str, options: argparse.Namespace) -> Iterator[Written]:
    for path in _of_each_robot(value, options):
        yield Written(path, f"{flag} {value}", NEW)


def _of_each_robot(value: str, options: argparse.Namespace) -> Iterator[str | Path]:
    """Yield the files of one option for all robots of a call."""
    yield value
    if options.command != "serve" or not Path(value).name:
        return
    from elitescript.cli.serve import ROBOTS_MAX
    from elitescript.services.robots import numbered_path

    count = max(len(options.models or ()), 1) * options.robots
    for number in range(1, min(count, ROBOTS_MAX)):
        yield numbered_path(Path(value), number)


def _rewritten(_value: object, _flag: str, options: argparse.Namespace) -> Iterator[Written]:
    """Yield the programs that are changed in their place."""
    for name in options.files:
        if Path(name).is_file():
            yield Written(name, f"FILE {name}", REWRITTEN)


def _edited(value: str, flag: str, _options: argparse.Namespace) -> Iterator[Written]:
    """Yield a program that is saved in its place."""
    if Path(value).is_file():
        yield Written(value, f"{flag} {value}", REWRITTEN)


WRITES: Final[dict[str, _Writes]] = {
    "page": _written(PAGE),
    "page of a plot": _page_of_plot,
    "page of a sweep": _page_of_sweep,
    "trace": _written(FILE),
    "text": _written(FILE),
    "arm": _written(FILE),
    "table": _table,
    "state": _state,
    "recording": _written(NEW),
    "session": _journal,
    "programs": _rewritten,
    "baseline": _written(ORDINARY),
    "edited": _edited,
}
"""What is written, by what `cli.arguments` calls it: the paths of one value."""

CLAIMED: Final = frozenset(("page", "page of a plot", "page of a sweep", "trace", "text", "arm"))
"""What is held from the begin of the call; the others have locks of their own, or are new files."""
