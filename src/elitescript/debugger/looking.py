"""What a stopped run shows: threads, stacks, scopes, values. Looking changes nothing and spends nothing."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import hypot
from types import FrameType
from typing import Any, Final, TypeAlias

from elitescript.controller.controller import Controller
from elitescript.debugger.api import Frame, Scope, ThreadInfo, Variable
from elitescript.debugger.places import Places
from elitescript.debugger.values import (
    CHILDREN_MAX,
    PART_MAX,
    TEXT_MAX,
    Child,
    Group,
    Joints,
    Pose,
    child_named,
    children,
    count_children,
    more,
    room_of_each,
    shown,
    type_name,
)
from elitescript.errors import DebugError
from elitescript.messages.signals import SIGNALS
from elitescript.runtime.host import ScriptHost
from elitescript.runtime.names.modules import Facade
from elitescript.runtime.names.reading import predefined_call
from elitescript.runtime.program import Program, is_shown
from elitescript.runtime.stdlib.locks import A_LOCK, holder_awaited, is_lock, waits_at
from elitescript.runtime.threads.strand import ENDED, Strand, state_of
from elitescript.values.concrete import (
    CONDITION_STEPS_MAX,
    STEPS_MAX,
    Indexed,
    MissingName,
    Pure,
    Refusal,
    computed,
    parsed,
    short,
    truth,
)
from elitescript.values.places import PLACES

LOCALS: Final = "Locals"
GLOBALS: Final = "Globals"
ROBOT: Final = "Robot"
SIGNALS_GROUP: Final = "signals"
OF_ROBOT: Final = "of the robot"
LEFT_OUT: Final = "…"
"""Name of the row that says how many children are left out."""

SCOPE: Final = -1
RESULT: Final = -2
GONE: Final = "gone"

Way: TypeAlias = tuple[int, str, int]
"""How a value was come by: the number of what holds it, and its name there; or `SCOPE` and the name of the scope, or
`RESULT` and an expression, each with the number of the frame."""
NO_WAY: Final[Way] = (0, "", 0)

_PURE_MODULES: Final = frozenset(("math", "cmath"))
ROBOT_NAMES: Final = ("t", "tick", "tcp", "joints", "robot_mode", "safety")


class CallFrame:
    """A call on the stack of a thread.

    Attributes:
        strand: its thread.
        frame: of Python.
        line: that it is at.
        depth: calls above the outermost one of the thread.
    """

    __slots__ = ("depth", "frame", "line", "strand")

    def __init__(self, strand: Strand, frame: FrameType, line: int, depth: int) -> None:
        self.strand = strand
        self.frame = frame
        self.line = line
        self.depth = depth


class Look:
    """The run at one stop. Frames and references are valid as long as it is.

    Args:
        controller: the machine.
        host: runs the programs.
        places: statements.
        error: the exception with which the thread that runs has failed, if that is the stop.

    Attributes:
        steps_max: most nodes that one expression may take.
        condition_steps_max: most nodes that a condition may take.
    """

    steps_max = STEPS_MAX
    condition_steps_max = CONDITION_STEPS_MAX

    def __init__(
        self, controller: Controller, host: ScriptHost, places: Places, error: BaseException | None = None
    ) -> None:
        self._controller = controller
        self._host = host
        self._places = places
        self._error = error
        self._frames: list[CallFrame | None] = []
        self._shown: list[tuple[str, Any, CallFrame | None, str]] = []
        """Scopes and values that can be expanded: kind, value, frame, expression."""
        self._ways: list[Way] = []
        """How each of them was come by."""

    # ---------------------------------------------------------------- threads

    def strands(self) -> list[Strand]:
        """Return the living threads in the order of their start."""
        return sorted(self._host.scheduler.strands, key=lambda strand: strand.order)

    def strand(self, thread: int) -> Strand:
        """Return a living thread by its number.

        Raises:
            DebugError: there is none.
        """
        for strand in self._host.scheduler.strands:
            if strand.order == thread - 1:
                return strand
        raise DebugError(f"there is no thread {thread}")

    def threads(self) -> tuple[ThreadInfo, ...]:
        """See `DebugSession.threads`."""
        found = []
        reasons = self._host.reasons()
        for strand in self.strands():
            calls = self.calls(strand)
            wait = self._wait_of(strand, calls)
            line = calls[0].line if calls else 0
            is_standing = strand is self._host.scheduler.current
            because = "" if reasons is None or is_standing else reasons.of(strand)
            found.append(ThreadInfo(strand.order + 1, strand.name, strand.is_secondary, wait, line, because))
        return tuple(found)

    def calls(self, strand: Strand) -> list[CallFrame]:
        """Return the calls of a thread, the innermost one first; those that an exception has left stand still."""
        found = [(frame, strand.line_of(frame)) for frame in strand.script_frames()]
        if self._is_failed(strand):
            assert self._error is not None
            trace, left = self._error.__traceback__, []
            while trace is not None:
                if strand.is_script_frame(trace.tb_frame):
                    left.append((trace.tb_frame, trace.tb_lineno or 0))
                trace = trace.tb_next
            living = {frame for frame, _ in left}
            found = [*reversed(left), *(item for item in found if item[0] not in living)]
        depth = len(found)
        return [CallFrame(strand, frame, line, depth - 1 - index) for index, (frame, line) in enumerate(found)]

    def _wait_of(self, strand: Strand, calls: list[CallFrame]) -> str:
        """Return what a thread waits for; of a lock its name, if a call has one, and its holder; else empty."""
        if self._is_failed(strand):
            return ""
        reason = state_of(strand).waits_for
        if strand.waits_for != A_LOCK or f"{A_LOCK} in " in reason:
            return reason
        reason = reason.replace(A_LOCK, self._lock_of(strand, calls), 1)
        holder = holder_awaited(strand)
        if holder is None:
            return reason
        if holder is strand:
            return f"{reason}, which it holds itself"
        return f"{reason}, held by {holder.name}" + (", which has ended" if holder.state is ENDED else "")

    def _lock_of(self, strand: Strand, calls: list[CallFrame]) -> str:
        """Return the lock that a thread waits for, by its name in the innermost call that has one."""
        for call in calls:
            for name, value in (*self.locals_of(call).items(), *self.globals_of(call).items()):
                if is_lock(value) and waits_at(strand, value):
                    return f"lock {name}"
        return A_LOCK

    def _is_failed(self, strand: Strand) -> bool:
        return self._error is not None and strand is self._host.scheduler.current

    def stack(self, thread: int) -> tuple[Frame, ...]:
        """See `DebugSession.stack`."""
        strand = self.strand(thread)
        calls = self.calls(strand)
        wait = self._wait_of(strand, calls)
        found = []
        for index, call in enumerate(calls):
            code = call.frame.f_code
            name = self._places.function_name(code.co_qualname)
            if index == 0 and wait:
                name = f"{name} (waits for {wait})"
            self._frames.append(call)
            place = self._places.at_line(code.co_filename, call.line)
            found.append(Frame(len(self._frames), thread, name, code.co_filename, *place))
        return tuple(found)

    def call(self, frame: int) -> CallFrame | None:
        """Return a call by the number of its frame; None for 0.

        Raises:
            DebugError: there is none of that number.
        """
        if frame == 0:
            return None
        if not 0 < frame <= len(self._frames) or self._frames[frame - 1] is None:
            raise DebugError("the run has gone on since this frame was shown")
        return self._frames[frame - 1]

    def call_at(self, thread: int, depth: int) -> CallFrame | None:
        """Return the call of a thread at a depth; None for thread 0."""
        if thread == 0:
            return None
        for call in self.calls(self.strand(thread)):
            if call.depth == depth:
                return call
        raise DebugError(f"thread {thread} has no call at depth {depth}")

    # ---------------------------------------------------------------- numbers that stay valid

    def handles(self) -> tuple[tuple[tuple[int, int], ...], tuple[Way, ...]]:
        """Return what the numbers of frames, as thread and depth, and of values stand for; for `show_again`."""
        places = tuple((0, 0) if call is None else (call.strand.order + 1, call.depth) for call in self._frames)
        return places, tuple(self._ways)

    def show_again(self, handles: tuple[tuple[tuple[int, int], ...], tuple[Way, ...]]) -> None:
        """Give the numbers of an earlier look at the same stop their meaning, with the values of now."""
        frames, ways = handles
        self._frames = [self._living_call(*place) for place in frames]
        for way in ways:
            parent, name, frame = way
            try:
                self._show_again(parent, name, frame)
            except DebugError:
                self._keep(way, (GONE, None, None, ""))

    def _living_call(self, thread: int, depth: int) -> CallFrame | None:
        try:
            return self.call_at(thread, depth)
        except DebugError:
            return None

    def _show_again(self, parent: int, name: str, frame: int) -> None:
        call = self.call(frame)
        if parent == SCOPE:
            self._keep((parent, name, frame), (name, self._group(name, call), call, ""))
        elif parent == RESULT:
            self._keep((parent, name, frame), ("", self.value(name, call), call, name))
        else:
            count = len(self._shown)
            self.child(parent, name, room=1)  # what it says is not shown
            if len(self._shown) == count:
                raise DebugError("it holds nothing any more")

    def _keep(self, way: Way, held: tuple[str, Any, CallFrame | None, str]) -> int:
        self._ways.append(way)
        self._shown.append(held)
        return len(self._shown)

    # ---------------------------------------------------------------- scopes

    def scopes(self, frame: int) -> tuple[Scope, ...]:
        """See `DebugSession.scopes`."""
        call = self.call(frame)
        found = []
        for name in (LOCALS, GLOBALS, ROBOT) if call is not None else (GLOBALS, ROBOT):
            group = self._group(name, call)
            found.append(Scope(name, self._keep((SCOPE, name, frame), (name, group, call, "")), len(group)))
        return tuple(found)

    def _group(self, name: str, call: CallFrame | None) -> Group:
        if name == LOCALS:
            return Group(self.locals_of(call))
        return Group(self.globals_of(call)) if name == GLOBALS else self.robot()

    def locals_of(self, call: CallFrame | None) -> dict[str, Any]:
        """Return the variables of a call, those of the functions around it that it uses included."""
        if call is None:
            return {}
        found = call.frame.f_locals
        return {name: found[name] for name in found if not name.startswith(("@", "."))}

    def globals_of(self, call: CallFrame | None) -> dict[str, Any]:
        """Return the program globals that hold data."""
        program = self._host.program
        if call is not None and (program is None or call.frame.f_globals is not program.globals.values):
            found = call.frame.f_globals
            own = {name: found[name] for name in found if not name.startswith(("__", "@"))}
        else:
            own = {} if program is None else program.globals.own()
        return {name: value for name, value in own.items() if is_shown(value)}

    def robot(self) -> Group:
        """Return what the robot shows."""
        controller = self._controller
        state, joints = controller.state(), controller.joints()
        signals = Group(controller.non_default_signals())
        motion = controller.motion
        return Group(
            {
                "t": state.time_s,
                "tick": state.tick,
                "tcp": Pose(state.tcp_pose_target),
                "joints": Joints(joints.q_target),
                "joint_speeds": Joints(joints.qd_target),
                "actual_tcp": Pose(state.tcp_pose_actual),
                "actual_joints": Joints(joints.q_actual),
                "tcp_speed": Pose(state.tcp_speed_target),
                "tcp_offset": Pose(state.tcp_offset),
                "payload": Group(
                    {"mass_kg": state.payload.mass_kg, "cog": state.payload.cog, "inertia": state.payload.inertia}
                ),
                "robot_mode": _word(state.robot_mode),
                "safety": _word(state.safety_mode),
                "task": _word(state.task_state),
                "speed": state.speed_scale,
                "moving": state.is_moving,
                "motion": _motion(motion.source),
                "next_motion": _motion(motion.next_move),
                SIGNALS_GROUP: signals,
            }
        )

    def variables(self, reference: int, kind: str = "", start: int = 0, count: int = 0) -> tuple[Variable, ...]:
        """See `DebugSession.variables`."""
        group, value, call, expression = self._held(reference)
        named, indexed = count_children(value)
        total = {"named": named, "indexed": indexed}.get(kind, named + indexed)
        start = min(start, total)
        if count:
            end = min(start + min(count, PART_MAX), total)
            is_cut = end < min(start + count, total)
        else:
            end = min(start + (PART_MAX if type(value) is Group else CHILDREN_MAX), total)
            is_cut = end < total
        room = room_of_each(end - start)
        found = [self._child(reference, group, child, call, expression, room) for child in children(value, start, end)]
        if is_cut:
            found.append(Variable(LEFT_OUT, more(total - end), ""))
        return tuple(found)

    def _held(self, reference: int) -> tuple[str, Any, CallFrame | None, str]:
        if not 0 < reference <= len(self._shown) or self._shown[reference - 1][0] == GONE:
            raise DebugError("the run has gone on since this value was shown")
        return self._shown[reference - 1]

    def _child(
        self, parent: int, group: str, child: Child, call: CallFrame | None, expression: str, room: int = TEXT_MAX
    ) -> Variable:
        name, value, path = child
        data_id, is_settable = "", False
        inner = ""
        if group in (LOCALS, GLOBALS):
            inner, is_settable = name, True
            data_id = name if group == GLOBALS else ""
        elif group == ROBOT:
            # A variable of the program by that name is what the name means.
            is_hidden = name in self.locals_of(call) or name in self.globals_of(call)
            inner = name if name in ROBOT_NAMES and not is_hidden else ""
            data_id = {"robot_mode": "robot mode", "safety": "safety"}.get(name, "")
        elif group == SIGNALS_GROUP:
            inner, is_settable, data_id = name, True, name
        elif expression and path:
            inner = expression + path
            is_settable = group != OF_ROBOT
        held = group if group == OF_ROBOT else ""
        if group == ROBOT:
            held = SIGNALS_GROUP if name == SIGNALS_GROUP else OF_ROBOT
        way = parent, name, 0
        return self.variable(
            name, value, call, inner, held, way=way, data_id=data_id, is_settable=is_settable, room=room
        )

    def variable(
        self,
        name: str,
        value: Any,
        call: CallFrame | None = None,
        expression: str = "",
        group: str = "",
        *,
        way: Way = NO_WAY,
        data_id: str = "",
        is_settable: bool = False,
        room: int = TEXT_MAX,
    ) -> Variable:
        """Return a value as it is shown; it can be expanded if it holds something."""
        named, indexed = count_children(value)
        reference = 0
        if named or indexed:
            reference = self._keep(way, (group, value, call, expression))
        text = f"{named} not at default" if group == SIGNALS_GROUP else shown(value, room)
        kind = type_name(value)
        return Variable(name, text, kind, reference, named, indexed, expression, data_id, is_settable)

    def expression_of(self, reference: int, name: str) -> tuple[str, CallFrame | None]:
        """Return the expression of a child, and the call in which it is one.

        Raises:
            DebugError: there is none.
        """
        shown_as = self.child(reference, name)
        if not shown_as.evaluate_name:
            raise DebugError(f"{name} cannot be named in an expression")
        if not shown_as.is_settable:
            raise DebugError(f"{name} is a value of the robot, which cannot be set")
        return shown_as.evaluate_name, self._held(reference)[2]

    def child(self, reference: int, name: str, room: int = TEXT_MAX) -> Variable:
        """Return the child of a scope or a value by its name, also where it is one of those that are left out.

        Args:
            reference: of the scope or value.
            name: of the child.
            room: characters that its text may have, about.

        Raises:
            DebugError: there is none.
        """
        group, value, call, expression = self._held(reference)
        child = child_named(value, name)
        if child is None:
            raise DebugError(f"there is no {short(name)!r} here")
        return self._child(reference, group, child, call, expression, room)

    # ---------------------------------------------------------------- expressions

    def value(self, text: str, call: CallFrame | None, steps_max: int = 0) -> Any:
        """Return the value of an expression, without any effect.

        Args:
            text: of the expression.
            call: whose variables it sees.
            steps_max: most nodes that it may take; 0 for as many as any expression.

        Raises:
            DebugError: it has none, or is refused.
        """
        names = Names(self._controller, self._host, self, call)
        value = computed(parsed(text), names.value, names.call, steps_max or self.steps_max)
        if isinstance(value, Indexed) and value.whole is not None:
            return value.whole
        if isinstance(value, Indexed | Pure):
            raise DebugError(f"{text.strip()} is a group: name one of it")
        return value

    def holds(self, condition: str, call: CallFrame | None) -> bool:
        """Return whether a condition is true; an empty one is.

        Raises:
            DebugError: it has no value, or is refused.
        """
        return not condition or truth(self.value(condition, call, self.condition_steps_max))


class Names:
    """Names of an expression: variables of a call, program globals, the robot, and functions without effect."""

    def __init__(self, controller: Controller, host: ScriptHost, look: Look, call: CallFrame | None) -> None:
        self._controller = controller
        self._host = host
        self._locals: Mapping[str, Any] = look.locals_of(call)
        program = host.program
        self._program: Program | None = program
        if call is not None:
            self._globals: Mapping[str, Any] = call.frame.f_globals
        else:
            self._globals = {} if program is None else program.globals.values

    def own(self, name: str) -> tuple[bool, Any]:
        """Return whether the program has a variable of that name, and its value."""
        for names in (self._locals, self._globals):
            if name in names and not name.startswith(("__", "@")):
                return True, names[name]
        return False, None

    def value(self, name: str) -> Any:
        """Return the value of a name.

        Raises:
            DebugError: there is none.
        """
        is_own, value = self.own(name)
        if is_own:
            return Pure(vars(value)) if type(value) is Facade and _name_of(value) in _PURE_MODULES else value
        if name in ROBOT_VALUES:
            return ROBOT_VALUES[name](self._controller)
        signal = SIGNALS.get(name)
        if signal is not None:
            if signal.size == 1:
                return self._controller.read(name, 0)
            return Indexed(lambda index: self._point(name, index))
        raise MissingName(name, self._known)

    def _known(self) -> set[str]:
        own = {name for name in (*self._locals, *self._globals) if not name.startswith(("__", "@"))}
        return own | ROBOT_VALUES.keys() | SIGNALS.keys()

    def _point(self, name: str, index: Any) -> Any:
        if type(index) is not int or not 0 <= index < SIGNALS[name].size:
            raise DebugError(f"{name} has indices 0 to {SIGNALS[name].size - 1}, not {shown(index)}")
        return self._controller.read(name, index)

    def call(self, name: str, arguments: tuple[Any, ...], named: dict[str, Any]) -> Any:
        """Call a function that only gives a value.

        Raises:
            DebugError: it is refused, or fails.
        """
        if self.own(name)[0]:
            raise Refusal(f"{name}() is a function of the program and may change something")
        context = None if self._program is None else self._program.context
        return predefined_call(context, name, arguments, named)


ROBOT_VALUES: Final[dict[str, Callable[[Controller], Any]]] = {
    "t": lambda controller: controller.state().time_s,
    "tick": lambda controller: controller.tick,
    "tcp": lambda controller: _whole("tcp", Pose(controller.poses().target)),
    "tcp_speed": lambda controller: hypot(*controller.tcp_speeds().target[:3]),
    "q": lambda controller: _whole("q", Joints(controller.joints().q_target)),
    "qd": lambda controller: _whole("qd", Joints(controller.joints().qd_target)),
    "joints": lambda controller: _whole("q", Joints(controller.joints().q_target)),
    "robot_mode": lambda controller: _word(controller.state().robot_mode),
    "safety": lambda controller: _word(controller.state().safety_mode),
}
"""Values of the robot by name: places (`values.places`), and what the debugger alone has."""


def _whole(place: str, values: tuple[float, ...]) -> Indexed:
    return Indexed(list(values).__getitem__, values, PLACES[place].elements)


def _motion(source: Any) -> str:
    """Return what moves the arm."""
    if source is None:
        return ""
    line = getattr(source, "line", 0)
    return f"{type(source).__name__.lower()} of line {line}" if line else type(source).__name__.lower()


def _word(value: Any) -> str:
    return str(getattr(value, "name", value)).lower().replace("_", " ")


def _name_of(facade: Facade) -> str:
    return repr(facade).split("'")[1]
