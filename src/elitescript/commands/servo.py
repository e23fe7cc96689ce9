"""Streaming joint targets (manual 2.10 section 6.4.6; chapter 3.1 in manual 2.14)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Final

from elitescript.commands.definition.quantities import JointPositions, Number, Optionally
from elitescript.commands.definition.registry import command
from elitescript.messages.motion import ServoJ
from elitescript.messages.timing import PERIOD_S
from elitescript.said import said

if TYPE_CHECKING:
    from elitescript.commands.definition.context import Robot

LOOKAHEAD_S: Final = (0.03, 0.2)
GAIN: Final = (100.0, 2000.0)
_STANDARD_GAIN: Final = 300.0


@command(family="motion", manual="6.4.6", waits=True, works_in_sec=False)
def servoj(
    robot: Robot,
    q: JointPositions,
    t: Annotated[float | None, Optionally(Number("s"), None)] = None,
    lookahead_time: Annotated[float, Number("s")] = 0.1,
    gain: Annotated[float, Number()] = 300,
) -> None:
    """Follow a stream of joint targets; each call takes the time `t`.

    The stream is averaged over the look-ahead time, and the arm follows the mean; how, is *assumed*. When targets
    stop coming, the arm comes to rest at the last one. A stream may begin while the arm moves; a stop command ends
    it. In front of the end of a joint's range the arm brakes with a warning, and the stream may go on (*assumed*). The
    speed percentage does not count (*assumed*). While the arm has no power or its brakes are engaged, a call returns
    after its time with one warning and nothing moves (*assumed*), so that a driver may start before power-on.
    Values outside the ranges below are brought into them, with one warning for each program; real clients send 0.3 s
    and a gain of 2000.

    Args:
        q: joint target of this period.
        t: control time of this target, at least one control period. Without it the default of the firmware counts:
            0.010 s up to 2.10, 0.004 s from 2.14. A shorter one than that is used, with one warning for each program.
        lookahead_time: window of the smoothing, 0.03 to 0.2 s; a smaller one follows faster, a larger one more
            smoothly.
        gain: how stiffly the arm follows, 100 to 2000; no effect up to firmware 2.10.

    Raises:
        MotionError: the target is outside the joint limits.
        ScriptStateError: a stop of the safety system keeps the arm from moving.
    """
    profile = robot.profile
    t_s = _limited(robot, "t", profile.servoj_t_s if t is None else t, PERIOD_S, None, "s")
    lookahead_s = _limited(robot, "lookahead_time", lookahead_time, *LOOKAHEAD_S, "s")
    if t_s < profile.servoj_t_s:
        robot.warn_once(
            "servoj period",
            said(
                "servoj: t is {t_s:g} s; firmware {profile} documents {servoj_t_s:g} s, and what the "
                "real robot does with a shorter one is not known",
                t_s=t_s,
                profile=profile.name,
                servoj_t_s=profile.servoj_t_s,
            ),
        )
    used_gain = _limited(robot, "gain", gain, *GAIN, "") if profile.is_servoj_gain_used else _STANDARD_GAIN
    robot.move(ServoJ(q, t_s, lookahead_s, used_gain))


def _limited(robot: Robot, name: str, value: float, low: float, high: float | None, unit: str) -> float:
    used = max(value, low) if high is None else min(max(value, low), high)
    if used != value:
        bounds = f">= {low:g}" if high is None else f"in [{low:g}, {high:g}]"
        robot.warn_once(
            f"servoj {name}",
            said(
                "servoj: {name} must be {bounds}, got {value:g}; {used:g} is used",
                name=name,
                bounds=f"{bounds} {unit}".rstrip(),
                value=value,
                used=used,
            ),
        )
    return used
