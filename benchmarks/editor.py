"""The language server as editors feel it: a real process, 2,000 lines of program, a client that waits for answers.

Each request is measured twice: right behind a change in the middle of the text, when nothing is known of it yet, and
again. Findings are pushed, as to a client that does not ask for them, and are out of the way before the next request.
`typing` measures findings of 5,000 lines, from the last key to the message of what needs no values and to that of all.
"""

from __future__ import annotations

import os
from statistics import quantiles
from time import perf_counter, sleep
from typing import Any

from benchmarks.checking import text_of
from benchmarks.framed import FramedProcess
from benchmarks.table import Row, Time, timed_row

LINES = 2000
LONG = 5000
KEYS = 12
"""Keys that are typed, and how many in a second."""
ROUNDS = int(os.environ.get("EDITOR_ROUNDS", "20"))
SESSIONS = int(os.environ.get("EDITOR_SESSIONS", "1000"))
URI = "file:///cell.script"
TEXT = {"textDocument": {"uri": URI}}
CHANGED_LINE = 1004


def program(lines: int = LINES) -> str:
    """Return a program of functions that move, look at inputs and set outputs."""
    rows = ["def cell():", "  global count", "  count = 0"]
    number = 0
    while len(rows) < lines - 12:
        rows += [
            f"  def pick_{number}(height, speed=0.5):",
            "    above = [0.4, -0.2, height, 3.14, 0, 0]  # over the tray",
            "    movel(above, a=1.2, v=speed)",
            f"    if get_standard_digital_in({number % 8}):",
            f"      set_standard_digital_out({number % 8}, True)",
            '      textmsg("picked at ", height)',
            "      count = count + 1",
            "    end",
            "    sleep(0.1)",
            "    return above",
            "  end",
        ]
        number += 1
    rows += [f"  pick_{index}(0.2)" for index in range(lines - len(rows) - 1)]
    return "\n".join([*rows, "end"]) + "\n"


class Editor(FramedProcess):
    """A server as a process, and the client of it."""

    def __init__(self) -> None:
        began = perf_counter()
        super().__init__("lsp")
        self._next = 0
        self.ask("initialize", {"processId": None, "rootUri": None, "capabilities": {}, **QUIET})
        self.ready = Time(perf_counter() - began, self.cpu_s())
        self.tell("initialized", {})

    def tell(self, method: str, params: Any) -> None:
        """Send a notification."""
        self.send({"jsonrpc": "2.0", "method": method, "params": params})

    def ask(self, method: str, params: Any = None) -> Any:
        """Return the result of a request."""
        self._next += 1
        more = {} if params is None else {"params": params}
        self.send({"jsonrpc": "2.0", "id": self._next, "method": method, **more})
        answer = self.until(lambda message: message.get("id") == self._next)
        if "error" in answer:
            raise RuntimeError(f"{method}: {answer['error']}")
        return answer["result"]

    def findings(self, version: int) -> None:
        """Wait for the findings of a version."""
        self.until(lambda message: message.get("params", {}).get("version") == version)

    def open(self, text: str, uri: str = URI, version: int = 1) -> None:
        """Open a text."""
        item = {"uri": uri, "languageId": "elitescript", "version": version, "text": text}
        self.tell("textDocument/didOpen", {"textDocument": item})

    def change(self, version: int, uri: str = URI, line: int = CHANGED_LINE) -> None:
        """Type a character at the end of a line."""
        place = {"line": line, "character": 1000}
        changes = [{"range": {"start": place, "end": place}, "text": " "}]
        self.tell(
            "textDocument/didChange", {"textDocument": {"uri": uri, "version": version}, "contentChanges": changes}
        )

    def close(self) -> None:
        """End the server."""
        self.ask("shutdown")
        self.tell("exit", None)
        self.process.communicate()


QUIET = {"initializationOptions": {"hints": {"run": False}}}
PLACE = {**TEXT, "position": {"line": CHANGED_LINE + 1, "character": 6}}
WINDOW = {"start": {"line": 960, "character": 0}, "end": {"line": 1020, "character": 0}}
LAYOUT = {"tabSize": 2, "insertSpaces": True}
REQUESTS: dict[str, tuple[str, dict[str, Any]]] = {
    "hover": ("textDocument/hover", PLACE),
    "completion": ("textDocument/completion", PLACE),
    "signature": ("textDocument/signatureHelp", {**TEXT, "position": {"line": CHANGED_LINE + 1, "character": 20}}),
    "definition": ("textDocument/definition", PLACE),
    "references": ("textDocument/references", {**PLACE, "context": {"includeDeclaration": True}}),
    "rename": ("textDocument/rename", {**TEXT, "position": {"line": 1, "character": 10}, "newName": "counted"}),
    "symbols": ("textDocument/documentSymbol", TEXT),
    "folding": ("textDocument/foldingRange", TEXT),
    "tokens of the window": ("textDocument/semanticTokens/range", {**TEXT, "range": WINDOW}),
    "tokens of the text": ("textDocument/semanticTokens/full", TEXT),
    "inlay hints of the window": ("textDocument/inlayHint", {**TEXT, "range": WINDOW}),
    "lenses": ("textDocument/codeLens", TEXT),
    "layout of a line": (
        "textDocument/onTypeFormatting",
        {**TEXT, "position": {"line": CHANGED_LINE, "character": 0}, "ch": "\n", "options": LAYOUT},
    ),
    "layout of the text": ("textDocument/formatting", {**TEXT, "options": LAYOUT}),
}


def rows() -> list[Row]:
    """Start, first findings, each request, memory."""
    editor = Editor()
    try:
        table = [timed_row("language server: ready", editor.ready)]
        table.append(timed_row(f"first findings of {LINES} lines", _first_findings(editor)))
        version = ROUNDS + 1
        for name, (method, params) in REQUESTS.items():
            behind: list[Time] = []
            again: list[Time] = []
            for _ in range(ROUNDS):
                version += 1
                editor.change(version)
                behind.append(_asked(editor, method, params))
                again.append(_asked(editor, method, params))
                editor.findings(version)
            table += [_row(f"{name}, behind a change", behind), _row(f"{name}, again", again)]
        table += _sessions(editor)
    finally:
        editor.close()
    return [*table, *typing()]


def typing() -> list[Row]:
    """Type in long texts, one key and many, and wait for the findings."""
    table = []
    texts = {"functions": program(LONG), "one body": text_of("mixed statements", LONG)}
    for name, text in texts.items():
        editor = Editor()
        rows = text.split("\n")
        # Only the values of expressions show that this line is wrong.
        rows.insert(CHANGED_LINE, '  sleep("long" + "er")')
        try:
            editor.open("\n".join(rows))
            editor.until(_has_all)
            version = 1
            for keys in (1, KEYS):
                firsts, wholes = [], []
                for _ in range(ROUNDS // 2):
                    version, first, whole = _typed(editor, version, keys)
                    firsts.append(first)
                    wholes.append(whole)
                what = f"{LONG} lines, {name}, last of {keys} key{'s' if keys > 1 else ''} to findings"
                table += [_row(f"{what} without values", firsts), _row(f"{what}, all", wholes)]
        finally:
            editor.close()
    return table


def _has_all(message: dict[str, Any], version: int = 1) -> bool:
    params = message.get("params", {})
    return params.get("version") == version and any(found["code"] == "E304" for found in params["diagnostics"])


def _typed(editor: Editor, version: int, keys: int) -> tuple[int, Time, Time]:
    """Type so many keys; return the last version, and the times from it to the first message and to that of all."""
    for key in range(keys):
        if key:
            sleep(1 / KEYS)
        version += 1
        began, cpu_s = perf_counter(), editor.cpu_s()
        editor.change(version)
    message = editor.until(lambda message: message.get("params", {}).get("version") == version)
    first = Time(perf_counter() - began, editor.cpu_s() - cpu_s)
    if not _has_all(message, version):
        editor.until(lambda message: _has_all(message, version))
    return version, first, Time(perf_counter() - began, editor.cpu_s() - cpu_s)


def _first_findings(editor: Editor) -> Time:
    """Return the median time from opening a text to its findings; each time it is another text."""
    times = []
    for number in range(ROUNDS):
        began, cpu_s = perf_counter(), editor.cpu_s()
        editor.open(program() + f"# {number}\n", version=number + 1)
        editor.findings(number + 1)
        times.append(Time(perf_counter() - began, editor.cpu_s() - cpu_s))
        if number < ROUNDS - 1:
            editor.tell("textDocument/didClose", TEXT)
    return Time(sorted(time.wall_s for time in times)[ROUNDS // 2], sum(time.cpu_s for time in times) / ROUNDS)


def _asked(editor: Editor, method: str, params: Any) -> Time:
    began, cpu_s = perf_counter(), editor.cpu_s()
    editor.ask(method, params)
    return Time(perf_counter() - began, editor.cpu_s() - cpu_s)


def _row(what: str, times: list[Time]) -> Row:
    """Return median and worst case of some answers; CPU is the mean, since the system counts it in steps of 10 ms."""
    walls = quantiles([time.wall_s for time in times], n=100, method="inclusive")
    mean_cpu_s = sum(time.cpu_s for time in times) / len(times)
    return timed_row(what, Time(walls[49], mean_cpu_s), words=f"p99 {1e3 * walls[98]:.3g} ms")


def _sessions(editor: Editor) -> list[Row]:
    """Return the memory after a tenth of the sessions, and after all: a text is opened, edited, read and closed."""
    text = program(200)
    after: list[float] = []
    for number in range(SESSIONS):
        uri = f"file:///session_{number}.script"
        editor.open(text, uri, 10 * number + 1)
        for step in range(2, 5):
            editor.change(10 * number + step, uri, 60 + step)
        editor.ask("textDocument/semanticTokens/full", {"textDocument": {"uri": uri}})
        editor.findings(10 * number + 4)
        editor.tell("textDocument/didClose", {"textDocument": {"uri": uri}})
        if number + 1 in (SESSIONS // 10, SESSIONS):
            after.append(editor.memory_mib())
    early, late = after
    return [Row(f"memory after {SESSIONS} sessions", "MiB", value=late, other=early, beside=f"after {SESSIONS // 10}")]
