"""Streaming joint targets (manual 2.10 section 6.4.6; chapter 3.1 in manual 2.14)."""

from __future__ import annotations

from typing import Annotated

from elitescript.commands.quantities import JointPositions, Number, Optionally
from elitescript.commands.registry import command
from elitescript.errors import NotSimulatedError


@command(family="motion", manual="6.4.6", waits=True, works_in_sec=False, is_simulated=False)
def servoj(
    q: JointPositions,
    t: Annotated[float | None, Optionally(Number("s"), None)] = None,
    lookahead_time: Annotated[float, Number("s")] = 0.1,
    gain: Annotated[float, Number()] = 300,
) -> None:
    """Follow a stream of joint targets; each call takes the time `t`.

    Targets that arrive within the look-ahead time are averaged and joined by splines. Values outside the ranges
    below are brought into them, with one warning for each program; real clients send 0.3 s and a gain of 2000.

    Args:
        q: joint target of this period.
        t: control time of this target, at least one control period. Without it the default of the firmware counts:
            0.010 s up to 2.10, 0.004 s from 2.14.
        lookahead_time: window of the smoothing, 0.03 to 0.2 s; a smaller one follows faster, a larger one more
            smoothly.
        gain: how stiffly the arm follows, 100 to 2000; no effect up to firmware 2.10.
    """
    raise NotSimulatedError("streaming joint targets is not simulated yet")
