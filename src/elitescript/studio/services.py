"""What the page's editor asks while a program is written, answered with the functions of `assist`.

`Desk` has the newest text and answers one request; `EditorServices` lets it do so in a thread of its own, so that a
slow answer holds up neither the next check nor another page. Results are the records of `assist` as JSON has them, with
the names of their fields; `web/src/source/services.ts` has them as types.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from enum import Enum
from itertools import takewhile
from pathlib import Path
from typing import Any, Final

from elitescript.assist import (
    actions,
    completion,
    folding,
    formatting,
    hints,
    outline,
    references,
    renaming,
    signatures,
    tokens,
)
from elitescript.assist.document import Document, Settings
from elitescript.assist.generated import refusal, task_of
from elitescript.assist.hover import hover
from elitescript.assist.last_run import LastRun
from elitescript.assist.typing_edits import typing_edits
from elitescript.commands.catalogue import CATALOGUE
from elitescript.commands.definition.page import record
from elitescript.conversation import describe
from elitescript.conversation.limits import LONG_LINES
from elitescript.errors import UsageError
from elitescript.kernel.options import DEFAULTS
from elitescript.language.diagnostics import Diagnostic, Edit
from elitescript.language.text.source import BOM
from elitescript.lint.explanations import markdown
from elitescript.lint.program import Span
from elitescript.messages.profile import PROFILES
from elitescript.messages.signals import SIGNALS
from elitescript.models.model import load_model, model_names
from elitescript.paths import PROGRAM_SUFFIX
from elitescript.records import NamedTuple, fields_of
from elitescript.studio.files import stamp
from elitescript.studio.meshes import Meshes
from elitescript.world_file import text_settings

EXAMPLES: Final = Path(__file__).parent / "examples"
"""Programs to begin with."""

_CHOICES: Final = (("robot", "model"), ("firmware", "firmware"))
"""Options of a run, and those of a robot that they are."""

PROGRAM_NAME: Final = f"program{PROGRAM_SUFFIX}"
"""Name of a text that people edit."""

_LINES_MAX: Final = 10_000_000


class Place(NamedTuple):
    """Where a request is about, and its further arguments.

    Attributes:
        line, column: from 1, column in characters; 0 if the request names none.
        arguments: of the service.
    """

    line: int
    column: int
    arguments: Mapping[str, Any]

    def text(self, name: str) -> str:
        """Return an argument that is a text.

        Raises:
            UsageError: it is missing, or something else.
        """
        value = self.arguments.get(name)
        if not isinstance(value, str):
            raise UsageError(f"{name}: must be a text, got {value!r:.60}")
        return value

    def span(self) -> Span:
        """Return the range up to `end_line` and `end_column`; the whole text if the request names no line."""
        if not self.line:
            return Span(1, 1, _LINES_MAX, 1)
        ends = [self.arguments.get(name, of) for name, of in (("end_line", self.line), ("end_column", self.column))]
        if not all(isinstance(end, int) and 0 <= end <= _LINES_MAX for end in ends):
            raise UsageError(f"end_line, end_column: must be whole numbers, got {ends!r:.60}")
        return Span(self.line, self.column, *ends)


class Desk:
    """Answers requests about one text. Not for two threads.

    Args:
        given: options of the robot on the command line.
        meshes: of the arm; None without a URDF.
    """

    __slots__ = ("_document", "_given", "_meshes", "last_run")

    def __init__(self, given: Mapping[str, Any], meshes: Meshes | None = None) -> None:
        self._document = Document(PROGRAM_NAME, "", -1)
        self._given = given
        self._meshes = meshes
        self.last_run: LastRun | None = None

    def put(self, version: int, text: str, settings: Settings, name: str = PROGRAM_NAME) -> None:
        """Take a text; one that is older than the newest is left out."""
        old = self._document
        is_other = name != old.name or settings != old.settings
        if version < old.version or (version == old.version and text == old.text and not is_other):
            return
        # A page has neither of these marks; with them, rows and places would be counted in other ways.
        is_plain = not any(mark in each for mark in ("\r", BOM) for each in (old.text, text))
        if is_plain and not is_other:
            self._document = old.edited(_edits(old, text), version)
        else:
            self._document = Document(name, text, version, settings)

    def answer(self, service: str, version: int, place: Place) -> Any:
        """Return the answer of a service, as JSON has it.

        Raises:
            UsageError: it cannot be answered.
        """
        if service in _OF_EDITS and (task := task_of(self._document.name)):
            raise UsageError(refusal(task))
        if service in _OF_TEXTS and version != self._document.version:
            raise UsageError(f"the text has changed: it is version {self._document.version}, not {version}")
        return plain(_SERVICES[service](self, place))

    def problems(self, version: int, *, are_all: bool = True) -> dict[str, Any] | None:
        """Return the message with what `check` finds; None if the text is another one by now.

        Args:
            version: of the text.
            are_all: False for what is found first, without values of expressions, of a long text: None if it is short
                or nothing is found.
        """
        document = self._document
        if version != document.version or not (are_all or document.line_count > LONG_LINES):
            return None
        found = document.problems if are_all else document.quick_problems
        if not (found or are_all):
            return None
        return describe.problems(version, found, compiles=not any(problem.keeps_from_starting for problem in found))

    # ---------------------------------------------------------------- of the text

    def _completion(self, place: Place) -> Any:
        return completion.completions(self._document, place.line, place.column)

    def _hover(self, place: Place) -> Any:
        return hover(self._document, place.line, place.column, self.last_run)

    def _signature(self, place: Place) -> Any:
        return signatures.signature_help(self._document, place.line, place.column)

    def _definition(self, place: Place) -> Any:
        return references.definition(self._document, place.line, place.column)

    def _references(self, place: Place) -> Any:
        return references.references(self._document, place.line, place.column)

    def _rename(self, place: Place) -> Any:
        if "new_name" not in place.arguments:
            return renaming.prepare_rename(self._document, place.line, place.column)
        return renaming.rename(self._document, place.line, place.column, place.text("new_name"))

    def _actions(self, place: Place) -> Any:
        return actions.code_actions(self._document, place.span())

    def _format(self, place: Place) -> Any:
        return formatting.format_edits(self._document, place.span() if place.line else None)

    def _tokens(self, place: Place) -> Any:
        types, modifiers = list(tokens.TokenType), list(tokens.TokenModifier)
        rows: list[int] = []
        for token in tokens.semantic_tokens(self._document, place.span() if place.line else None):
            bits = sum(1 << modifiers.index(modifier) for modifier in token.modifiers)
            rows += (token.line, token.column, token.length, types.index(token.type), bits)
        return {"types": types, "modifiers": modifiers, "rows": rows}

    def _typing(self, place: Place) -> Any:
        return typing_edits(self._document, place.line, place.column, place.text("typed"))

    def _hints(self, place: Place) -> Any:
        return hints.inlay_hints(self._document, place.span(), self.last_run)

    def _folding(self, place: Place) -> Any:
        return folding.folding_ranges(self._document)

    def _outline(self, place: Place) -> Any:
        return outline.document_symbols(self._document)

    # ---------------------------------------------------------------- of the product

    def _resolve(self, place: Place) -> Any:
        try:
            kind = completion.ItemKind(place.text("kind"))
        except ValueError:
            raise UsageError(f"kind: there is no {place.text('kind')!r:.60}") from None
        label = place.text("label")
        offer = completion.Completion(label, kind, Span(1, 1, 1, 1), label, source=place.text("source"))
        return {"documentation": completion.resolved(offer).documentation}

    def _explain(self, place: Place) -> Any:
        code = place.text("code")
        return {"code": code, "markdown": explained(code)}

    def _commands(self, place: Place) -> Any:
        if "name" not in place.arguments:
            return [record(command) for command in sorted(CATALOGUE, key=lambda command: command.name)]
        command = CATALOGUE.get(place.text("name"))
        return None if command is None else record(command)

    def _robots(self, place: Place) -> Any:
        robots = [load_model(name) for name in model_names()]
        rows = [{"name": arm.name, "reach_m": arm.reach_m, "payload_kg": arm.payload_max_kg} for arm in robots]
        chosen = {name: self._given.get(option, DEFAULTS[option]) for name, option in _CHOICES}
        return {"robots": rows, "firmwares": list(PROFILES), "defaults": chosen}

    def _mesh(self, place: Place) -> Any:
        if self._meshes is None:
            raise UsageError("the studio was started without --urdf")
        return self._meshes.urdf() if "file" not in place.arguments else self._meshes.file(place.text("file"))

    def _examples(self, place: Place) -> Any:
        texts = {path.stem: path.read_text(encoding="utf-8") for path in sorted(EXAMPLES.glob("*.script"))}
        return [{"name": name, "title": _title(text), "text": text} for name, text in texts.items()]

    def _signals(self, place: Place) -> Any:
        return [{**plain(signal), "default": signal.default} for signal in SIGNALS.values()]


_OF_TEXTS: Final[dict[str, Callable[[Desk, Place], Any]]] = {
    "completion": Desk._completion,
    "hover": Desk._hover,
    "signature": Desk._signature,
    "definition": Desk._definition,
    "references": Desk._references,
    "rename": Desk._rename,
    "actions": Desk._actions,
    "format": Desk._format,
    "tokens": Desk._tokens,
    "hints": Desk._hints,
    "typing": Desk._typing,
    "folding": Desk._folding,
    "outline": Desk._outline,
}
"""Services whose answer holds for one version of the text only."""

_OF_EDITS: Final = frozenset(("references", "rename", "format"))
"""Services of texts that people edit; of one that is generated they say where its source is."""

_SERVICES: Final[dict[str, Callable[[Desk, Place], Any]]] = {
    **_OF_TEXTS,
    "resolve": Desk._resolve,
    "explain": Desk._explain,
    "commands": Desk._commands,
    "robots": Desk._robots,
    "mesh": Desk._mesh,
    "examples": Desk._examples,
    "signals": Desk._signals,
}


class EditorServices:
    """A desk in a thread of its own.

    Args:
        given: options of the robot on the command line.
        world: path of the world file; None without one.
        meshes: of the arm; None without a URDF.
    """

    __slots__ = ("_desk", "_given", "_settings", "_thread", "_world")

    def __init__(self, given: Mapping[str, Any], world: Path | None = None, meshes: Meshes | None = None) -> None:
        self._desk = Desk(given, meshes)
        self._given = given
        self._settings: tuple[object, Settings] | None = None
        """What texts are written for, and what that was found with."""
        self._world = world
        self._thread = ThreadPoolExecutor(1, "editor services")

    def put(
        self,
        version: int,
        text: str,
        given: Mapping[str, Any],
        world: Path | None,
        name: str = PROGRAM_NAME,
    ) -> None:
        """Take a new text, with the options that it is run with; what the page leaves out is as at the start."""
        options = {**self._given, **given}
        self._thread.submit(self._put, version, text, options, world or self._world, name)

    def ran(self, last: LastRun) -> None:
        """Take what editors show of the last run."""
        self._thread.submit(setattr, self._desk, "last_run", last)

    async def answer(self, service: str, version: int, place: Place) -> Any:
        """Return the answer of a service, as JSON has it.

        Raises:
            UsageError: it cannot be answered.
        """
        return await asyncio.wrap_future(self._thread.submit(self._desk.answer, service, version, place))

    async def problems(self, version: int, *, are_all: bool = True) -> dict[str, Any] | None:
        """Return the message with what `check` finds; None if there is none. See `Desk.problems`."""
        return await asyncio.wrap_future(self._thread.submit(self._desk.problems, version, are_all=are_all))

    def close(self) -> None:
        """End the thread, when it has answered what it is at; what waits is dropped."""
        self._thread.shutdown(wait=False, cancel_futures=True)

    def _put(self, version: int, text: str, options: Mapping[str, Any], world: Path | None, name: str) -> None:
        self._desk.put(version, text, self._settings_for(options, world), name)

    def _settings_for(self, options: Mapping[str, Any], world: Path | None) -> Settings:
        """Return what a text is written for; files are read again when they have changed."""
        files = [None if world is None else stamp(world), stamp(Path(options.get("model", "")))]
        key = (dict(options), world, files)
        if self._settings is None or self._settings[0] != key:
            try:
                found, _ = text_settings(options, world)
            except UsageError:
                # The run of this text says what is wrong with its options.
                found = Settings()
            self._settings = (key, found)
        return self._settings[1]


def plain(value: Any) -> Any:
    """Return records, enumerations and tuples as JSON has them; findings as codes, which the page knows already."""
    if value is None or isinstance(value, bool | int | float):
        return value
    if isinstance(value, Enum | str):
        return str(value)
    if isinstance(value, Diagnostic):
        return value.code
    if isinstance(value, dict):
        return {str(name): plain(part) for name, part in value.items()}
    if isinstance(value, tuple) and hasattr(value, "_fields"):
        return {name: plain(part) for name, part in zip(value._fields, value, strict=True)}
    if isinstance(value, list | tuple):
        return [plain(part) for part in value]
    return {name: plain(getattr(value, name)) for name in fields_of(type(value))}


def explained(code: str) -> str:
    """Return the text of a code as Markdown.

    Raises:
        UsageError: there is no such code.
    """
    from elitescript.errors import CODES

    name = code.strip().upper()
    if name not in CODES:
        raise UsageError(f"there is no code {code!r:.60}")
    return f"{CODES[name].title}\n\n{markdown(name)}"


def _edits(old: Document, text: str) -> list[Edit]:
    """Return the one edit that makes a text of the old one: what is known of the rows around it is kept."""
    before, rows = old.source.lines, text.split("\n")
    room = min(len(before), len(rows)) - 1
    same = sum(1 for _ in takewhile(lambda index: before[index] == rows[index], range(room)))
    behind = sum(1 for _ in takewhile(lambda index: before[-1 - index] == rows[-1 - index], range(room - same)))
    last = len(before) - behind
    new = "\n".join(rows[same : len(rows) - behind])
    return [Edit(same + 1, 1, last, len(before[last - 1]) + 1, new)]


def _title(text: str) -> str:
    """Return the first comment of a program, without its dot."""
    return text.partition("\n")[0].lstrip("# ").rstrip(".")
