"""The command `elitescript`: one subcommand a file, loaded when it is asked for.

`run` may have to start Python once more, so that this module is loaded twice: it imports next to nothing.
"""

from __future__ import annotations

import os
import sys

from elitescript.cli.watched import MARK, MEMORY_DEFAULT, can_watch, run_watched

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse
    from collections.abc import Sequence

USAGE = 2
"""Exit code of a call that makes no sense."""

INTERRUPTED = 130
"""Exit code after Ctrl-C, as shells count it."""

HASH_SEED = "0"
"""The order of a set of strings depends on it; every process that we start has the same."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line; return the exit code."""
    arguments = list(sys.argv[1:] if argv is None else argv)
    try:
        if (
            argv is None
            and arguments[:1] in (["run"], ["plot"], ["serve"], ["replay"])
            and _needs_another_process(arguments)
        ):
            return _run_again(arguments)
        return _run_here(arguments)
    except KeyboardInterrupt:
        return INTERRUPTED


def _run_here(arguments: list[str]) -> int:
    from elitescript.errors import ElitescriptError, ProgramError, UsageError

    for stream in (sys.stdout, sys.stderr):
        # Programs speak every language, and pipes on some systems only one.
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(encoding="utf-8", errors="backslashreplace")
    options = _parsed(arguments)
    try:
        if _has_screen(options):
            from elitescript.cli.output.screen import on_screen

            with on_screen(options.color):
                return _dispatch(options)
        return _dispatch(options)
    except UsageError as error:
        print(f"elitescript {options.command}: {error}", file=sys.stderr)
        return USAGE
    except (ProgramError, ElitescriptError) as error:
        print(f"elitescript {options.command}: {error}", file=sys.stderr)
        return 3 if isinstance(error, ProgramError) else 1
    except BrokenPipeError:
        # The reader went away (`| head`): nothing is wrong with us.
        sys.stderr = None
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except OSError as error:
        print(f"elitescript {options.command}: {error}", file=sys.stderr)
        return USAGE


def _has_screen(options: argparse.Namespace) -> bool:
    """Return whether a command has colours or a status line: pipes and files need nothing of that."""
    color = getattr(options, "color", None)
    return color == "always" or (color is not None and (sys.stdout.isatty() or sys.stderr.isatty()))


def _dispatch(options: argparse.Namespace) -> int:
    if options.command == "run":
        from elitescript.cli.run import run

        return run(options)
    if options.command == "check":
        from elitescript.cli.check import check

        return check(options)
    if options.command == "plot":
        from elitescript.cli.plot import plot

        return plot(options)
    if options.command == "serve":
        from elitescript.cli.serve import serve

        return serve(options)
    if options.command == "ctl":
        from elitescript.cli.ctl import ctl

        return ctl(options)
    if options.command == "replay":
        from elitescript.cli.replay import replay

        return replay(options)
    if options.command == "devices":
        from elitescript.cli.devices import devices

        return devices(options)
    if options.command == "doctor":
        from elitescript.cli.doctor import doctor

        return doctor(options)
    from elitescript.cli.commands import commands

    return commands(options)


def _needs_another_process(arguments: list[str]) -> bool:
    if os.environ.get(MARK):
        return False
    return os.environ.get("PYTHONHASHSEED") != HASH_SEED or _is_watched(arguments)


def _is_watched(arguments: list[str]) -> bool:
    """Return whether another process is to watch over the call."""
    return arguments[0] in ("run", "plot") and (can_watch() or _names_max_wall(arguments))


def _names_max_wall(arguments: list[str]) -> bool:
    return any(argument.startswith("--max-w") for argument in arguments)


def _run_again(arguments: list[str]) -> int:
    """Run the same call in a process with a fixed hash seed; programs in one that is watched."""
    # -P: a file called queue.py beside the program must not stand in for the standard library's.
    command = [sys.executable, "-P", "-m", "elitescript", *arguments]
    environment = {**os.environ, "PYTHONHASHSEED": HASH_SEED}
    home = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))  # noqa: PTH100, PTH120
    if "site-packages" not in home:
        # Not installed: with -P, a working copy is found through this path alone.
        environment["PYTHONPATH"] = os.pathsep.join(filter(None, (os.environ.get("PYTHONPATH"), home)))
    if _is_watched(arguments):
        max_wall_s = None
        if _names_max_wall(arguments):
            given = _parsed(arguments).max_wall
            max_wall_s = given if given is not None and 0.0 <= given < 1e9 else None
        if max_wall_s is not None or can_watch():
            # Nothing else can be meant by what begins so, and most calls are spared the parser.
            is_json = arguments[0] == "run" and any(word.startswith("--js") for word in arguments)
            return run_watched(command, environment, max_wall_s, is_json=is_json)
    if os.name == "posix":
        os.execve(sys.executable, command, environment)
    import signal
    import subprocess

    # The child answers Ctrl-C; its parent only waits.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    return subprocess.run(command, env=environment, check=False).returncode


def _parsed(arguments: list[str]) -> argparse.Namespace:
    """Return the options of a call; a mistake ends the process with the usage of the subcommand it is about."""
    parser, subparsers = _parser()
    word = arguments[0] if arguments else ""
    if word and word[0] != "-" and word not in subparsers.choices:
        parser.exit(USAGE, f"elitescript: {_no_command(word, list(subparsers.choices))}\n")
    options, left = parser.parse_known_args(arguments)
    if left:
        command = subparsers.choices[options.command]
        near = _nearest_option(left[0], command)
        command.error(f"unrecognized arguments: {' '.join(left)}{near}")
    return options


def _no_command(word: str, known: list[str]) -> str:
    from elitescript.errors import did_you_mean

    if word.endswith(".script"):
        return f"{word!r} is no command; to run it: elitescript run {word}"
    return f"{word!r} is no command{did_you_mean(word, known)}; there are {', '.join(known)}"


def _nearest_option(word: str, command: argparse.ArgumentParser) -> str:
    from elitescript.errors import did_you_mean

    known = [text for action in command._actions for text in action.option_strings if text.startswith("--")]
    return did_you_mean(word.partition("=")[0], known) if word.startswith("--") else ""


def _parser() -> tuple[argparse.ArgumentParser, argparse._SubParsersAction[argparse.ArgumentParser]]:
    """Return the parser of the command line, and its subcommands by name."""
    import argparse

    from elitescript import __version__
    from elitescript.cli.serving_options import (
        add_color,
        add_connections,
        add_ctl,
        add_devices,
        add_doctor,
        add_log,
        add_replay,
        add_serve,
        add_task_dir_limit,
        add_trace_signals,
    )
    from elitescript.messages.profile import DEFAULT_FIRMWARE, PROFILES

    parser = argparse.ArgumentParser(
        prog="elitescript",
        description="Run and check EliteScript, the language of the Elite Robots CS arms, without a robot.",
    )
    parser.add_argument("--version", action="version", version=f"elitescript {__version__}")
    # With a given prog, argparse builds no help formatter at this point, which saves importing shutil.
    subparsers = parser.add_subparsers(dest="command", required=True, metavar="COMMAND", prog="elitescript")

    firmware = argparse.ArgumentParser(add_help=False)
    firmware.add_argument(
        "--firmware", default=DEFAULT_FIRMWARE, choices=list(PROFILES), help="controller firmware (default %(default)s)"
    )
    firmware.add_argument("--strict", action="store_true", help="refuse what only warns otherwise")
    firmware.add_argument("--json", action="store_true", help="print one JSON object per line")

    run = subparsers.add_parser(
        "run",
        parents=[firmware],
        help="run a program to its end in virtual time",
        description="Run a program to its end in virtual time. Exit code: 0 finished or stopped, 1 alarm, "
        "2 usage, 3 the program does not compile, 4 time limit, 5 stuck, 130 Ctrl-C.",
    )
    run.add_argument("file", metavar="FILE", help="program text, UTF-8")
    run.add_argument(
        "--robot",
        default="CS66",
        metavar="MODEL",
        help="arm: CS63 CS66 CS612 CS616 CS620 CS625, or a file my_arm.toml (default CS66)",
    )
    run.add_argument("--realtime", action="store_true", help="one tick per 4 ms of wall time")
    run.add_argument("--until", type=float, metavar="SECONDS", help="stop after so much virtual time")
    run.add_argument("--max-wall", type=float, metavar="SECONDS", help="stop after so much wall time")
    run.add_argument("--seed", type=int, default=0, metavar="N", help="seed of random() (default 0)")
    run.add_argument("--joints", metavar="Q1,...,Q6", help="joint positions at the start, rad")
    run.add_argument("--speed", type=float, default=1.0, metavar="0..1", help="speed percentage as a fraction")
    run.add_argument("--task-dir", metavar="DIR", help="folder for open() and get_task_path() (default: FILE's folder)")
    add_task_dir_limit(run, "the task folder")
    run.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="NAME=VALUE",
        help="signal or global at the start, e.g. standard_digital_in[3]=true; may be repeated",
    )
    run.add_argument(
        "--world", metavar="FILE.toml", help="what is around the robot: devices, wires, safety limits, inputs"
    )
    run.add_argument("--cell", dest="world", help=argparse.SUPPRESS)
    add_connections(run)
    run.add_argument(
        "--state",
        metavar="FILE",
        help="begin with the registers, flags and general Modbus values of this file, and write them back at the end",
    )
    run.add_argument(
        "--memory-limit",
        default=MEMORY_DEFAULT,
        metavar="SIZE",
        help="memory that the run may have, such as 8GiB (default %(default)s)",
    )
    run.add_argument("--trace", metavar="OUT.csv|OUT.jsonl", help="write a row for every tick")
    run.add_argument(
        "--step",
        type=float,
        metavar="SECONDS",
        help="time between two rows of the trace, in whole control periods of 0.004 s (default 0.004)",
    )
    add_trace_signals(run)
    add_log(run)
    add_color(run)
    run.add_argument("--epoch", metavar="TIME", help="controller clock at the start: seconds since 1970 or ISO 8601")

    check = subparsers.add_parser(
        "check",
        parents=[firmware],
        help="report every problem of programs without running them",
        description="Report every problem with its place, code, text and hint. Exit code: 0 no errors, 2 usage, or a "
        "file of this call cannot be read, 3 errors.",
    )
    check.add_argument(
        "files", nargs="*", metavar="FILE", help="programs, folders (every *.script in them), or - for standard input"
    )
    check.add_argument(
        "--format",
        choices=["text", "json", "github", "sarif"],
        help="form of the report: for people, JSON lines (as --json), GitHub workflow commands, SARIF 2.1.0",
    )
    check.add_argument("--fix", action="store_true", help="make the repairs that are safe; of - to standard output")
    check.add_argument("--explain", metavar="CODE", help="say what a code such as E303 means, with an example")
    check.add_argument("--robot", metavar="MODEL", help="arm that the programs are for, with its limits and its reach")
    check.add_argument("--world", metavar="FILE", help="what is around the robot: the joint ranges of its safety count")

    plot = subparsers.add_parser(
        "plot",
        help="write a page that shows a program's run, or a trace",
        description="Run a program, or read the trace of a run, and write one HTML page with path, joints, time line "
        "and cycle time by line. Runs of more than 800 s are sampled less often than every control period. Exit code "
        "of a program: as for run.",
    )
    plot.add_argument("file", metavar="FILE", help="a program, or a trace: OUT.csv or OUT.jsonl of run --trace")
    plot.add_argument("-o", "--output", metavar="OUT.html", help="the page (default: NAME.plot.html, in this folder)")
    plot.add_argument(
        "--robot", default="CS66", metavar="MODEL", help="arm whose limits are drawn, or its file (default CS66)"
    )
    plot.add_argument("--firmware", choices=list(PROFILES), help=f"controller firmware (default {DEFAULT_FIRMWARE})")
    plot.add_argument("--until", type=float, metavar="SECONDS", help="stop after so much virtual time (default 300)")
    plot.add_argument("--seed", type=int, metavar="N", help="seed of random() (default 0)")
    plot.add_argument("--joints", metavar="Q1,...,Q6", help="joint positions at the start, rad")
    plot.add_argument("--speed", type=float, metavar="0..1", help="speed percentage as a fraction")
    plot.add_argument(
        "--task-dir", metavar="DIR", help="folder for open() and get_task_path() (default: FILE's folder)"
    )
    plot.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="NAME=VALUE",
        help="signal or global at the start; may be repeated",
    )
    plot.add_argument("--world", metavar="FILE.toml", help="what is around the robot, as for run")
    plot.add_argument("--cell", dest="world", help=argparse.SUPPRESS)

    add_color(check)
    add_color(plot)
    add_serve(subparsers, firmware)
    add_ctl(subparsers)
    add_devices(subparsers)
    add_replay(subparsers)
    add_doctor(subparsers)

    commands = subparsers.add_parser(
        "commands",
        help="the catalogue of robot commands",
        description="Print the list of all robot commands, one command in full, or those that a word finds in names, "
        "parameters and descriptions. Exit code 2 if it finds none.",
    )
    commands.add_argument(
        "name", nargs="?", metavar="WORD", help="a command, or a word to look for in all of them; all if left out"
    )
    commands.add_argument("--json", action="store_true", help="print one JSON array with all that is known of each")
    return parser, subparsers
