"""Says of each thread of a program why it does not go on."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property, lru_cache
from types import FrameType
from typing import Any, Final

from elitescript.language.compiler import CompiledUnit
from elitescript.language.modules import COPIED
from elitescript.language.options import Options
from elitescript.language.parser import parse
from elitescript.language.scopes import Scope
from elitescript.language.symbols import Symbols
from elitescript.language.text.source import SourceFile
from elitescript.messages.timing import seconds
from elitescript.runtime.connections.connection import Receiver, ScriptConnection
from elitescript.runtime.names.context import MOVE_END, POPUP, RESUME
from elitescript.runtime.program import Program
from elitescript.runtime.stdlib.locks import A_LOCK, holder_awaited, is_lock, waits_at
from elitescript.runtime.threads.strand import ENDED, TIME_TO_GO_BY, Strand
from elitescript.runtime.why.conditions import Conditions, cut, shown
from elitescript.runtime.why.facts import Facts
from elitescript.runtime.why.loops import EXITS_MAX, Exit, exits, loops_at, scope_at
from elitescript.runtime.why.setters import Setters
from elitescript.said import Said, joined, said
from elitescript.values.concrete import UNKNOWN

_DATA_MAX: Final = 80
"""Most bytes of received data that are shown."""
_DEFAULT_SOCKET: Final = "socket_0"


class Reasons:
    """Says it of the threads of one program.

    Args:
        unit: the program.
        program: its run; None if it has none.
        strands: its threads.
        connections: that it has.
        facts: what is known of its surroundings.
        start_tick: its first tick, from which times are counted.
        is_paused: whether the program is.
    """

    __slots__ = ("__dict__", "_connections", "_facts", "_is_paused", "_program", "_start_tick", "_strands", "_unit")

    def __init__(
        self,
        unit: CompiledUnit,
        program: Program | None,
        strands: Sequence[Strand],
        connections: Iterable[Receiver],
        facts: Facts,
        start_tick: int,
        *,
        is_paused: bool = False,
    ) -> None:
        self._unit = unit
        self._program = program
        self._strands = strands
        self._connections = [one for one in connections if isinstance(one, ScriptConnection)]
        self._facts = facts
        self._start_tick = start_tick
        self._is_paused = is_paused

    def of(self, strand: Strand) -> str:
        """Return why a thread does not go on, for behind what it waits for; empty if that is not known."""
        reason = strand.waits_for
        if strand.is_running or strand.state is ENDED:
            return ""
        if reason == A_LOCK:
            return self._lock(strand)
        if reason == POPUP:
            return "nothing here confirms it"
        if reason == RESUME:
            return "nothing here resumes it"
        if self._is_paused and not strand.is_secondary:
            return "the program is paused, and nothing here resumes it"
        data = self._data(strand)
        if reason and reason not in (TIME_TO_GO_BY, MOVE_END) and strand.until is None:
            return data
        loop = self._loop(strand)
        if reason == TIME_TO_GO_BY and not loop:
            return self._call(strand)
        return joined("; ", filter(None, (data, loop)))

    # ---------------------------------------------------------------- loops

    @property
    def _symbols(self) -> Symbols:
        return _symbols_of(self._unit.source, self._unit.kind)

    @cached_property
    def _conditions(self) -> Conditions:
        setters = Setters(self._symbols, self._frame_in)
        context = None if self._program is None else self._program.context
        return Conditions(self._symbols, context, self._facts, setters, self._last_read)

    def _frames(self, strand: Strand) -> list[FrameType]:
        """Return the frames of a thread that are in the text of the program, the innermost one first."""
        return [frame for frame in strand.script_frames() if frame.f_code.co_filename == self._unit.source.name]

    def _loop(self, strand: Strand) -> str:
        """Return the words for the innermost loop in which a thread is."""
        for frame in self._frames(strand):
            line = strand.line_of(frame)
            loops = loops_at(self._symbols, line)
            # A `for` comes to its end: what is around it says more.
            around = next((loop for loop in loops if isinstance(loop, ast.While)), None)
            if loops:
                names = {**frame.f_globals, **frame.f_locals}
                scope = scope_at(self._symbols, loops[0].lineno)
                chosen = [loop for loop in (loops[0], around) if loop is not None]
                return joined("; ", (self._words(loop, names, scope, strand, line) for loop in dict.fromkeys(chosen)))
        return ""

    def _words(
        self, loop: ast.While | ast.For, names: Mapping[str, Any], scope: Scope, strand: Strand, line: int
    ) -> str:
        conditions = self._conditions
        where = "" if loop.lineno == line else said(" in line {line}", line=loop.lineno)
        if isinstance(loop, ast.For):
            head = cut(f"for {ast.unparse(loop.target)} in {conditions.text(loop.iter)}")
            now_at = [
                said("{name} is {value}", name=name, value=shown(names[name]))
                for name in _names_in(loop.target)
                if name in names
            ]
            if now_at:
                return said(
                    "`{head}`{where} is not finished: {now_at}", head=head, where=where, now_at=", ".join(now_at)
                )
            return said("`{head}`{where} is not finished", head=head, where=where)
        since = self._since(strand.loops.get(loop.lineno))
        if not isinstance(loop.test, ast.Constant):
            if strand.waits_for not in ("", TIME_TO_GO_BY) and line <= (loop.test.end_lineno or line):
                # What the condition is depends on what the thread waits for.
                values = conditions.values(loop.test, names, scope, loop)
                return said(
                    "`while {text}`{where} goes on{since}{values}",
                    text=conditions.text(loop.test),
                    where=where,
                    since=since,
                    values=values,
                )
            now = Said(" and is false by now") if conditions.holds(loop.test, names) is False else ""
            values = conditions.values(loop.test, names, scope, loop)
            return said(
                "`{text}`{where} has been true{since}{now}{values}",
                text=conditions.text(loop.test),
                where=where,
                since=since,
                now=now,
                values=values,
            )
        head = said(
            "`while {text}`{where}",
            text=conditions.text(loop.test),
            where=where or said(" in line {line}", line=loop.lineno),
        )
        ways = exits(loop)
        if not ways:
            return said("{head} has no end", head=head)
        ends = joined(" or ", (self._exit(way, names, scope, loop, since) for way in ways[:EXITS_MAX]))
        more = said(", or in one of {count} further ways", count=len(ways) - EXITS_MAX) if len(ways) > EXITS_MAX else ""
        return said("{head} ends {ends}{more}", head=head, ends=ends, more=more)

    def _exit(self, way: Exit, names: Mapping[str, Any], scope: Scope, loop: ast.While, since: str) -> str:
        is_true = self._conditions.holds(way.condition, names)
        state = Said(", which is true by now") if is_true else said(", which has been false{since}", since=since)
        values = self._conditions.values(way.condition, names, scope, loop)
        return said(
            "in line {line} when `{text}`{state}{values}",
            line=way.line,
            text=self._conditions.text(way.condition),
            state=state,
            values=values,
        )

    def _since(self, tick: int | None) -> str:
        return "" if tick is None else said(" since {seconds:g} s", seconds=seconds(tick - self._start_tick))

    def _call(self, strand: Strand) -> str:
        """Return since when a call that only takes time goes on."""
        frame = next(iter(self._frames(strand)), None)
        if frame is None or strand.until is None:
            return ""
        text = self._unit.source.line(strand.line_of(frame)).strip()
        since, until = self._since(strand.work_tick), seconds(strand.until - self._start_tick)
        return (
            said("`{text}` goes on{since} and until {until:g} s", text=cut(text), since=since, until=until)
            if text
            else ""
        )

    def _frame_in(self, scope: Scope) -> tuple[str, int, Mapping[str, Any]] | None:
        """Return a thread that is in a function: its name, the line there, and the variables."""
        for strand in self._strands:
            for frame in self._frames(strand):
                line = strand.line_of(frame)
                if scope_at(self._symbols, line) is scope:
                    return strand.name, line, {**frame.f_globals, **frame.f_locals}
        return None

    # ---------------------------------------------------------------- waits

    def _lock(self, strand: Strand) -> str:
        """Return which thread holds the lock for which a thread waits, and where that is."""
        holder = holder_awaited(strand)
        if holder is None:
            return ""
        name = self._lock_name(strand)
        which = said("the lock `{name}`", name=name) if name else Said("the lock")
        if holder is strand and self._is_in_library(strand):
            # A condition, an event or a queue, which have a lock for each thread that waits.
            return "no thread has ended that wait"
        if holder is strand:
            return said("it holds {which} itself", which=which)
        if holder.state is ENDED:
            return said("{holder} holds {which} and has ended", holder=holder.name, which=which)
        wait = (
            said(", waiting for {waits_for}", waits_for=holder.waits_for)
            if holder.waits_for not in ("", TIME_TO_GO_BY)
            else ""
        )
        return said(
            "{holder} holds {which} and is in line {line}{wait}",
            holder=holder.name,
            which=which,
            line=holder.line,
            wait=wait,
        )

    def _is_in_library(self, strand: Strand) -> bool:
        frame = strand.called_from_script()
        return frame is not None and frame.f_globals.get("__name__") in COPIED

    def _lock_name(self, strand: Strand) -> str:
        for frame in strand.script_frames():
            for name, value in (*frame.f_locals.items(), *frame.f_globals.items()):
                if is_lock(value) and waits_at(strand, value):
                    return name
        return ""

    def _data(self, strand: Strand) -> str:
        """Return what is there on the connection for which a thread waits and what that lacks, or what it has asked."""
        for connection in self._connections:
            if not connection.is_awaited_by(strand):
                continue
            if connection.received:
                data = bytes(connection.received[:_DATA_MAX])
                there = said("{data!r} is there", data=data.decode("utf-8", "backslashreplace"))
                lacks = getattr(connection.rule, "lacks", None)
                if lacks is None:
                    return there
                what, wanted = lacks(data)
                if what == "count":
                    return said("{there}, {count}", there=there, count=wanted)
                return said("{there}, its {part} {mark!r} has not come", there=there, part=Said(what), mark=wanted)
            since = said("nothing has come{since}", since=self._since(strand.work_tick))
            sent = self._facts.sent(*connection.log.place)
            return f"{since}; {sent}" if sent else since
        return ""

    def _last_read(self, name: str, arguments: tuple[Any, ...]) -> Any:
        """Return what a reading of a socket gave last; `UNKNOWN` if it is none, or has not ended yet."""
        if not name.startswith("socket_"):
            return UNKNOWN
        given = {one.log.place[1]: one.given for one in self._connections if one.log.place[0] == "socket"}
        named = [part for part in arguments if type(part) is str and part in given]
        last = given.get(named[0] if named else _DEFAULT_SOCKET)
        return last if type(last) in (str, int) else UNKNOWN


@lru_cache(maxsize=4)
def _symbols_of(source: SourceFile, kind: str) -> Symbols:
    """Return the symbols of a text; a debugger asks again at each stop."""
    return Symbols(parse(source, Options(kind=kind)))


def _names_in(target: ast.expr) -> list[str]:
    return [node.id for node in ast.walk(target) if isinstance(node, ast.Name)]
