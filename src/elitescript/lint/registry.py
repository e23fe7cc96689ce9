"""Defines what a lint rule is, and lists all of them.

A rule is one decorated function in a file of its own under `rules`. It takes an `AnalysedProgram` and yields
findings; its code is written there and nowhere else but in the table of `errors`.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterable, Iterator
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Final

from elitescript.commands.definition.docstring import docstring_of
from elitescript.errors import CODES, InternalError
from elitescript.language.diagnostics import Fix
from elitescript.records import NamedTuple

if TYPE_CHECKING:
    from elitescript.lint.program import AnalysedProgram, Doubted, Span


class Finding(NamedTuple):
    """Holds what a rule yields; the engine adds the code.

    Attributes:
        where: the node, or the range of the text, that is wrong.
        text: what is wrong, with value, limit and unit.
        hint: what to do about it; may be empty.
        fix: a repair that a tool can make.
    """

    where: ast.AST | Span
    text: str
    hint: str = ""
    fix: Fix | None = None


_OF_ELEMENTS: Final = ("W230", "W231")
"""Codes of doubts about numbers beside elements of poses."""
_SHOWN: Final = 60
"""Characters of an expression that a message repeats."""

Check = Callable[["AnalysedProgram"], Iterable[Finding]]


class Rule(NamedTuple):
    """Describes a rule; see `rule` for the fields."""

    code: str
    since: str
    check: Check
    instead_of: tuple[str, ...]
    needs_all_lines: bool
    needs_values: bool

    @property
    def explanation(self) -> str:
        """What it finds, why, and an example."""
        return docstring_of(import_module(self.check.__module__))


_RULES: Final[dict[str, Rule]] = {}


def rule(
    *,
    code: str,
    since: str,
    instead_of: tuple[str, ...] = (),
    needs_all_lines: bool = False,
    needs_values: bool = False,
) -> Callable[[Check], Check]:
    """Register the decorated function as a rule.

    Args:
        code: its row of `errors.CODES`.
        since: release of elitescript that brought it.
        instead_of: codes that are less specific; their findings at the same place are dropped.
        needs_all_lines: skip it if a line could not be read, as that line may hold what it misses.
        needs_values: it may ask for `AnalysedProgram.values`, which take longer than all that is found without them.
    """

    def register(check: Check) -> Check:
        if code in _RULES or code not in CODES:
            raise InternalError(f"{check.__module__}: {code} is another rule's, or no code")
        _RULES[code] = Rule(code, since, check, instead_of, needs_all_lines, needs_values)
        return check

    return register


def doubt_findings(program: AnalysedProgram, code: str) -> Iterator[Finding]:
    """Yield the doubts about values with a code as findings of its rule."""
    doubts: Iterable[Doubted] = program.doubts
    if code in _OF_ELEMENTS and program.has_large_numbers:
        from elitescript.lint.element_doubts import element_doubts

        doubts = [*doubts, *program.derived(element_doubts)]
    for doubted in doubts:
        doubt = doubted.doubt
        if doubt.code == code and not (code == "W231" and _is_towards(doubted)):
            from elitescript.lint.unit_fixes import unit_fix

            yield Finding(doubted.node, doubt.text, doubt.hint, unit_fix(program, doubted))


TOWARDS: Final = "calculate_point_to_move_towards"
"""The function of scripts of the pendant that computes a point 1000 m away, for a motion in a direction."""


def _is_towards(doubted: Doubted) -> bool:
    return doubted.scope.name == TOWARDS


def shown_source(program: AnalysedProgram, node: ast.AST) -> str:
    """Return what is written there, on one line and shortened, in backquotes."""
    text = " ".join(ast.unparse(node).split())
    return f"`{text if len(text) <= _SHOWN else text[: _SHOWN - 3] + '...'}`"


_CHANGES: Final = ("] ", "]=", "]+", "]-", "]*", "]/", ".append", ".insert", ".extend", ".sort", ".reverse", ".pop")
"""Of a text that changes a list."""

_FAILING: Final = (
    *("float(", "int(", "chr(", "ord(", "min(", "max(", "sqrt(", "log", "acos(", "asin(", "pow(", "norm", "list"),
    *("to_num", "str_", "bin", "pose_", "interpolate", "rpy", "rotvec"),
)
"""Functions and commands that depend on their arguments alone, and refuse some."""
_NOTHING: Final = (
    *(".append(", ".clear(", ".extend(", ".insert(", ".remove(", ".reverse(", ".sort("),
    *("= set_", "= move", "= servo", "= speed", "= stop", "= sleep", "= sync", "= write_", "= textmsg", "= popup"),
)
"""Of a text with the result of a call that gives none."""

_WORDS: Final[dict[str, tuple[str, ...]]] = {
    "always_true": ("if", "while", " or ", "&", "|"),
    "analog_fraction": ("set_standard_analog_out",),
    "blend_too_long": ("move",),
    "busy_loop": ("while",),
    "called_for_thread": ("start_thread",),
    "duplicate_function": ("def", "sec", "thread"),
    "forbidden_in_secondary": ("sec", "thread"),
    "mirrored_address": ("write_port_",),
    "missing_global": ("global",),
    "missing_return": ("return",),
    "negative_radius": ("move",),
    "payload_too_heavy": ("set_payload",),
    "poll_in_secondary": ("sec", "thread"),
    "speed_in_other_units": ("move", "speed", "stop"),
    "unassigned_global": ("global",),
    "unavailable_module": ("import",),
    "unreachable_target": ("move", "servoj"),
    "joined_lists": ("+", "*"),
    "measured_exactly": ("==", "!=", " in "),
    "never_equal": ("=", "<", ">", " is "),
    "not_a_function": ("=", "for ", "as "),
    "time_in_milliseconds": ("time", "t=", "read", "move", "servoj", "speed", "modbus", "watchdog", "watch"),
    "changed_while_gone_through": (".append", ".clear", ".extend", ".insert", ".pop", ".remove"),
    "failing_call": _FAILING,
    "negative_in_register": ("modbus_set_output_register", "write_port_register"),
    "kept_lock": ("acquire",),
    "no_result": _NOTHING,
    "other_quantity": ("socket_read_", "tcp_pose", "joint_positions", "_kin("),
    "power_sign": ("^",),
    "uncalled_function": (" def ", "\tdef "),
    "unfilled_text": ("%", "{"),
    "assigned_in_one_branch": ("if", "for", "while", "try", "match"),
    "changed_alias": _CHANGES,
    "list_in_several_places": _CHANGES,
    "channel_not_open": ("socket_open",),
    "channel_of_another_server": ("socket_open",),
    "encoder_not_set_up": ("track_conveyor_",),
    "ended_thread": ("start_thread",),
    "endless_wait": ("while",),
    "handle_as_value": ("start_thread",),
    "hidden_variable": ("def ",),
    "index_out_of_range": ("[", "="),
    "line_end_as_prefix": ("socket_read_string",),
    "long_sleep": ("sleep",),
    "misspelt_variable": ("=",),
    "modbus_signal": ("modbus_add_",),
    "no_value_yet": ("=", " def ", "\tdef "),
    "number_too_large": ("modbus_set_output_register", "socket_send_byte", "set_", "write_"),
    "output_behind_blend": ("_out", "set_tool_digital", "write_"),
    "per_cent": ("interpolate_pose",),
    "serial_not_set_up": ("modbus_rtu", "modbus_read_", "modbus_write_"),
    "signal_added_in_loop": ("modbus_add_",),
    "stops_at_points": ("movel",),
    "swallowed_refusals": ("except",),
    "swapped_arguments": ("set_", "write_", "_read(", "_config("),
    "tool_pin_input": ("set_tool_digital_io_config",),
    "unasked_reading": ("socket_read_",),
    "unfit_address": ("socket_open", "modbus_"),
    "wrong_operands": (*"+-*/%<>[^&|.", "int(", "float(", "sum(", "len", "range", "for "),
}
"""Words of which a text has at least one where a rule can find anything, by file: other texts do not load it."""


@cache
def _files() -> tuple[str, ...]:
    """Return the names of the files of all rules."""
    from elitescript.lint import rules

    # `pkgutil` would import `inspect`, which takes longer than a third of the rules.
    paths = [path for folder in rules.__path__ for path in Path(folder).iterdir()]
    return tuple(sorted(path.stem for path in paths if path.suffix == ".py" and not path.stem.startswith("_")))


def rules_for(text: str) -> list[Rule]:
    """Return the rules that can find anything in a text, by code."""
    return _loaded(tuple(name for name in _files() if any(word in text for word in _WORDS.get(name, ("",)))))


def loaded_rules() -> Iterable[Rule]:
    """Return the rules that any text has needed by now."""
    return _RULES.values()


def codes_of_values() -> frozenset[str]:
    """Return the codes of the rules, of those that any text has needed by now, that need the values of expressions."""
    return frozenset(rule.code for rule in _RULES.values() if rule.needs_values)


def all_rules() -> list[Rule]:
    """Return every rule, by code."""
    return _loaded(_files())


@cache
def _loaded(files: tuple[str, ...]) -> list[Rule]:
    from elitescript.lint import rules

    names = {import_module(f"{rules.__name__}.{name}").__name__ for name in files}
    return [_RULES[code] for code in sorted(_RULES) if _RULES[code].check.__module__ in names]
