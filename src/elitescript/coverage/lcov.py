"""Coverage in the format of lcov's tracefiles, which genhtml, GitLab, Codecov and editors read.

Source: geninfo(1), section *Tracefile format*. Counts are true ones; a branch whose line was never reached is `-`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from elitescript.coverage.model import ProgramCoverage
from elitescript.shown import printable


def lcov(programs: Iterable[ProgramCoverage]) -> str:
    """Return the tracefile."""
    return "".join(f"{line}\n" for program in programs for line in _record(program))


def _record(program: ProgramCoverage) -> Iterator[str]:
    numbers = program.numbers
    yield "TN:"
    yield f"SF:{printable(program.path)}"
    known: set[str] = set()
    named = []
    for function in program.functions:
        # Of two functions of a name, the second one is known by its line.
        name = f"{function.name}@{function.line}" if function.name in known else function.name
        known.add(name)
        named.append((name, function))
    for name, function in named:
        yield f"FN:{function.line},{printable(name)}"
    for name, function in named:
        yield f"FNDA:{function.hits},{printable(name)}"
    yield f"FNF:{numbers.functions}"
    yield f"FNH:{numbers.functions_hit}"
    for line in dict.fromkeys(branch.line for branch in program.branches):
        for index, branch in enumerate(program.branches_of(line)):
            yield f"BRDA:{line},0,{index},{'-' if branch.hits is None else branch.hits}"
    yield f"BRF:{numbers.branches}"
    yield f"BRH:{numbers.branches_hit}"
    for line, hits in sorted(program.lines.items()):
        yield f"DA:{line},{hits}"
    yield f"LF:{numbers.lines}"
    yield f"LH:{numbers.lines_hit}"
    yield "end_of_record"
