"""Jogging and hand guiding: programs of the controller that go on only while a number in a register changes.

The controller's own program moves the arm, with `speedj` and `speedl`. It reads from RTSI input registers what to do,
and a number that the studio changes `BEATS_HZ` times a second. When that number has not changed for `QUIET_S`, for
whatever reason - the studio has ended, the network is gone, the program was paused - the program brakes the arm and
ends. Nothing has to arrive for the arm to stop.

    integer register N      the number that changes: the heartbeat
    integer register N + 1  what to do, with the number of the session, so that an old value moves nothing
    float registers N to N + 5  the speeds
    output integer register N   minus the heartbeat that the program has read last; the number of the session, once it
                                has ended for want of one
"""

from __future__ import annotations

import asyncio
import secrets
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, Final

from elitescript.client.connecting import LinkError
from elitescript.client.rtsi import rtsi_client
from elitescript.client.rtsi_messages import InputLayout
from elitescript.errors import PeerError, UsageError
from elitescript.messages.enums import TaskState

if TYPE_CHECKING:
    from elitescript.client.rtsi import RtsiClient

HOLD_S: Final = 0.2
"""Without a message of the page for this long, the arm stops."""
GUIDE_HOLD_S: Final = 2.0
"""The same for hand guiding: a page that is hidden repeats its messages once a second."""
BLIND_S: Final = 0.15
"""Without a picture of the controller for this long, the arm stops: nobody sees where it goes."""
GAP_S: Final = 0.5
"""Longest standstill, for want of messages or pictures, after which a button that is still held moves the arm again."""
QUIET_S: Final = 0.14
"""Without a heartbeat for this long, the controller's program stops the arm by itself."""
GUIDE_QUIET_S: Final = 1.0
"""The same while a person guides the arm, which holds it."""
BEATS_HZ: Final = 50.0
STEP_S: Final = 0.02
"""Period of the controller's program."""
START_S: Final = 2.0
"""Longest time for that program to start."""
TAP_S: Final = 0.3
"""After a stop, a program that has not been seen to run for this long has come and gone."""
LAPSE_S: Final = 0.3
"""Longest time for the reason why a program has ended to arrive."""
END_S: Final = 2.0
"""Longest time for which a program is told to end."""

JOINT_SPEED: Final = 0.5
"""Of one joint at full speed, rad/s."""
TCP_SPEED: Final = 0.25
"""Of the TCP, m/s; what standards allow beside people."""
TURN_SPEED: Final = 0.5
"""Of the TCP about an axis, rad/s."""
JOINT_ACCELERATION: Final = 4.0
TCP_ACCELERATION: Final = 2.0
BRAKING: Final = 8.0
"""Of joints when the program stops, rad/s^2."""
MARGIN: Final = 0.02
"""Distance to the end of a joint's range at which jogging stops, rad, beside the way that braking needs."""

STOP, JOINT, BASE, TOOL, HAND = range(5)
"""What to do."""
MODES: Final = {"joint": JOINT, "base": BASE, "tool": TOOL}
SESSION_STEP: Final = 8
_SESSIONS: Final = 2**24
_NUMBERS: Final = 2**31
"""Of heartbeats."""

PROGRAM_NAME: Final = "studio_jog"

_LOOP: Final = """def {name}():
    import time
    beat = read_input_integer_register({register})
    heard = time.monotonic()
    late = 0.0
    while late < {quiet:g}:
        task = read_input_integer_register({task_register}) - {session}
        speed = [{speeds}]
{body}
        now = read_input_integer_register({register})
        late = time.monotonic() - heard
        if now != beat and late < {quiet:g}:
            beat = now
            heard = heard + late
            write_output_integer_register({register}, -beat)
{after}
    if late >= {quiet:g}:
        write_output_integer_register({register}, {session})
end
"""

_JOG: Final = """        if task == {JOINT}:
            speedj(speed, {a_joint:g}, {step:g})
        elif task == {BASE}:
            speedl(speed, {a_tcp:g}, {step:g}, {a_joint:g})
        elif task == {TOOL}:
            tool = get_actual_tcp_pose()
            turn = [0, 0, 0, tool[3], tool[4], tool[5]]
            along = pose_trans(turn, [speed[0], speed[1], speed[2], 0, 0, 0])
            about = pose_trans(turn, [speed[3], speed[4], speed[5], 0, 0, 0])
            speedl([along[0], along[1], along[2], about[0], about[1], about[2]], {a_tcp:g}, {step:g}, {a_joint:g})
        elif task == {STOP}:
            break
        else:
            sleep({step:g})"""

_GUIDE: Final = """        if task == {STOP}:
            break
        sleep({step:g})"""


def jog_program(register: int, session: int) -> str:
    """Return the program that moves the arm as registers say.

    Args:
        register: first of the registers.
        session: a multiple of `SESSION_STEP`; register N + 1 holds it plus what to do.
    """
    return _program(register, session, _JOG, f"    stopj({BRAKING:g})", QUIET_S)


def guide_program(register: int, session: int) -> str:
    """Return the program that lets a person guide the arm by hand; arguments as of `jog_program`."""
    text = _program(register, session, _GUIDE, "    end_freedrive_mode()", GUIDE_QUIET_S)
    return text.replace("    late = 0.0\n", "    late = 0.0\n    freedrive_mode()\n", 1)


def _program(register: int, session: int, body: str, after: str, quiet_s: float) -> str:
    return _LOOP.format(
        name=PROGRAM_NAME,
        register=register,
        task_register=register + 1,
        session=session,
        quiet=quiet_s,
        speeds=", ".join(f"read_input_float_register({register + axis})" for axis in range(6)),
        after=after,
        body=body.format(
            JOINT=JOINT,
            BASE=BASE,
            TOOL=TOOL,
            STOP=STOP,
            step=STEP_S,
            a_joint=JOINT_ACCELERATION,
            a_tcp=TCP_ACCELERATION,
        ),
    )


def input_names(register: int) -> tuple[str, ...]:
    """Return the RTSI inputs that are written: heartbeat, what to do, six speeds."""
    whole = (f"input_int_register{register}", f"input_int_register{register + 1}")
    return (*whole, *(f"input_double_register{register + axis}" for axis in range(6)))


def speeds_of(frame: str, axis: int, direction: int, speed: float) -> tuple[float, ...]:
    """Return the six speeds of a jog: of joints, or of the TCP.

    Args:
        frame: a key of `MODES`.
        axis: 0 to 5.
        direction: 1 or -1.
        speed: fraction of the highest one, 0 to 1.
    """
    highest = JOINT_SPEED if frame == "joint" else TCP_SPEED if axis < 3 else TURN_SPEED
    return tuple(direction * speed * highest if index == axis else 0.0 for index in range(6))


def end_of_range(
    joints: Sequence[float], speeds: Sequence[float], lowest: Sequence[float], highest: Sequence[float]
) -> int:
    """Return which joint, from 1, could not stop within its range if it went on for a while; 0 for none."""
    for number, (q, speed, low, high) in enumerate(zip(joints, speeds, lowest, highest, strict=True), 1):
        way = abs(speed) * (2 / BEATS_HZ + QUIET_S) + speed * speed / (2 * JOINT_ACCELERATION) + MARGIN
        if (speed > 0 and q + way > high) or (speed < 0 and q - way < low):
            return number
    return 0


class Jogger:
    """Moves the arm for one page at a time.

    Args:
        host: of the controller.
        rtsi_port: its RTSI port.
        register: first of the registers.
        send: sends a program to the controller.
        halt: ends the program of the controller.
        task_state: returns the present state of the task.
        joint_at_end: returns which joint is too near to the end of its range for these speeds of joints; 0 for none.
        picture_age_s: returns how long ago the last picture of the controller came, s.
        answer: returns what is in the controller's output register.
        ended: takes that the arm was stopped for another reason than `release`, in words, with the page that moved it.
    """

    __slots__ = (
        "_answer",
        "_ended",
        "_halt",
        "_held_until",
        "_host",
        "_is_stopping",
        "_joint_at_end",
        "_picture_age_s",
        "_port",
        "_register",
        "_running",
        "_send",
        "_speeds",
        "_task",
        "_task_state",
        "owner",
    )

    def __init__(
        self,
        host: str,
        rtsi_port: int,
        register: int,
        *,
        send: Callable[[str], Any],
        halt: Callable[[], Any],
        task_state: Callable[[], TaskState],
        joint_at_end: Callable[[Sequence[float]], int],
        picture_age_s: Callable[[], float],
        answer: Callable[[], object],
        ended: Callable[[object, str], None],
    ) -> None:
        self._host = host
        self._port = rtsi_port
        self._register = register
        self._send = send
        self._task_state = task_state
        self._joint_at_end = joint_at_end
        self._halt = halt
        self._picture_age_s = picture_age_s
        self._answer = answer
        self._ended = ended
        self._running: asyncio.Task[None] | None = None
        self._task = STOP
        self._is_stopping = False
        """Whether the program was told to end; it is not told anything else then."""
        self._speeds: tuple[float, ...] = (0.0,) * 6
        self._held_until = 0.0
        self.owner: object | None = None
        """The page that moves the arm; None if none does."""

    @property
    def is_active(self) -> bool:
        """Whether a program of ours may be running."""
        return self._running is not None and not self._running.done()

    def jog(self, owner: object, frame: str, axis: int, direction: int, speed: float) -> None:
        """Move, for `HOLD_S`.

        Raises:
            UsageError: another page moves the arm; or a joint is at the end of its range.
        """
        self._take(owner, HAND)
        speeds = speeds_of(frame, axis, direction, speed)
        if frame == "joint" and (number := self._joint_at_end(speeds)):
            self.release(owner)
            raise UsageError(f"joint {number} is at the end of its range")
        self._begin(owner, MODES[frame], speeds, jog_program, HOLD_S)

    def guide(self, owner: object) -> None:
        """Let a person guide the arm, until `release`, or for `GUIDE_HOLD_S` after the last `keep_guiding`.

        Raises:
            UsageError: another page moves the arm, or this one jogs.
        """
        self._take(owner, JOINT, BASE, TOOL)
        self._begin(owner, HAND, (0.0,) * 6, guide_program, GUIDE_HOLD_S)

    def keep_guiding(self, owner: object) -> None:
        """Let hand guiding go on, if it is on for this page."""
        if self.is_active and self.owner is owner and self._task == HAND:
            self._held_until = asyncio.get_running_loop().time() + GUIDE_HOLD_S

    def release(self, owner: object) -> None:
        """Stop, if this page moves the arm; returns at once."""
        if self.owner is owner:
            self._end()

    def release_jog(self, owner: object) -> None:
        """Stop as `release`, but leave hand guiding on: a jog that it refuses ends as any other does."""
        if self._task != HAND:
            self.release(owner)

    async def close(self) -> None:
        """Stop, and wait for the end."""
        self._end()
        if self._running is not None:
            await asyncio.wait([self._running])

    def _end(self) -> None:
        self._task, self._is_stopping = STOP, True

    def _take(self, owner: object, *others: int) -> None:
        if not self.is_active:
            return
        if self.owner is not owner:
            raise UsageError("another page moves the arm")
        if self._task in others:
            raise UsageError("hand guiding is on; end it first" if HAND in others else "the arm is being jogged")

    def _begin(
        self, owner: object, task: int, speeds: tuple[float, ...], program: Callable[[int, int], str], hold_s: float
    ) -> None:
        if self.is_active and self._is_stopping:
            # The page asks again in a moment; then the program of before has ended.
            return
        self._held_until = asyncio.get_running_loop().time() + hold_s
        self._task, self._speeds = task, speeds
        if not self.is_active:
            self.owner, self._is_stopping = owner, False
            self._running = asyncio.create_task(self._run(program, owner))

    async def _run(self, program: Callable[[int, int], str], owner: object) -> None:
        try:
            async with rtsi_client(self._host, self._port, may_command=True) as client:
                await client.negotiate()
                layout = await client.set_up_inputs(input_names(self._register))
                await client.start()
                try:
                    await self._drive(client, layout, program)
                finally:
                    client.write(layout, dict.fromkeys(layout.names, 0))
        except (LinkError, PeerError, UsageError) as error:
            what = "Hand guiding" if program is guide_program else "Jogging"
            self._ended(owner, f"{what} has ended: {error}")
        finally:
            self._end()
            self.owner = None

    async def _drive(self, client: RtsiClient, layout: InputLayout, program: Callable[[int, int], str]) -> None:
        loop = asyncio.get_running_loop()
        session = (1 + secrets.randbelow(_SESSIONS)) * SESSION_STEP
        start = loop.time()
        if self._is_stopping or start > self._held_until:
            # A touch that was over before the connection was there.
            return
        self._beat(client, layout, session)
        await self._send(program(self._register, session))
        has_run, stopped_at, answered_at = False, 0.0, None
        while True:
            await asyncio.sleep(1.0 / BEATS_HZ)
            now = loop.time()
            is_running = self._task_state() is not TaskState.STOPPED
            has_run = has_run or is_running
            if self._has_answered():
                answered_at = now
            if has_run and self._task_state() is TaskState.PAUSED:
                # Whatever lets it go on later is not to move the arm.
                await self._halt()
                raise UsageError("the controller has paused the program that moves the arm; it is ended")
            if not self._is_stopping:
                self._check_hearing(now, answered_at)
            if has_run and not is_running:
                if not self._is_stopping:
                    self._check_end(await self._has_lapsed(session))
                break
            if not has_run and now - start > START_S:
                if not self._is_stopping:
                    raise UsageError("the controller does not start the program that moves the arm")
                break
            if now > self._held_until and not self._is_stopping:
                if self._task == HAND:
                    self._ended(
                        self.owner, f"Hand guiding has ended: nothing was heard of the page for {GUIDE_HOLD_S:g} s."
                    )
                self._end()
            if self._task == JOINT and (number := self._joint_at_end(self._speeds)):
                self._end()
                self._ended(self.owner, f"Joint {number} is at the end of its range.")
            if self._is_stopping:
                stopped_at = stopped_at or now
                if not is_running and now - stopped_at > TAP_S:
                    break
                if now - stopped_at > END_S:
                    # Whatever runs there now is not ours: that ends without a heartbeat.
                    return
            self._beat(client, layout, session)

    def _check_end(self, has_lapsed: bool) -> None:
        """Refuse to begin again by itself, unless heartbeats came too late for a button that is still held.

        Raises:
            UsageError: says why the program has ended.
        """
        if not has_lapsed:
            raise UsageError("the controller has ended the program; its messages say why")
        if self._task == HAND:
            raise UsageError(f"nothing was heard of the studio for {GUIDE_QUIET_S:g} s")

    async def _has_lapsed(self, session: int) -> bool:
        """Return whether heartbeats came too late: where the network or a computer is slow, the page may go on."""
        end = asyncio.get_running_loop().time() + LAPSE_S
        while self._answer() != session and asyncio.get_running_loop().time() < end:
            await asyncio.sleep(1.0 / BEATS_HZ)
        return self._answer() == session

    def _has_answered(self) -> bool:
        """Return whether the program has read one of the newest heartbeats."""
        answer = self._answer()
        return isinstance(answer, int) and answer < 0 and (_number() + answer) % _NUMBERS < GAP_S * 1000

    def _check_hearing(self, now: float, answered_at: float | None) -> None:
        """Refuse to go on without pictures, or without answers once there were some: an older controller has none.

        Raises:
            UsageError: says what is missing.
        """
        longest_s = GUIDE_QUIET_S if self._task == HAND else GAP_S
        if self._picture_age_s() > longest_s:
            raise UsageError(f"nothing was heard of the controller for {longest_s:g} s")
        if answered_at is not None and now - answered_at > longest_s:
            raise UsageError("its program at the controller does not answer; another may have taken its place")

    def _beat(self, client: RtsiClient, layout: InputLayout, session: int) -> None:
        beat, task, *speeds = layout.names
        moves = self._task != STOP and self._picture_age_s() < BLIND_S
        values = dict(zip(speeds, self._speeds if moves else (0.0,) * 6, strict=True))
        client.write(layout, {beat: _number(), task: session + self._task, **values})


def _number() -> int:
    """Return the heartbeat of this moment."""
    return int(asyncio.get_running_loop().time() * 1000) % _NUMBERS
