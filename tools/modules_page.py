"""Writes the reference page of modules: what each has in programs, and what is left out, with the reason."""

from __future__ import annotations

from typing import Final

from elitescript.language.modules import COPIED_NAMES, NETWORK, OWN_NAMES, SHARED_NAMES
from tools.markdown import NOTICE

_EVALUATES: Final = "would evaluate text past the checks of a program"
_ANY_ATTRIBUTE: Final = "would read any attribute of any object"
_HOST: Final = "belongs to the interpreter, not to a program"
_ASYNC: Final = "belongs to `async`, which programs do not have"

LEFT_OUT: Final[dict[str, tuple[tuple[str, str], ...]]] = {
    "base64": (
        ("decode encode", "work on files: `b64encode` and `b64decode` on what was read"),
        ("b32hexdecode b32hexencode", "rare"),
    ),
    "binascii": (("a2b_qp b2a_qp", "belong to mail"),),
    "dataclasses": (("Field make_dataclass", "would make classes from text: write the class"),),
    "decimal": (
        ("BasicContext DefaultContext ExtendedContext", "all programs would share them: `Context(prec=9)`"),
        ("DecimalTuple HAVE_CONTEXTVAR HAVE_THREADS", _HOST),
    ),
    "enum": (
        ("EnumMeta EnumType", "the class of classes"),
        ("global_enum global_enum_repr global_flag_repr global_str", "change other modules"),
        ("pickle_by_enum_name pickle_by_global_name", "there is no `pickle`"),
    ),
    "functools": (
        ("singledispatch singledispatchmethod", f"look for types in annotations, which {_EVALUATES}: `isinstance`"),
        ("WRAPPER_ASSIGNMENTS WRAPPER_UPDATES", "`wraps` copies name, text and attributes, and takes no lists"),
    ),
    "hashlib": (("algorithms_available file_digest", "differ by computer: `sha256(f.read())`"),),
    "operator": (
        ("attrgetter methodcaller", f"{_ANY_ATTRIBUTE}: `lambda x: x.name`"),
        ("call", "write the call"),
    ),
    "string": (("Formatter", f"{_ANY_ATTRIBUTE}: f-strings and `%`"),),
    "threading": (
        ("ExceptHookArgs excepthook", "an exception that leaves a thread is an alarm"),
        ("getprofile gettrace setprofile settrace stack_size", _HOST),
    ),
    "typing": (
        ("ForwardRef get_type_hints", _EVALUATES),
        ("AsyncContextManager AsyncGenerator", _ASYNC),
        ("clear_overloads get_overloads no_type_check_decorator reveal_type", "for tools, not for running programs"),
    ),
}
"""Names of modules of Python 3.11 that programs do not find, with the reason."""

_HOW: Final = {
    "shared": "Functions and classes of the installed Python.",
    "copied": "A copy of Python's own module, for each run.",
    "own": "Made for programs, in robot time.",
}

_NOTES: Final = {
    "collections.abc": "`isinstance` knows the classes of `collections` and those of programs.",
    "dataclasses": "`ClassVar`, `InitVar` and `KW_ONLY` are known, also within texts. Frozen ones are hashed by value.",
    "datetime": "Classes are those of Python; their clock and their zone are those of the robot.",
    "os": "Paths are those of the task folder; no process, user or device of the computer.",
    "queue": "Waits take robot time.",
    "random": "Numbers follow the seed of the run.",
    "re": "Patterns are those of Python.",
    "subprocess": "Programs are simulated: `VirtualRobot` and world files say what each answers.",
    "sys": "`version_info` is that of the firmware.",
    "threading": "Threads are those of the robot program, in its order; waits take robot time.",
    "time": "Robot time; `sleep` takes no time of yours.",
    "typing": (
        "Classes and functions are Python's. Annotations of programs are kept as texts and never evaluated; "
        "`Generic[T]`, `Protocol`, `runtime_checkable`, `NamedTuple`, `TypedDict` and `Union` in "
        "`isinstance` work as there."
    ),
}


def modules_page() -> str:
    """Modules that programs can import, with their names and with what is left out."""
    lines = [
        "# Modules",
        "",
        NOTICE,
        "What `import` finds in a program, and which names each module has. All other modules are an `ImportError`",
        f"that names them; for {', '.join(f'`{name}`' for name in sorted(NETWORK))} it names the commands",
        "that do their work.",
        "Names that came with a later Python are there where elitescript runs on that one.",
        "",
    ]
    tables = (("shared", SHARED_NAMES), ("copied", COPIED_NAMES), ("own", OWN_NAMES))
    found = {name: (how, names) for how, table in tables for name, names in table.items()}
    for name in sorted(found):
        how, names = found[name]
        has = "All public names." if names == "*" else ", ".join(f"`{item}`" for item in sorted(names.split())) + "."
        note = _NOTES.get(name, "")
        lines += [f"## {name}", "", f"{_HOW[how]}{f' {note}' if note else ''}", "", f"Has: {has}", ""]
        left_out = LEFT_OUT.get(name, ())
        if left_out:
            lines += ["| not there | because |", "|---|---|"]
            lines += [
                f"| {', '.join(f'`{item}`' for item in items.split())} | {reason} |" for items, reason in left_out
            ]
            lines.append("")
        elif how == "own":
            lines += ["Nothing else of it is there.", ""]
    return "\n".join(lines).rstrip("\n") + "\n"
