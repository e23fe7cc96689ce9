"""Formats of the report of `elitescript check`: text, JSON lines, GitHub workflow commands, SARIF 2.1.0."""

from __future__ import annotations

import os
import re
from pathlib import Path, PurePath
from typing import Any, Final

from elitescript import __version__
from elitescript.cli.output.screen import palette_of, rendered
from elitescript.environment.repository import from_root, repository_root
from elitescript.errors import CODES
from elitescript.json_records import jsonlines
from elitescript.language.diagnostics import Diagnostic, Fix, Severity, to_json
from elitescript.language.text.source import SourceFile
from elitescript.lint.fixing import Repair
from elitescript.records import NamedTuple
from elitescript.said import parts_of
from elitescript.shown import encodable, shown, shown_word

TYPE_CHECKING = False
if TYPE_CHECKING:
    from elitescript.cli.output.writable import Writable


class CheckedFile(NamedTuple):
    """The findings in one text.

    Attributes:
        name: of the text.
        source: the text, after repairs.
        problems: in the order of its lines.
        repairs: those of `--fix`.
    """

    name: str
    source: SourceFile
    problems: tuple[Diagnostic, ...]
    repairs: tuple[Repair, ...] = ()

    @property
    def is_stream(self) -> bool:
        """Whether it is no file, but `<stdin>`."""
        return self.name.startswith("<")


class CheckReport:
    """Writes problems as text."""

    def __init__(self, out: Writable) -> None:
        self._out = out
        self._files = self._errors = self._warnings = self._notes = self._repairs = 0

    def file(self, checked: CheckedFile) -> None:
        """Report one text."""
        self._files += 1
        self._repairs += len(checked.repairs)
        for repair in checked.repairs:
            self.repair(checked, repair)
        for problem in checked.problems:
            self._errors += problem.is_error
            self._warnings += problem.severity is Severity.WARNING
            self._notes += problem.severity is Severity.NOTE
            self.problem(checked, problem)

    def repair(self, checked: CheckedFile, repair: Repair) -> None:
        """Report one repair."""
        self._line(f"{shown_word(checked.name)}:{repair.line}: repaired {repair.code}: {shown(repair.title)}")

    def problem(self, checked: CheckedFile, problem: Diagnostic) -> None:
        """Report one problem."""
        self._line(rendered(problem, checked.source, palette_of(self._out)))

    def unfinished(self, checked: CheckedFile, line: int, text: str) -> None:
        """Report that the run of a program did not come to its end.

        Args:
            checked: the program.
            line: where it was; 0 if that is not known.
            text: why.
        """

    def end(self) -> None:
        """End the report, after all texts."""

    @property
    def summary(self) -> str:
        """Numbers of files, errors, warnings, notes and repairs, as one line."""
        repaired = f", {_count(self._repairs, 'repair')}" if self._repairs else ""
        found = f"{_count(self._errors, 'error')}, {_count(self._warnings, 'warning')}"
        found += f", {_count(self._notes, 'note')}" if self._notes else ""
        return f"{_count(self._files, 'file')} checked: {found}{repaired}"

    def _line(self, text: str) -> None:
        self._out.write(text + "\n")


class JsonCheckReport(CheckReport):
    """Writes one JSON object per line."""

    def repair(self, checked: CheckedFile, repair: Repair) -> None:
        record = {"file": checked.name, "type": "fix", "code": repair.code, "line": repair.line, "text": repair.title}
        self._line(jsonlines.line(record))

    def problem(self, checked: CheckedFile, problem: Diagnostic) -> None:
        node = checked.source.place(problem.line)
        self._line(jsonlines.line({"file": checked.name, **({"node": node} if node else {}), **to_json(problem)}))


class GithubReport(CheckReport):
    """Writes workflow commands, which GitHub shows at the lines of a change."""

    def __init__(self, out: Writable) -> None:
        super().__init__(out)
        self._root = repository_root()

    def repair(self, checked: CheckedFile, repair: Repair) -> None:
        place = f"file={_property(self._place(checked))},line={repair.line}"
        self._line(f"::notice {place},title={repair.code}::{_message(f'repaired: {repair.title}')}")

    def problem(self, checked: CheckedFile, problem: Diagnostic) -> None:
        fields: dict[str, str | int] = {"file": self._place(checked)}
        if checked.source.places:
            fields["line"] = checked.source.file_line(problem.line)
        else:
            fields |= {"line": problem.line, "col": problem.column, "endLine": problem.end_line}
            if problem.end_line == problem.line:
                fields["endColumn"] = problem.end_column
        fields["title"] = f"{problem.code} {CODES[problem.code].title}" if problem.code else "elitescript"
        text = _with_node(problem, checked.source)
        place = ",".join(f"{name}={_property(str(value))}" for name, value in fields.items())
        self._line(f"::{_COMMANDS[problem.severity]} {place}::{_message(text)}")

    def unfinished(self, checked: CheckedFile, line: int, text: str) -> None:
        place = f"file={_property(self._place(checked))},line={max(1, checked.source.file_line(line))}"
        self._line(f"::error {place},title=not finished::{_message(text)}")

    def _place(self, checked: CheckedFile) -> str:
        return checked.name if checked.is_stream else from_root(checked.name, self._root).as_posix()


class SarifReport(CheckReport):
    """Writes one SARIF 2.1.0 log after all texts."""

    def __init__(self, out: Writable) -> None:
        super().__init__(out)
        self._root = repository_root()
        self._results: list[dict[str, Any]] = []
        self._codes: list[str] = []
        self._unfinished: list[dict[str, Any]] = []

    def repair(self, checked: CheckedFile, repair: Repair) -> None:
        """Leave repairs out: a log has problems only."""

    def problem(self, checked: CheckedFile, problem: Diagnostic) -> None:
        if problem.code and problem.code not in self._codes:
            self._codes.append(problem.code)
        artifact = self._artifact(checked)
        text = encodable(_with_node(problem, checked.source))
        region = _region(problem.line, problem.column, problem.end_line, problem.end_column)
        if checked.source.places:
            region = {"startLine": checked.source.file_line(problem.line)}
        location: dict[str, Any] = {"physicalLocation": {"artifactLocation": artifact, "region": region}}
        if node := checked.source.place(problem.line):
            location["logicalLocations"] = [{"fullyQualifiedName": encodable(node)}]
        result: dict[str, Any] = {
            **({"ruleId": problem.code, "ruleIndex": self._codes.index(problem.code)} if problem.code else {}),
            "level": _LEVELS[problem.severity],
            "message": {"text": _plain(text)},
            "locations": [location],
            # In another language a reader makes the text of these.
            "properties": _encodable({**parts_of(problem.text), **parts_of(problem.hint, "hint_")}),
        }
        if problem.fix is not None:
            result["fixes"] = [_sarif_fix(problem.fix, artifact)]
        self._results.append(result)

    def unfinished(self, checked: CheckedFile, line: int, text: str) -> None:
        location: dict[str, Any] = {"artifactLocation": self._artifact(checked)}
        if line:
            location["region"] = {"startLine": checked.source.file_line(line)}
        notification = {"level": "error", "message": {"text": _plain(encodable(text))}}
        self._unfinished.append(notification | {"locations": [{"physicalLocation": location}]})

    def end(self) -> None:
        driver = {"name": "elitescript", "version": __version__, "rules": [_sarif_rule(code) for code in self._codes]}
        invocation: dict[str, Any] = {
            "executionSuccessful": not self._unfinished,
            "workingDirectory": {"uri": _folder_uri(Path.cwd())},
        }
        if self._unfinished:
            invocation["toolExecutionNotifications"] = self._unfinished
        run = {
            "tool": {"driver": driver},
            "columnKind": "unicodeCodePoints",
            "invocations": [invocation],
            "originalUriBaseIds": {_ROOT: {"uri": _folder_uri(self._root)}},
            "results": self._results,
        }
        log = {"$schema": _SCHEMA, "version": "2.1.0", "runs": [run]}
        self._line(jsonlines.line(log))

    def _artifact(self, checked: CheckedFile) -> dict[str, Any]:
        if checked.is_stream:
            from urllib.parse import quote

            return {"uri": quote(checked.name.strip("<>"))}
        return artifact_location(from_root(checked.name, self._root))


FORMATS: Final[dict[str, type[CheckReport]]] = {
    "text": CheckReport,
    "json": JsonCheckReport,
    "github": GithubReport,
    "sarif": SarifReport,
}
"""By the word of `--format`."""

_ROOT: Final = "%SRCROOT%"
"""Name of the root of the repository in SARIF, which code scanning knows."""
_LINK: Final = re.compile(r"\[([^\[\]]*)\]\(")
_SCHEMA: Final = "https://json.schemastore.org/sarif-2.1.0.json"
_LEVELS: Final = {Severity.ERROR: "error", Severity.WARNING: "warning", Severity.NOTE: "note"}
_COMMANDS: Final = {Severity.ERROR: "error", Severity.WARNING: "warning", Severity.NOTE: "notice"}


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}{'' if number == 1 else 's'}"


def _with_node(problem: Diagnostic, source: SourceFile) -> str:
    """Return text and hint of a problem, behind the node of a graphical program in which it is."""
    text = f"{source.line_words(problem.line)}: {problem.text}" if source.places else problem.text
    return f"{text}\nhint: {problem.hint}" if problem.hint else text


def _message(text: str) -> str:
    """Return escaped data of a workflow command."""
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _plain(text: str) -> str:
    """Return a text of a SARIF message in which nothing is a link (SARIF 2.1.0, 3.11.6)."""
    return _LINK.sub(r"\\[\1\\](", text)


def _property(text: str) -> str:
    """Return an escaped property of a workflow command."""
    return _message(text).replace(":", "%3A").replace(",", "%2C")


def artifact_location(path: PurePath) -> dict[str, str]:
    """Return where a file is, as SARIF has it.

    Args:
        path: relative to the root of the repository, or absolute.
    """
    if path.is_absolute():
        return {"uri": path.as_uri()}
    from urllib.parse import quote

    # Names are bytes, which need not be UTF-8. A colon in the first part would be read as a scheme.
    return {"uri": quote(os.fsencode(path.as_posix())), "uriBaseId": _ROOT}


def _folder_uri(folder: Path) -> str:
    return folder.as_uri().removesuffix("/") + "/"


def _region(line: int, column: int, end_line: int, end_column: int) -> dict[str, int]:
    return {"startLine": line, "startColumn": column, "endLine": end_line, "endColumn": end_column}


def _sarif_fix(fix: Fix, artifact: dict[str, Any]) -> dict[str, Any]:
    replacements = [
        {"deletedRegion": _region(*edit[:4]), "insertedContent": {"text": encodable(edit.text)}}
        for edit in sorted(fix.edits)
    ]
    return {
        "description": {"text": encodable(fix.title)},
        "artifactChanges": [{"artifactLocation": artifact, "replacements": replacements}],
    }


def _sarif_rule(code: str) -> dict[str, Any]:
    from elitescript.lint.explanations import body, markdown

    row = CODES[code]
    return {
        "id": code,
        "name": "".join(word.capitalize() for word in row.title.split() if word.isalnum()),
        "shortDescription": {"text": row.title},
        "fullDescription": {"text": body(code).split("\n\n")[0].replace("\n", " ")},
        "help": {"text": body(code), "markdown": markdown(code)},
        "defaultConfiguration": {"level": row.default_severity},
    }


def _encodable(value: Any) -> Any:
    """Return parts of a text as UTF-8 can have them."""
    if isinstance(value, dict):
        return {name: _encodable(part) for name, part in value.items()}
    return encodable(value) if isinstance(value, str) else value
