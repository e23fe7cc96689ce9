"""The command `elitescript`: subcommand NAME is the function `NAME` of `cli/NAME.py`, imported when it is called.

`run` may have to start Python once more, so that this module is loaded twice: it imports little.
"""

from __future__ import annotations

import gc
import os
import sys
from contextlib import suppress
from functools import partial

from elitescript.cli.watched import MARK, can_watch, run_watched
from elitescript.observer import COVERAGE_VARIABLE

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse
    from collections.abc import Callable, Sequence
    from contextlib import AbstractContextManager
    from typing import Any, Never

USAGE = 2
"""Exit code of an invalid call, and of one that could not do what it was to; 1 is what came of a command."""

DOES_NOT_COMPILE = 3

HASH_SEED = "0"
"""The order of a set of strings depends on it, so every process has the same."""

_NO_MEMORY = "there is not enough memory"

_RUNNING = ("run", "plot", "serve", "replay", "sweep", "audit", "shadow")
"""Commands that run programs."""

_WATCHING = ("run", "check")
"""Commands that have `--watch`."""

_CLEANS_UP = ("run", "plot", "sweep")
"""Commands that have something to do when SIGTERM or SIGHUP ends them, and are not kept from it by a program: another
process watches it."""

_TEMPORARY = ("check", "fit", "fmt")
"""Commands that have only unfinished files to remove then: without any, the system ends them."""

_TEMPORARY_OF_PROGRAMS = ("audit", "replay")
"""The same, with programs in this process, which may block its signal handlers."""

_AT_WORK = frozenset(("elitescript.world_file", "_lsprof", "bdb"))
"""Modules that have something to do when a call is over."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line; return the exit code."""
    if argv is not None:
        return _run(list(argv))
    # Hardly anything that is made while modules load can be freed: to look for it takes a tenth of the start.
    gc.disable()
    arguments = sys.argv[1:]
    # Imported late: callers from Python keep their streams.
    from elitescript.cli.output import streams

    if None in (sys.stdin, sys.stdout, sys.stderr):
        streams.open_closed_streams()
    streams.open_streams(arguments[0] if arguments else "")
    try:
        code = _run(arguments, is_process=True)
    except (MemoryError, SystemError):
        # Without any memory Python fails wherever it is.
        os.write(2, f"elitescript: {_NO_MEMORY}\n".encode())
        os._exit(USAGE)
    failure = streams.failure_of_streams()
    if streams.is_ended_with_reader(arguments[0] if arguments else ""):
        code = streams.ENDED_WITH_READER
    elif failure is not None:
        if code != USAGE:
            # Else it has been said.
            _say(arguments, os_error_text(failure))
        code = code if code and failure.filename == streams.ERROR else USAGE
    _leave(code)
    return code


def _run(arguments: list[str], *, is_process: bool = False) -> int:
    try:
        if arguments[:1] and arguments[0] in _WATCHING and any(word.startswith("--wa") for word in arguments):
            options = _parsed(arguments)
            if options.watch:
                return _watch(options, arguments, is_process=is_process)
        if is_process and arguments[:1] and arguments[0] in _RUNNING and _needs_another_process(arguments):
            return _run_again(arguments)
        return _run_here(arguments, is_process=is_process)
    except KeyboardInterrupt as stop:
        from elitescript.environment.stop_signals import exit_code_of

        return exit_code_of(stop)
    except SystemExit as left:
        # Help, version and usage are printed by then, or so it seems: see `main`.
        if not is_process or not isinstance(left.code, int):
            raise
        return left.code
    except Exception as error:
        if not is_process:
            raise
        _say(arguments, _sentence(error))
        return USAGE


def _sentence(error: Exception) -> str:
    """Return what to say of an exception that no command has handled."""
    try:
        from elitescript.cli.internal_error import sentence

        return os_error_text(error) if isinstance(error, OSError) else sentence(error)
    except Exception:
        # With hardly any memory not even that can be loaded.
        return _NO_MEMORY


def _say(arguments: list[str], text: str) -> None:
    from elitescript.shown import shown

    with suppress(OSError):
        print(shown(f"{' '.join(['elitescript', *arguments[:1]])}: {text}"), file=sys.stderr)


def os_error_text(error: OSError) -> str:
    """Return what a system error says: the name first."""
    if error.filename is None or error.strerror is None:
        return error.strerror or str(error)
    return f"{error.filename}: {error.strerror}"


def _leave(code: int) -> None:
    """End the process at once, if nothing is left to do: taking the interpreter apart takes a tenth of a short run.

    Something is left if there are threads, functions to be called at the exit, files of other people's Python, which a
    world file names, or what Python itself was told to do afterwards: a profile, a debugger, a prompt (`-i`).
    """
    import _thread
    import atexit

    if _thread._count() or atexit._ncallbacks() or not _AT_WORK.isdisjoint(sys.modules):
        return
    if sys.flags.inspect or sys.gettrace() or sys.getprofile():
        return
    try:
        sys.stdout.flush()
        sys.stderr.flush()
    except (OSError, ValueError, AttributeError):
        # The ordinary end reports it.
        return
    os._exit(code)


def _run_here(arguments: list[str], start_again: Callable[[], Never] | None = None, *, is_process: bool) -> int:
    """Run a call in this process; return the exit code.

    Args:
        arguments: of the call.
        start_again: runs it in place of this process in one with a fixed hash seed; None if this is one.
        is_process: whether this process has nothing else to do.
    """
    for stream in (sys.stdout, sys.stderr):
        # Texts of programs may need characters that the encoding of a pipe does not have.
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(encoding="utf-8", errors="backslashreplace")
    options = _parsed(arguments)
    options.parsed = None
    options.command_line = arguments
    if start_again is not None:
        from elitescript.cli.hash_seed import program_of_any_seed

        options.parsed = program_of_any_seed(options)
        if options.parsed is None:
            start_again()
    with _screen(options):
        return _answered(options, is_process=is_process)


def _answered(options: argparse.Namespace, *, is_process: bool) -> int:
    """Run a command; print what it raises, where texts of others do not drive a terminal, and return its exit code."""
    from elitescript.errors import ElitescriptError, ProgramError
    from elitescript.shown import shown

    try:
        return _dispatch(options, is_process=is_process)
    except (ProgramError, ElitescriptError) as error:
        place = f"{error.file}: " if isinstance(error, ProgramError) and error.file else ""
        print(f"elitescript {options.command}: {shown(place + str(error))}", file=sys.stderr)
        return DOES_NOT_COMPILE if isinstance(error, ProgramError) else USAGE
    except OSError as error:
        print(f"elitescript {options.command}: {shown(os_error_text(error))}", file=sys.stderr)
        return USAGE


def _screen(options: argparse.Namespace) -> AbstractContextManager[None]:
    """Return what lets nothing act that a command prints, and gives it colours and a status line."""
    from elitescript.cli.output.screen import GITHUB, JSON, TEXT, on_screen

    form = getattr(options, "format", None) or (JSON if getattr(options, "json", False) else TEXT)
    return on_screen(getattr(options, "color", None) or "never", form if form in (GITHUB, TEXT) else JSON)


def _dispatch(options: argparse.Namespace, *, is_process: bool) -> int:
    from importlib import import_module

    if is_process and options.command in _RUNNING and (folder := os.environ.get(COVERAGE_VARIABLE)):
        from elitescript.services.coverage import count_programs

        count_programs(folder)
    command: Callable[[argparse.Namespace], int]
    command = getattr(import_module(f"elitescript.cli.{options.command}"), options.command)
    is_writing = any(row.writes and getattr(options, name) not in (None, False) for name, row in options.paths.items())
    if is_process and options.command in (*_CLEANS_UP, *(_TEMPORARY if is_writing else ())):
        from elitescript.environment.stop_signals import leave_by_signals

        leave_by_signals()
    if is_process:
        # What is loaded stays, and need not be looked at again.
        gc.freeze()
        gc.enable()
    if not is_writing:
        return command(options)
    from contextlib import ExitStack

    from elitescript.cli.call_paths import outputs_of

    with ExitStack() as stack:
        if is_process and options.command in _TEMPORARY_OF_PROGRAMS:
            from elitescript.cli.last_resort import last_resort
            from elitescript.environment.stop_signals import leave

            stack.enter_context(last_resort(f"elitescript {options.command}"))(leave)
        stack.enter_context(outputs_of(options))
        return command(options)


def _needs_another_process(arguments: list[str]) -> bool:
    if os.environ.get(MARK):
        return False
    return not _has_hash_seed() or _is_watched(arguments)


def _has_hash_seed() -> bool:
    """Return whether this process has the fixed seed of string hashing."""
    return os.environ.get("PYTHONHASHSEED") == HASH_SEED and not sys.flags.ignore_environment


def _is_watched(arguments: list[str]) -> bool:
    """Return whether another process watches the call."""
    return arguments[0] in ("run", "plot") and (can_watch() or _names_max_wall(arguments))


def _names_max_wall(arguments: list[str]) -> bool:
    return any(argument.startswith("--max-w") for argument in arguments)


def _watch(options: argparse.Namespace, arguments: list[str], *, is_process: bool) -> int:
    """Run a call each time that its files have changed."""
    from elitescript.cli.watching import watch
    from elitescript.errors import ElitescriptError

    try:
        return watch(options, *_again(arguments), is_process=is_process)
    except ElitescriptError as error:
        _say(arguments, str(error))
        return USAGE


def _again(arguments: list[str]) -> tuple[list[str], dict[str, str]]:
    """Return what starts the same call in a process with a fixed hash seed: its command and environment."""
    # -P: a file called queue.py beside the program must not stand in for the standard library's.
    command = [sys.executable, "-P", "-m", "elitescript", *arguments]
    environment = {**os.environ, "PYTHONHASHSEED": HASH_SEED}
    home = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))  # noqa: PTH100, PTH120
    if "site-packages" not in home:
        # Not installed: with -P, a working copy is found through this path alone.
        environment["PYTHONPATH"] = os.pathsep.join(filter(None, (os.environ.get("PYTHONPATH"), home)))
    return command, environment


def _run_again(arguments: list[str]) -> int:
    """Run the same call in a process with a fixed hash seed; programs in one that is watched."""
    command, environment = _again(arguments)
    if _is_watched(arguments):
        max_wall_s = None
        if _names_max_wall(arguments):
            given = _parsed(arguments).max_wall
            max_wall_s = given if given is not None and 0.0 <= given < 1e9 else None
        if max_wall_s is not None or can_watch():
            # No other option begins like that; parsing all arguments would take longer.
            is_json = arguments[0] == "run" and any(word.startswith("--js") for word in arguments)
            # A run starts Python once more only if its program can show the order of a set.
            here = None
            if arguments[0] == "run":
                start_again = None if _has_hash_seed() else partial(os.execve, command[0], command, environment)
                here = partial(_run_here, arguments, start_again, is_process=True)
            return run_watched(command, environment, max_wall_s, is_json=is_json, run_here=here)
    if os.name == "posix":
        os.execve(sys.executable, command, environment)
    import signal
    import subprocess

    # The child reacts to Ctrl-C; its parent only waits.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    return subprocess.run(command, env=environment, check=False).returncode


def _parsed(arguments: list[str]) -> argparse.Namespace:
    """Return the options of a call; an error ends the process with the usage of its subcommand."""
    from elitescript.cli.arguments import COMMANDS
    from elitescript.cli.plain_call import PlainCall

    word = arguments[0] if arguments else ""
    if word in COMMANDS:
        call = PlainCall()
        COMMANDS[word][1](call)
        if (found := call.read(arguments[1:])) is not None:
            found.command = word
            found.paths = call.paths
            return found
    parser, subparsers = _parser(word if word in COMMANDS else "")
    if word and word[0] != "-" and word not in COMMANDS:
        parser.exit(USAGE, f"elitescript: {_no_command(word, list(COMMANDS))}\n")
    options, left = parser.parse_known_args(arguments)
    if left:
        command = subparsers.choices[options.command]
        near = _nearest_option(left[0], command)
        command.error(f"unrecognized arguments: {' '.join(left)}{near}")
    call = PlainCall()
    COMMANDS[options.command][1](call)
    options.paths = call.paths
    return options


def _no_command(word: str, known: list[str]) -> str:
    from elitescript.errors import did_you_mean
    from elitescript.paths import is_program_name

    if is_program_name(word):
        return f"{word!r} is no command; to run it: elitescript run {word}"
    return f"{word!r} is no command{did_you_mean(word, known)}; there are {', '.join(known)}"


def _nearest_option(word: str, command: argparse.ArgumentParser) -> str:
    from elitescript.errors import did_you_mean

    known = [text for action in command._actions for text in action.option_strings if text.startswith("--")]
    return did_you_mean(word.partition("=")[0], known) if word.startswith("--") else ""


def _parser(command: str) -> tuple[argparse.ArgumentParser, argparse._SubParsersAction[Any]]:
    """Return the parser of a call, and its subcommands by name: `command` alone, or all if it is empty."""
    import argparse

    from elitescript import __version__
    from elitescript.cli.arguments import COMMANDS
    from elitescript.cli.plain_call import OMITTED
    from elitescript.shown import printed

    class Parser(argparse.ArgumentParser):
        def add_argument(self, *flags: Any, **settings: Any) -> argparse.Action:
            known: dict[str, Any] = {
                name: argparse.SUPPRESS if value is OMITTED else value
                for name, value in settings.items()
                if name not in ("reads", "writes")
            }
            return super().add_argument(*flags, **known)

        def _print_message(self, message: str, file: Any = None) -> None:
            # It quotes words of the call, which may be names of files that others gave.
            super()._print_message(printed(message), file)

    parser = Parser(
        prog="elitescript",
        description="Run and check EliteScript, the language of the Elite Robots CS arms, without a robot.",
    )
    parser.add_argument("--version", action="version", version=f"elitescript {__version__}")
    # With a given prog, argparse builds no help formatter at this point, which saves importing shutil.
    subparsers = parser.add_subparsers(dest="command", required=True, metavar="COMMAND", prog="elitescript")
    # This is part of the start-up time: nothing is built for the other commands.
    for name in [command] if command else COMMANDS:
        text, add_arguments = COMMANDS[name]
        add_arguments(subparsers.add_parser(name, help=text))
    return parser, subparsers
