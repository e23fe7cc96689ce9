"""Coverage as one JSON object: everything that the other reports show."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

from elitescript.coverage.model import Numbers, ProgramCoverage, total
from elitescript.coverage.unmet import Unmet
from elitescript.shown import encodable_json


def json_report(programs: Sequence[ProgramCoverage], unmet: Unmet) -> str:
    """Return the text of the file."""
    found = {
        "programs": [_program(program) for program in programs],
        "totals": _numbers(total(programs)),
        "met": {"alarms": list(unmet.alarms)},
        "unmet": {
            "refusals": [
                {
                    "file": refusal.path,
                    "line": refusal.line,
                    "command": refusal.command,
                    "error": refusal.error,
                    "text": refusal.text,
                }
                for refusal in unmet.refusals
            ],
            "handlers": [{"file": row.path, "line": row.line, "text": row.text} for row in unmet.handlers],
            "safety_states": list(unmet.safety_states),
            "task_states": list(unmet.task_states),
            "faults": [{"on": fault.on, "kinds": list(fault.kinds)} for fault in unmet.faults],
        },
    }
    return encodable_json(json.dumps(found, indent=1, ensure_ascii=False)) + "\n"


def _program(program: ProgramCoverage) -> dict[str, Any]:
    return {
        "file": program.path,
        "lines": {str(line): hits for line, hits in sorted(program.lines.items())},
        "branches": [{"line": branch.line, "to": branch.to, "hits": branch.hits} for branch in program.branches],
        "functions": [
            {"name": row.name, "line": row.line, "end_line": row.last_line, "hits": row.hits}
            for row in program.functions
        ],
        "handlers": [{"line": row.line, "text": row.text, "hits": row.hits} for row in program.handlers],
        **({"nodes": [{"node": row.place, "hits": row.hits} for row in program.nodes]} if program.places else {}),
        "totals": _numbers(program.numbers),
    }


def _numbers(numbers: Numbers) -> dict[str, Any]:
    return {
        "lines": numbers.lines,
        "lines_hit": numbers.lines_hit,
        "branches": numbers.branches,
        "branches_hit": numbers.branches_hit,
        "functions": numbers.functions,
        "functions_hit": numbers.functions_hit,
        "percent": round(numbers.percent, 2),
    }
