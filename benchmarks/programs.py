"""Whole programs: from process start to exit, and simulated time per wall time."""

from __future__ import annotations

import gc
import subprocess
import sys
import tempfile
import tracemalloc
from pathlib import Path

from benchmarks.measure import ROOT, best_of_calls, environment, middle, process_times, time_of
from benchmarks.table import Row, Time, timed_row

RUNS = 10
VERBS = {"run": "start to exit, one-line program", "check": "check of a one-line program"}
PICK_AND_PLACE = ROOT / "examples" / "pick_and_place.script"
BELT_PICKING = ROOT / "examples" / "belt_picking.script"
BELT_COUNTS_PER_S = 2000.0
TRACKING_S = 60.0
TRACKING = f"""
def tracking():
  track_conveyor_linear([0, 1, 0, 0, 0, 0], 2000000)
  sleep({TRACKING_S})
  stop_conveyor_tracking()
end
"""
"""One minute of nothing but going along with a belt that creeps."""
EVENT_HOURS = 8
TWO_MOVES = """
def two_moves():
  while True:
    movej([0.4, -1.4, -1.7, -1.6, 1.57, 0], a=1.4, v=1.05)
    movej([-0.4, -1.4, -1.7, -1.6, 1.57, 0], a=1.4, v=1.05)
    sleep(1)
  end
end
"""
POLLING_S = 20.0
POLLING = """
def polling():
  global n
  n = 0
  def poll():
    global n
    while True:
      n = n + 1
{body}
      sync()
    end
  end
  start_thread(poll, ())
{main}
end
"""
"""A thread that does something in every tick, beside a main thread that waits or moves."""
LOOPED = """
def job():
  movej([0.3, -1.4, -1.7, -1.6, 1.57, 0], a=1.4, v=1.05)
  set_standard_digital_out(0, True)
  sleep(8.5)
  textmsg("the arm is at ", get_actual_tcp_pose())
end
"""
_SLEEPING = f"  sleep({POLLING_S})"
_MOVING = """
  for i in range(5):
    movej([0.4, -1.4, -1.7, -1.6, 1.57, 0], a=1.4, v=1.05)
    movej([-0.4, -1.4, -1.7, -1.6, 1.57, 0], a=1.4, v=1.05)
  end"""


def _start_rows() -> list[Row]:
    with tempfile.TemporaryDirectory() as folder:
        program = Path(folder) / "hello.script"
        program.write_text('textmsg("hello")\n')
        commands = [[sys.executable, "-m", "elitescript", verb, str(program)] for verb in VERBS]
        empty, *times = process_times([[sys.executable, "-c", "pass"], *commands], RUNS)
    return [
        timed_row(what, time, other=empty.cpu_s, beside="python -c pass")
        for what, time in zip(VERBS.values(), times, strict=True)
    ]


def _loop_rows() -> list[Row]:
    """Runs of one text on new robots, as tests and loops make them: compiled once, and compiled each time."""
    from elitescript import VirtualRobot
    from elitescript.language import compiler
    from elitescript.language.kept_units import KeptUnits

    def compiled_each_time() -> None:
        compiler.KEPT = KeptUnits(0)
        VirtualRobot("CS66").run(LOOPED)

    def run() -> None:
        VirtualRobot("CS66").run(LOOPED)

    kept = compiler.KEPT
    try:
        each = best_of_calls(compiled_each_time)
    finally:
        compiler.KEPT = kept
    return [
        timed_row(
            "a run of 10 s on a new robot, the same text again",
            best_of_calls(run),
            other=each.cpu_s,
            beside="compiled each time",
        )
    ]


def _free_run_rows() -> list[Row]:
    from elitescript import PlantConfig, VirtualRobot

    rows = []
    for what, program, has_trace in (
        ("pick and place, free run", PICK_AND_PLACE, False),
        ("the same with a trace row every 4 ms", PICK_AND_PLACE, True),
        ("picking from a moving belt", BELT_PICKING, False),
        ("one minute on a moving belt", TRACKING, False),
        ("pick and place with a lag of the joints", PICK_AND_PLACE, False),
    ):
        times = []
        simulated_s = 0.0
        for _ in range(RUNS):
            robot = VirtualRobot("CS66", plant=PlantConfig(lag_s=0.03) if "lag" in what else None)
            robot.signals["encoder_speed[0]"] = BELT_COUNTS_PER_S
            times.append(time_of(lambda: robot.run(program, trace=has_trace).check()))  # noqa: B023
            simulated_s = robot.time_s
        rows.append(timed_row(what, middle(times), simulated_s=simulated_s))
    return rows


def _polling_rows() -> list[Row]:
    """Programs with a thread that polls: time of each run, by the time of the robot."""
    from elitescript import VirtualRobot

    same, changed = (
        "\n".join(
            f"      write_output_float_register({index}, {value} * 0.5)\n"
            f"      write_output_integer_register({index}, {value})"
            for index in range(7)
        )
        for value in ("3", "n")
    )
    rows = []
    for what, body, main in (
        ("a thread that only waits for the next tick", "", _SLEEPING),
        ("a thread that reads an input in every tick", "      x = get_standard_digital_in(0)", _SLEEPING),
        ("an input read in every tick, beside moves", "      x = get_standard_digital_in(0)", _MOVING),
        ("a thread with 14 unchanged writes in every tick", same, _SLEEPING),
        ("14 unchanged writes in every tick, beside moves", same, _MOVING),
        ("a thread with 14 changes in every tick", changed, _SLEEPING),
    ):
        times = []
        simulated_s = 0.0
        for _ in range(RUNS):
            robot = VirtualRobot("CS66")
            program = robot.compile(POLLING.format(body=body, main=main))
            times.append(time_of(lambda: robot.run(program).check()))  # noqa: B023
            simulated_s = robot.time_s
        rows.append(timed_row(what, middle(times), simulated_s=simulated_s))
    return rows


def _trace_memory_rows() -> list[Row]:
    """What the rows of pick and place take, with those of the resting arm."""
    from elitescript import VirtualRobot

    def kept_by_a_run(*, has_trace: bool) -> tuple[int, int]:
        """Bytes and rows."""
        tracemalloc.start()
        run = VirtualRobot("CS66").run(PICK_AND_PLACE, trace=has_trace)
        gc.collect()
        kept = tracemalloc.get_traced_memory()[0]
        tracemalloc.stop()
        return kept, len(run.trace)

    VirtualRobot("CS66").run(PICK_AND_PLACE, trace=True)
    (with_rows, count), (without, _) = kept_by_a_run(has_trace=True), kept_by_a_run(has_trace=False)
    row = (with_rows - without) / count
    numbers = 8 * 13
    return [
        Row("memory of a trace row", words=f"{row:.0f} B", beside=f"{numbers} B (its time, six joints and speeds)"),
        Row("memory of an hour of trace rows", "MiB", value=row * 900_000 / 2**20),
        _event_memory_row(),
    ]


def _event_memory_row() -> Row:
    """What the events of an hour of two moves and a pause take, from eight hours of them."""
    from elitescript import VirtualRobot

    tracemalloc.start()
    run = VirtualRobot("CS66").run(TWO_MOVES, until_s=EVENT_HOURS * 3600.0)
    gc.collect()
    kept = tracemalloc.get_traced_memory()[0]
    tracemalloc.stop()
    words = f"{len(run.record.raw())} kept, {run.events_dropped} gone, in {EVENT_HOURS} h"
    return Row("memory of the events of an hour", "MiB", value=kept / 2**20 / EVENT_HOURS, words=words)


def _day_rows() -> list[Row]:
    """Twenty-four hours of pick and place: the memory after the first hour and at the end, each in its own process."""
    rows = []
    for what, plant in (("24 h of pick and place", ""), ("1 h of it with a lag of 20 ms", "lag")):
        hours = 1 if plant else 24
        command = [sys.executable, "-m", "benchmarks.day", str(hours), *filter(None, [plant])]
        result = subprocess.run(command, check=True, capture_output=True, text=True, env=environment(), cwd=ROOT)
        wall_s, cpu_s, first, half, last = map(float, result.stdout.split())
        rows.append(timed_row(what, Time(wall_s, cpu_s), "s", simulated_s=hours * 3600.0))
        words = f"at the end; {first:.0f} after a 24th, {half:.0f} after a half"
        rows.append(Row(f"{what}: memory", "MB", value=last, words=words))
    return rows


def rows() -> list[Row]:
    """Starts, programs and days."""
    return _start_rows() + _loop_rows() + _free_run_rows() + _trace_memory_rows() + _polling_rows() + _day_rows()
