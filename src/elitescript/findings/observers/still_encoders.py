"""Finds conveyors that are tracked by an encoder that nothing feeds."""

from __future__ import annotations

from collections.abc import Iterable

from elitescript.findings.observing import Observer, found
from elitescript.messages.findings import Finding
from elitescript.messages.observations import EncoderStill
from elitescript.messages.timing import seconds


class StillEncoders(Observer):
    """Tells of each tracking that the arm stood."""

    __slots__ = ()

    def see(self, seen: EncoderStill) -> Iterable[Finding]:
        """Tell which encoder counts, if another one does."""
        text = (
            f"the arm has tracked encoder {seen.encoder} for {seconds(seen.duration_ticks):g} s, and that has never "
            "counted: the arm was not moved"
        )
        if seen.counting:
            hint = f"encoder {', '.join(map(str, seen.counting))} counts: name it in the call"
        else:
            hint = (
                f"encoder_enable_pulse_decode({seen.encoder}, ...) counts the pulses of a conveyor in the world, "
                "encoder_set_tick_count sets counts"
            )
        yield found("W291", text, line=seen.line, thread=seen.thread, hint=hint)
