"""Names that compiled programs use and no source text can contain.

The runtime puts them into the builtins of a run. They start with `@`, which no identifier can;
a leading `__` would be mangled inside classes.
"""

from __future__ import annotations

from typing import Final

MAIN: Final = "@main"
TICK: Final = "@tick"
CHECKPOINT: Final = "@cp"
PAY: Final = "@pay"
RANGE: Final = "@range"
STOP: Final = "@stop"
LINE: Final = "@line"
ATTRIBUTE: Final = "@attribute"
WATCHED: Final = "@watched"
AT: Final = "@at"
STEPS: Final = "@steps"
STEP: Final = "@step"
HITS: Final = "@hits"
LOOP: Final = "@loop"

HOOKS: Final[dict[str, str]] = {
    TICK: "`() -> bool`: uses up one unit of work; False when there is none left, and then `@cp` is called",
    CHECKPOINT: "`() -> True`: the thread's budget is used up; may switch, wait or raise a stop. Must return True, "
    "because comprehensions and lambdas go on with `@tick() or @cp()` as a condition",
    PAY: "`(count) -> bool`: uses up that many units of work, if there are so many before `@cp` would be called; "
    "False, and nothing is used up, if not",
    RANGE: "the built-in `range`, to see whether a program has another one",
    STOP: "exception class (a BaseException), or a tuple of them, that ends a thread; every `try` lets it pass",
    LINE: '`(number, label, after=None) -> None`: the program reached a `$ LINE: (number, "label")` mark',
    ATTRIBUTE: "`(object, name) -> value`: stands for `object.name`; `name` is one of `policy.GUARDED_ATTRIBUTES`",
    WATCHED: "what looks at the statements of the run: empty unless a debugger is attached",
    LOOP: "`(mark) -> True`: the thread comes to a loop in which it may wait; the mark is this name and the line",
    AT: "`(number) -> None`: a statement of the program comes next; called only while `@watched` is not empty",
}
"""Names that the builtins of a run must hold besides what scripts may call.

Python itself also takes `__build_class__`, `__import__` and `__name__` from there.
"""

PROBE_HOOKS: Final[dict[str, str]] = {
    STEPS: "list of `() -> bool`, by statement: whether the statement goes on at once",
    STEP: "`(number) -> (() -> True)`: called before a statement that does not; may stop the run",
    HITS: "list of int, by counter: how often each statement and side of a branch was reached",
}
"""Names that the builtins must hold for texts that were compiled with probes; see `language.probes`."""
