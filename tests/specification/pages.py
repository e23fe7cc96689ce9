"""Specification pages: Markdown in which programs and their expected outcome are executed.

A page is split into cases, a case is run on a `VirtualRobot`, and the outcome is compared with the lines of its
`expect` block. The form of a page is described in `tests/spec/README.md` of the source repository.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Final

from elitescript.errors import UsageError

FENCE: Final = "```"

SERVED: Final = frozenset({"port", "interpreter", "query"})
"""Words of texts that are sent to the ports of a robot."""
TEXT_WORDS: Final = frozenset({"stream", "close", "bare", "crlf", "cr", "bom", "at", "needs", "idle"}) | SERVED
EXPECT_WORDS: Final = frozenset({"strict", "firmware", "until"})
LISTS: Final = ("out", "print", "error", "alarm", "refused", "global", "sent")
"""Facts of which all must be listed, in order."""
FACTS: Final = frozenset(
    {*LISTS, "warn", "finding", "log-warning", "state", "time", "signal", "node", "moves"}
    | {"no findings", "no log-warnings", "no globals"}
)


@dataclass(frozen=True, slots=True)
class ProgramBlock:
    """One `elite` block."""

    line: int
    """Line of its first line in the page."""
    text: str
    words: dict[str, str]
    """Words after `elite`; one without a value is its own value."""

    @property
    def sent(self) -> str:
        """The text with the line ends and marks that its words ask for."""
        text = self.text
        if "bare" in self.words:
            text = text.removesuffix("\n")
        if "bom" in self.words:
            text = "\ufeff" + text
        if "crlf" in self.words:
            text = text.replace("\n", "\r\n")
        if "cr" in self.words:
            text = text.replace("\n", "\r")
        return text


@dataclass(frozen=True, slots=True)
class Fact:
    """One line of an `expect` block: `key: value`."""

    line: int
    key: str
    value: str

    def __str__(self) -> str:
        return self.key if self.key.startswith("no ") else f"{self.key}: {self.value}".rstrip()


@dataclass(frozen=True, slots=True)
class Expectation:
    """One `expect` block."""

    line: int
    words: dict[str, str]
    facts: tuple[Fact, ...]

    @property
    def label(self) -> str:
        """The conditions as text, empty for the ordinary ones."""
        return " ".join(word if word == value else f"{word}={value}" for word, value in self.words.items())

    def values(self, key: str) -> list[str]:
        """Return all values of one kind of fact."""
        return [fact.value for fact in self.facts if fact.key == key]


@dataclass(frozen=True, slots=True)
class Case:
    """Everything under one heading."""

    title: str
    """The headings above it and its own, joined by `/`."""
    line: int
    texts: tuple[ProgramBlock, ...]
    expectations: tuple[Expectation, ...]
    world: str = ""
    """The surroundings of the robot, as the text of a world file."""
    inputs: tuple[tuple[float, str, float], ...] = ()
    """Signals that change: time in s, name, value."""
    servers: tuple[tuple[int | str, int, str], ...] = ()
    """Servers and serial devices: port or serial line, line in the page, text; see `spec_server`."""

    @property
    def needs(self) -> str:
        """Feature that the case needs and that is missing; empty if it can be run."""
        return next((text.words["needs"] for text in self.texts if "needs" in text.words), "")

    @property
    def is_served(self) -> bool:
        """Whether it runs through the ports of a robot."""
        return not SERVED.isdisjoint(self.texts[0].words)

    @property
    def is_stream(self) -> bool:
        """Whether the texts arrive on the script port."""
        return any("stream" in text.words for text in self.texts)


@dataclass(slots=True)
class CaseOutcome:
    """Outcome of a case, in the words of an `expect` block."""

    lists: dict[str, list[str]] = field(default_factory=lambda: {key: [] for key in LISTS})
    findings: list[str] = field(default_factory=list)
    """Findings of the checker, as `warn: CODE line N` or `finding: CODE line N`."""
    log_warnings: list[str] = field(default_factory=list)
    state: str = ""
    time_s: float = 0.0
    signals: list[str] = field(default_factory=list)
    node: str = ""
    moves: int = 0
    wrong_replies: list[str] = field(default_factory=list)
    """Replies that a client should not have received, or did not receive."""


def parse_page(page: str) -> list[Case]:
    """Return the cases of a page, in order.

    Raises:
        UsageError: a block, a word or a line that the form does not have; the text names the line.
    """
    cases: list[Case] = []
    headings: list[str] = []
    line = 0
    texts: list[ProgramBlock] = []
    expectations: list[Expectation] = []
    world: list[str] = []
    inputs: list[tuple[float, str, float]] = []
    servers: list[tuple[int | str, int, str]] = []

    def close() -> None:
        if texts and not expectations:
            raise UsageError(f"line {texts[0].line}: a program without an expect block")
        if texts:
            if len(texts) > 1 and not all("stream" in text.words for text in texts):
                raise UsageError(f"line {texts[1].line}: several programs in one case must all be `stream`")
            names = [heading for heading in headings if heading]
            title = "/".join(names[1:] or names)
            around = "".join(world), tuple(inputs), tuple(servers)
            cases.append(Case(title, line, tuple(texts), tuple(expectations), *around))
        for found in (texts, expectations, world, inputs, servers):
            found.clear()

    for number, kind, info, body in _blocks(page):
        if kind == "heading":
            close()
            level = len(info)
            headings[level - 1 :] = [body.replace("`", "")]
            headings[:-1] += [""] * (level - len(headings))
            line = number
        elif info.split(" ")[0] == "elite":
            if expectations:
                raise UsageError(f"line {number}: a program after the expect block; start a new heading")
            texts.append(ProgramBlock(number + 1, body, _words(number, info, TEXT_WORDS)))
        elif info == "cell":
            world.append(body)
        elif info == "inputs":
            inputs += _inputs(number + 1, body)
        elif info.split(" ")[0] == "server":
            servers.append((_port(number, info), number + 1, body))
        elif info.split(" ")[0] == "line":
            servers.append((_device(number, info), number + 1, body))
        elif info.split(" ")[0] == "expect":
            if not texts:
                raise UsageError(f"line {number}: an expect block without a program")
            facts = tuple(_facts(number + 1, body))
            expectations.append(Expectation(number + 1, _words(number, info, EXPECT_WORDS), facts))
    close()
    return cases


def _blocks(page: str) -> Iterator[tuple[int, str, str, str]]:
    """Yield headings and fenced blocks: line, kind, level marks or info, text."""
    fence_line, info = 0, ""
    body: list[str] = []
    for number, line in enumerate(page.split("\n"), 1):
        if fence_line:
            if line.rstrip() == FENCE:
                yield fence_line, "block", info, "".join(f"{row}\n" for row in body)
                fence_line = 0
            else:
                body.append(line)
        elif line.startswith(FENCE):
            fence_line, info = number, line[len(FENCE) :].strip()
            body = []
        elif line.startswith("#"):
            marks, _, title = line.partition(" ")
            yield number, "heading", marks, title.strip()
    if fence_line:
        raise UsageError(f"line {fence_line}: a block that is not closed")


def _words(number: int, info: str, known: frozenset[str]) -> dict[str, str]:
    words = {}
    for word in info.split()[1:]:
        name, _, value = word.partition("=")
        if name not in known:
            raise UsageError(
                f"line {number}: the word {name!r} is not known here; there are {', '.join(sorted(known))}"
            )
        words[name] = value or name
    return words


def _facts(first_line: int, body: str) -> Iterator[Fact]:
    for number, line in enumerate(body.splitlines(), first_line):
        if not line.strip():
            continue
        key, colon, value = line.partition(":")
        if key not in FACTS or (not colon and not key.startswith("no ")):
            raise UsageError(f"line {number}: {line!r} is no expectation; write one of {', '.join(sorted(FACTS))}")
        yield Fact(number, key, value.removeprefix(" "))


def _inputs(first_line: int, body: str) -> Iterator[tuple[float, str, float]]:
    for number, line in enumerate(body.splitlines(), first_line):
        time_s, _, setting = line.partition(":")
        name, _, value = setting.partition("=")
        try:
            yield float(time_s), name.strip(), float(value)
        except ValueError:
            raise UsageError(f"line {number}: {line!r} is no input; write it as 0.5: external_wrench[0] = 20") from None


def _port(number: int, info: str) -> int:
    port = info.partition(" ")[2].strip()
    if not port.isdecimal():
        raise UsageError(f"line {number}: a server needs a port, such as 5000")
    return int(port)


def _device(number: int, info: str) -> str:
    device = info.partition(" ")[2].strip()
    if not device:
        raise UsageError(f"line {number}: a serial line needs a port of the robot, such as tool or /dev/ttymxc0")
    return device


def differences(outcome: CaseOutcome, expectation: Expectation) -> list[str]:
    """Return the differences between outcome and expectation; empty if it holds."""
    found = list(outcome.wrong_replies)
    for key in LISTS:
        wanted, had = expectation.values(key), outcome.lists[key]
        if not wanted and (key == "sent" or (key == "global" and not _has(expectation, "no globals"))):
            continue
        if len(wanted) != len(had) or not all(map(_matches, wanted, had)):
            found.append(_list_difference(key, wanted, had))
    for fact in expectation.facts:
        message = _fact_difference(fact, outcome)
        if message:
            found.append(message)
    if not _has(expectation, "state"):
        natural = "alarm" if expectation.values("alarm") else "finished"
        if outcome.state not in {natural, ""}:
            found.append(f"ended with state {outcome.state}, expected {natural}")
    return found


def _has(expectation: Expectation, key: str) -> bool:
    return any(fact.key == key for fact in expectation.facts)


def _matches(wanted: str, had: str) -> bool:
    """Return whether an observed fact is the wanted one; alarms are observed as `CODE CLASS line N`."""
    if wanted == had:
        return True
    words = had.split(" ")
    is_alarm = had.startswith("R") and len(words) == 4
    return is_alarm and wanted.split(" ") in ([name, *place] for name in words[:2] for place in ([], words[2:]))


def _list_difference(key: str, wanted: list[str], had: list[str]) -> str:
    rows = [f"{key}:"]
    for index in range(max(len(wanted), len(had))):
        left = wanted[index] if index < len(wanted) else None
        right = had[index] if index < len(had) else None
        if left is not None and right is not None and _matches(left, right):
            rows.append(f"      {right}")
        else:
            rows += [] if left is None else [f"    - {left}"]
            rows += [] if right is None else [f"    + {right}"]
    return "\n".join(rows)


def _fact_difference(fact: Fact, outcome: CaseOutcome) -> str:
    key, value = fact.key, fact.value
    if key in {"warn", "finding"}:
        had = outcome.findings
        return "" if f"{key}: {value}" in had else f"{fact}: not reported; the checker said {had}"
    if key == "no findings":
        return f"the checker said {outcome.findings}, expected nothing" if outcome.findings else ""
    if key == "log-warning":
        had = outcome.log_warnings
        return "" if any(text.startswith(value) for text in had) else f"{fact}: not recorded; there were {had}"
    if key == "no log-warnings":
        return f"the run recorded {outcome.log_warnings}, expected no warning" if outcome.log_warnings else ""
    if key == "state":
        return "" if outcome.state == value else f"ended with state {outcome.state}, expected {value}"
    if key == "time":
        return "" if _is_time(outcome.time_s, value) else f"ended at {outcome.time_s:g} s, expected {value}"
    if key == "signal":
        return "" if value in outcome.signals else f"{fact}: signals are {outcome.signals}"
    if key == "node":
        return "" if outcome.node == value else f"the last mark is {outcome.node!r}, expected {value!r}"
    if key == "moves":
        return "" if outcome.moves == int(value) else f"{outcome.moves} moves were started, expected {value}"
    return ""


def _is_time(time_s: float, wanted: str) -> bool:
    half_tick = 0.002
    if wanted.startswith("at least "):
        return time_s >= float(wanted.removeprefix("at least ")) - half_tick
    low, _, high = wanted.partition(" to ")
    return float(low) - half_tick <= time_s <= float(high or low) + half_tick
