"""`elitescript completion`: writes what a shell needs to complete calls, made from the table of the commands."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Iterable, Iterator
from typing import Any, Final

from elitescript.cli.arguments import COMMANDS
from elitescript.cli.plain_call import OMITTED
from elitescript.errors import CODES, UsageError
from elitescript.records import NamedTuple

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse

_FOLDERS: Final = ("folder",)
_NO_FILES: Final = ("", "device", "elsewhere", "expression", "password")
"""What is read where a shell has no names to offer: the value is more than a path, or on another computer."""


class Argument(NamedTuple):
    """An argument of a command, as shells see it.

    Attributes:
        flags: its options; none for a positional argument.
        text: one line about it.
        has_value: whether a value follows the flag.
        words: values to offer.
        is_file: whether its value may be a file.
        is_folder: whether its value is a folder.
        is_repeated: whether it may be given more than once.
    """

    flags: tuple[str, ...]
    text: str
    has_value: bool
    words: tuple[str, ...]
    is_file: bool
    is_folder: bool
    is_repeated: bool


class Call(NamedTuple):
    """A command with its arguments."""

    name: str
    text: str
    options: tuple[Argument, ...]
    positionals: tuple[Argument, ...]


def completion(options: argparse.Namespace) -> int:
    """Print the script for a shell; return the exit code."""
    if options.shell not in SHELLS:
        raise UsageError(f"{options.shell!r} is none of the shells: {', '.join(SHELLS)}")
    sys.stdout.write(SHELLS[options.shell](tuple(calls())))
    return 0


def calls() -> Iterator[Call]:
    """Yield every command with its arguments."""
    for name, (text, add_arguments) in COMMANDS.items():
        collected = _Collected(name)
        add_arguments(collected)  # type: ignore[arg-type]
        yield Call(name, text, tuple(collected.options), tuple(collected.positionals))


class _Collected:
    """Takes the place of a parser, and keeps the arguments."""

    def __init__(self, command: str) -> None:
        self.description = ""
        self.command = command
        self.options: list[Argument] = [Argument(("-h", "--help"), "show the help", False, (), False, False, False)]
        self.positionals: list[Argument] = []

    def add_argument(self, *flags: str, reads: str = "", writes: str = "", **settings: Any) -> None:
        """Take an argument, described as for `argparse`, with what it reads and writes if it is a path."""
        help_text = settings.get("help")
        if help_text is OMITTED:
            return
        is_option = flags[0].startswith("-")
        action = settings.get("action", "store")
        metavar = settings.get("metavar") or ""
        name = settings.get("dest") or flags[-1].lstrip("-").replace("-", "_")
        words = tuple(map(str, settings.get("choices") or self._known(name)))
        argument = Argument(
            flags if is_option else (),
            _summary(help_text or metavar),
            action in ("store", "append"),
            words,
            reads not in (*_NO_FILES, *_FOLDERS) or "FILE" in metavar or (writes != "" and action != "store_true"),
            reads in _FOLDERS,
            action == "append" or settings.get("nargs") in ("*", "+"),
        )
        (self.options if is_option else self.positionals).append(argument)

    def _known(self, name: str) -> Iterable[str]:
        """Return the values of an argument that are known although any text is accepted."""
        if name in ("model", "models"):
            from elitescript.models.model import model_names

            return model_names()
        if name == "explain":
            return CODES
        if name == "shell":
            return SHELLS
        if name == "verb":
            from elitescript.services.control.verbs import VERBS

            return ("help", *VERBS)
        if (self.command, name) == ("commands", "name"):
            from elitescript.commands.catalogue import CATALOGUE

            return sorted(CATALOGUE.names())
        return ()


def _summary(text: str) -> str:
    """Return the first part of a help text, without its default."""
    return re.split(r"; | \(|\. |: ", " ".join(text.split()), maxsplit=1)[0]


def _quoted(text: str, apostrophe: str) -> str:
    return "'" + text.replace("\\", "").replace("'", apostrophe) + "'"


# ---------------------------------------------------------------- bash


def _bash(commands: tuple[Call, ...]) -> str:
    names = " ".join(call.name for call in commands)
    flags, values, valued, positionals = [], [], [], []
    for call in commands:
        flags.append(f"            {call.name}) words='{' '.join(_all_flags(call))}' ;;")
        for option in call.options:
            if option.has_value:
                pattern = "|".join(f"'{call.name} {flag}'" for flag in option.flags)
                valued.append(pattern)
                values.append(f"            {pattern}) {_bash_values(option)} ;;")
        for number, argument in enumerate(call.positionals):
            pattern = f"'{call.name} '*" if argument.is_repeated else f"'{call.name} {number}'"
            positionals.append(f"                {pattern}) {_bash_values(argument)} ;;")
    new = "\n"
    return f"""\
# Completes calls of elitescript in bash. Written by `elitescript completion bash`.
_elitescript() {{
    local current=${{COMP_WORDS[COMP_CWORD]}} before='' command='' word words='' what='' index position=0
    COMPREPLY=()
    # bash reads --option=value as three words.
    [[ $current == = ]] && current=''
    for ((index = 1; index < COMP_CWORD; index++)); do
        word=${{COMP_WORDS[index]}}
        if [[ $word == = ]]; then
            continue
        elif [[ -z $command ]]; then
            [[ $word != -* ]] && command=$word
        elif [[ $word == -* ]]; then
            case "$command $word" in
            {"|".join(valued)}) before=$word ;;
            *) before='' ;;
            esac
        elif [[ -n $before ]]; then
            before=''
        else
            ((position++))
        fi
    done
    if [[ -z $command ]]; then
        words='{names} --help --version'
    elif [[ -n $before ]]; then
        case "$command $before" in
{new.join(values)}
        esac
    elif [[ $current == -* ]]; then
        case $command in
{new.join(flags)}
        esac
    else
        case "$command $position" in
{new.join(positionals)}
        esac
    fi
    # Without what only newer versions of bash have.
    local IFS=$'\\n'
    case $what in
        files) COMPREPLY=($(compgen -f -- "$current")) ;;
        folders) COMPREPLY=($(compgen -d -- "$current")) ;;
    esac
    [[ -n $what ]] && compopt -o filenames 2> /dev/null
    COMPREPLY+=($(compgen -W "${{words// /$IFS}}" -- "$current"))
}}
complete -F _elitescript elitescript
"""


def _all_flags(call: Call) -> Iterator[str]:
    for option in call.options:
        yield from option.flags


def _bash_values(argument: Argument) -> str:
    parts = []
    if argument.words:
        parts.append(f"words='{' '.join(argument.words)}'")
    if argument.is_file or argument.is_folder:
        parts.append(f"what={'files' if argument.is_file else 'folders'}")
    return "; ".join(parts) or ":"


# ---------------------------------------------------------------- zsh


def _zsh(commands: tuple[Call, ...]) -> str:
    listed = "\n".join(f"        {_zsh_quoted(f'{call.name}:{call.text}')}" for call in commands)
    cases = []
    for call in commands:
        specs = [*(spec for option in call.options for spec in _zsh_option(option))]
        for number, argument in enumerate(call.positionals, 1):
            place = "*" if argument.is_repeated else str(number)
            specs.append(f"{place}:{_zsh_text(argument.text)}:{_zsh_values(argument)}")
        rows = " \\\n                ".join(map(_zsh_quoted, specs))
        cases.append(f"            {call.name})\n                _arguments -s {rows}\n                ;;")
    new = "\n"
    return f"""\
#compdef elitescript
# Completes calls of elitescript in zsh. Written by `elitescript completion zsh`.
_elitescript() {{
    local state line curcontext="$curcontext"
    local -a commands
    commands=(
{listed}
    )
    _arguments -C '(- *)'{{-h,--help}}'[show the help]' '(- *)--version[show the version]' \\
        '1: :->command' '*:: :->arguments'
    case $state in
    command) _describe -t commands command commands ;;
    arguments)
        curcontext="${{curcontext%:*:*}}:elitescript-$line[1]:"
        case $line[1] in
{new.join(cases)}
        esac
        ;;
    esac
}}
_elitescript_or_files() {{
    compadd -- "$@"
    _files
}}
if [[ $funcstack[1] == _elitescript ]]; then
    _elitescript "$@"
else
    compdef _elitescript elitescript
fi
"""


def _zsh_quoted(text: str) -> str:
    return _quoted(text, "'\\''")


def _zsh_option(option: Argument) -> Iterator[str]:
    others = "" if option.is_repeated or len(option.flags) == 1 else f"({' '.join(option.flags)})"
    repeat = "*" if option.is_repeated else ""
    for flag in option.flags:
        value = ""
        if option.has_value:
            value = f":value:{_zsh_values(option)}"
            flag += "=" if flag.startswith("--") else "+"
        yield f"{others}{repeat}{flag}[{_zsh_text(option.text)}]{value}"


def _zsh_text(text: str) -> str:
    return re.sub(r"[\[\]:]", " ", text).strip()


def _zsh_values(argument: Argument) -> str:
    words = f"({' '.join(argument.words)})" if argument.words else ""
    files = "_files" if argument.is_file else "_files -/" if argument.is_folder else ""
    if words and files:
        # A blank before it: called as it stands.
        return f" _elitescript_or_files {' '.join(argument.words)}"
    return words or files or " "


# ---------------------------------------------------------------- fish


def _fish(commands: tuple[Call, ...]) -> str:
    names = " ".join(call.name for call in commands)
    rows = [
        "# Completes calls of elitescript in fish. Written by `elitescript completion fish`.",
        "complete -c elitescript -e",
        "complete -c elitescript -f",
        f"set -l none 'not __fish_seen_subcommand_from {names}'",
        "complete -c elitescript -n $none -s h -l help -d 'show the help'",
        "complete -c elitescript -n $none -l version -d 'show the version'",
    ]
    rows += [f"complete -c elitescript -n $none -a {call.name} -d {_fish_quoted(call.text)}" for call in commands]
    for call in commands:
        seen = f"complete -c elitescript -n '__fish_seen_subcommand_from {call.name}'"
        for option in call.options:
            flags = " ".join(f"-l {flag[2:]}" if flag.startswith("--") else f"-s {flag[1:]}" for flag in option.flags)
            rows.append(f"{seen} {flags}{_fish_values(option)} -d {_fish_quoted(option.text)}")
        rows += [f"{seen}{values}" for values in map(_fish_values, call.positionals) if values]
    return "\n".join(rows) + "\n"


def _fish_quoted(text: str) -> str:
    return _quoted(text, "\\'")


def _fish_values(argument: Argument) -> str:
    needs_value = bool(argument.flags) and argument.has_value
    values = f" -a '{' '.join(argument.words)}'" if argument.words else ""
    if argument.is_file:
        return f"{' -r' if needs_value else ''} -F{values}"
    if argument.is_folder:
        values = " -a '(__fish_complete_directories)'"
    return f"{' -x' if needs_value else ''}{values}"


SHELLS: Final[dict[str, Callable[[tuple[Call, ...]], str]]] = {"bash": _bash, "zsh": _zsh, "fish": _fish}
"""By shell, the function that writes its script."""
