"""Parts that come on a conveyor."""

from __future__ import annotations

from math import ceil
from typing import Final

from elitescript.devices.device import Device, check_number, check_text
from elitescript.devices.expressions import Expression
from elitescript.errors import UsageError
from elitescript.messages.signals import Value, parse_signal_name
from elitescript.messages.timing import TICKS_PER_S, ticks_for

PARTS_MAX: Final = 10_000
"""Parts on the belt at a time."""

_ROUNDING_TICKS: Final = 1e-6
_ROUNDING_M: Final = 1e-9


class Parts(Device):
    """A source of parts on a conveyor: a sensor sees them pass, the robot takes them, the others fall off the end.

    Places are distances along the belt from the source, to the front of a part. The belt moves as the encoder signal
    of `encoder_speed`; with `speed_m_s` it has a drive of its own, which sets that signal.

    Attributes:
        encoder: which of the two encoders.
        counts_per_m: quadrature counts of the encoder for each metre.
        speed_m_s: speed of the belt's own drive; 0 without one.
        runs_when: signal or expression that lets the drive run; always if empty.
        pitch_m: distance between two parts; or
        every_s: time between two parts.
        first_m: where the front of the first part is at the start, if there is a pitch.
        jitter_m: each part may lie up to this ahead of its place, drawn at random.
        count: how many there are; 0 for any number.
        length_m: of a part.
        sensor: input that is high while a part is at `sensor_m`.
        sensor_m: place of the sensor.
        end_m: where parts fall off.
        pick: output of the gripper: at its rising edge the part that is nearest to the middle between `pick_from_m`
            and `pick_to_m` is taken.
        pick_from_m: see there.
        pick_to_m: see there.
        picked: input that is high while the gripper holds a part.
        picked_after_s: how long the gripper takes to hold it, or to let go.
        released, taken, missed: how many parts have come, were taken, fell off.

    Raises:
        UsageError: settings that do not go together.

    Example:
        >>> from elitescript.testing.world import Parts, World
        >>> belt = Parts(counts_per_m=20000, speed_m_s=0.1, pitch_m=0.5, sensor="standard_digital_in[3]", sensor_m=0.8,
        ...              pick="standard_digital_out[0]", pick_from_m=0.9, pick_to_m=1.5)
        >>> world = World(devices=[belt])
    """

    encoder: int = 0
    counts_per_m: float = 0.0
    speed_m_s: float = 0.0
    runs_when: str = ""
    pitch_m: float = 0.0
    every_s: float = 0.0
    first_m: float = 0.0
    jitter_m: float = 0.0
    count: int = 0
    length_m: float = 0.05
    sensor: str = ""
    sensor_m: float = 0.0
    end_m: float = 2.0
    pick: str = ""
    pick_from_m: float = 0.0
    pick_to_m: float = 0.0
    picked: str = ""
    picked_after_s: float = 0.0

    _kept = ("released", "taken", "missed")
    released = 0
    taken = 0
    missed = 0

    def check(self) -> None:
        check_number("encoder", self.encoder, 0, 1, is_whole=True)
        check_number("counts_per_m", self.counts_per_m, 1e-3, 1e9, "1/m")
        check_number("speed_m_s", self.speed_m_s, 0.0, 100.0, "m/s")
        for key in ("pitch_m", "jitter_m", "length_m", "end_m", "first_m"):
            check_number(key, getattr(self, key), 0.0, 1e4, "m")
        for key in ("sensor_m", "pick_from_m", "pick_to_m"):
            check_number(key, getattr(self, key), 0.0, self.end_m, "m")
        check_number("every_s", self.every_s, 0.0, 1e6, "s")
        check_number("picked_after_s", self.picked_after_s, 0.0, 1e6, "s")
        check_number("count", self.count, 0, 1e9, is_whole=True)
        if (self.pitch_m > 0.0) is (self.every_s > 0.0):
            raise UsageError("pitch_m: give either pitch_m or every_s, the distance or the time between two parts")
        if 0.0 < self.pitch_m < max(self.length_m, self.end_m / PARTS_MAX) + self.jitter_m:
            raise UsageError(f"pitch_m: parts of {self.length_m:g} m would overlap, got {self.pitch_m:g} m")
        if self.every_s and ticks_for(self.every_s) < 1:
            raise UsageError(f"every_s: must be one control period at least, got {self.every_s!r}")
        for key in ("sensor", "pick", "picked"):
            check_text(key, getattr(self, key))
            if getattr(self, key):
                _check_digital(key, getattr(self, key))
        if self.pick and not self.pick_from_m < self.pick_to_m:
            raise UsageError("pick_to_m: must be beyond pick_from_m, so that there is a place to pick")
        if self.picked and not self.pick:
            raise UsageError("picked: goes with pick")
        if self.runs_when:
            if not self.speed_m_s:
                raise UsageError("runs_when: goes with speed_m_s")
            try:
                Expression(self.runs_when)
            except UsageError as error:
                raise UsageError(f"runs_when: {error}") from None

    # ---------------------------------------------------------------- where things are

    @property
    def fronts_m(self) -> tuple[float, ...]:
        """Where the parts on the belt are, the foremost first."""
        now = self._travelled_m(self._in_world().agenda.tick)
        return tuple(now - start for start in self._starts)

    def _travelled_m(self, tick: int) -> float:
        return self._base_m + self._rate * (tick - self._base_tick)

    # ---------------------------------------------------------------- time

    def started(self) -> None:
        self._starts: list[float] = []
        """For each part, what the belt had travelled when its front was at the source."""
        self._base_m, self._base_tick, self._rate = 0.0, 0, 0.0
        self._plan_number = 0
        self._due_m = -self.first_m
        self._shift_m = self._drawn_m()
        signal = f"encoder_speed[{self.encoder}]"
        self.cell.watch(signal, self._speed_changed)
        if self.pick:
            self.cell.watch(self.pick, self._pick_changed)
        if self.speed_m_s:
            runs = Expression(self.runs_when) if self.runs_when else None
            counts_s = self.speed_m_s * self.counts_per_m

            def drive(_value: Value = 0) -> None:
                self.cell.set(signal, counts_s if runs is None or runs.value(self.cell.read) else 0.0)

            for name in () if runs is None else runs.signals:
                self.cell.watch(name, drive)
            drive()
        self._speed_changed(self.cell.read(signal))
        if self.every_s:
            self._release_in_time()

    def _drawn_m(self) -> float:
        return self.random.random() * self.jitter_m if self.jitter_m else 0.0

    def _speed_changed(self, counts_s: Value) -> None:
        tick = self._in_world().agenda.tick
        self._base_m, self._base_tick = self._travelled_m(tick), tick
        if counts_s < 0:
            self.warn("the belt runs backwards; its parts stay where they are")
        self._rate = max(0.0, float(counts_s)) / self.counts_per_m / TICKS_PER_S
        self._look()

    def _look(self) -> None:
        """Release, see and drop what is due by now, and plan the next time."""
        tick = self._in_world().agenda.tick
        now_m = self._travelled_m(tick) + _ROUNDING_M
        while self.pitch_m and self._has_more and self._due_m - self._shift_m <= now_m:
            self._release(self._due_m - self._shift_m)
            self._due_m += self.pitch_m
            self._shift_m = self._drawn_m()
        while self._starts and now_m - self._starts[0] >= self.end_m:
            del self._starts[0]
            self.missed += 1
        if self.sensor:
            rear_m = self.sensor_m + self.length_m
            is_seen = any(self.sensor_m <= now_m - start < rear_m for start in self._starts)
            if bool(self.cell.read(self.sensor)) is not is_seen:
                self.cell.set(self.sensor, is_seen)
        self._plan(now_m)

    def _plan(self, now_m: float) -> None:
        self._plan_number += 1
        if self._rate <= 0.0:
            return
        due = [self._due_m - self._shift_m] if self.pitch_m and self._has_more else []
        for start in self._starts:
            places = (self.sensor_m, self.sensor_m + self.length_m, self.end_m) if self.sensor else (self.end_m,)
            due += [start + place for place in places if start + place > now_m]
        if not due:
            return
        agenda, number = self._in_world().agenda, self._plan_number
        at = self._base_tick + ceil((min(due) - self._base_m) / self._rate - _ROUNDING_TICKS)
        agenda.put(max(1, at - agenda.tick), lambda: self._look() if number == self._plan_number else None, self)

    @property
    def _has_more(self) -> bool:
        return not self.count or self.released < self.count

    def _release(self, start_m: float) -> None:
        if len(self._starts) < PARTS_MAX:
            self._starts.append(start_m)
        self.released += 1

    def _release_in_time(self) -> None:
        """Release a part every so many seconds, unless the one before still lies there."""
        now_m = self._travelled_m(self._in_world().agenda.tick)
        if not self._starts or now_m - self._starts[-1] >= self.length_m:
            self._release(now_m + self._drawn_m() * -1.0)
            self._look()
        if self._has_more:
            self.after(self.every_s, self._release_in_time)

    # ---------------------------------------------------------------- the gripper

    def _pick_changed(self, level: Value) -> None:
        if not level:
            if self.picked:
                self.cell.set(self.picked, False, self.picked_after_s)
            return
        now_m = self._travelled_m(self._in_world().agenda.tick)
        middle_m = (self.pick_from_m + self.pick_to_m) / 2
        reachable = [start for start in self._starts if self.pick_from_m <= now_m - start <= self.pick_to_m]
        if not reachable:
            return
        self._starts.remove(min(reachable, key=lambda start: abs(now_m - start - middle_m)))
        self.taken += 1
        if self.picked:
            self.cell.set(self.picked, True, self.picked_after_s)
        self._look()


def _check_digital(key: str, name: str) -> None:
    try:
        row, _ = parse_signal_name(name)
    except UsageError as error:
        raise UsageError(f"{key}: {error}") from None
    if row.kind != "bool":
        raise UsageError(f"{key}: {name} is no digital signal")
