"""Finds conveyors that are tracked by an encoder that nothing feeds."""

from __future__ import annotations

from collections.abc import Iterable

from elitescript.findings.observing import Observer, found
from elitescript.messages.findings import Finding
from elitescript.messages.observations import EncoderStill
from elitescript.messages.timing import seconds
from elitescript.said import said


class StillEncoders(Observer):
    """Tells of each tracking that the arm stood."""

    __slots__ = ()

    def see(self, seen: EncoderStill) -> Iterable[Finding]:
        """Tell which encoder counts, if another one does."""
        text = said(
            "the arm has tracked encoder {encoder} for {duration_s:g} s, and that has never counted: "
            "the arm was not moved",
            encoder=seen.encoder,
            duration_s=seconds(seen.duration_ticks),
        )
        if seen.counting:
            hint = said("encoder {counting} counts: name it in the call", counting=", ".join(map(str, seen.counting)))
        else:
            hint = said(
                "encoder_enable_pulse_decode({encoder}, ...) counts the pulses of a conveyor in the "
                "world, encoder_set_tick_count sets counts",
                encoder=seen.encoder,
            )
        yield found("W291", text, line=seen.line, thread=seen.thread, hint=hint)
