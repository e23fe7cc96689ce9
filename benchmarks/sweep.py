"""Many runs of one program: what one costs, and how much of the processors a sweep uses; beside each what a user would
otherwise write: a loop of `VirtualRobot(...).run(text)`, and that loop in a `ProcessPoolExecutor`.

The program is `examples/pick_and_place.script` with one part: 10 s of robot time. Rates are by the wall clock, so they
are worth something on a computer that does nothing else; the CPU of the parent is what stands between a sweep and all
of its processors.
"""

from __future__ import annotations

import os
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from time import perf_counter, process_time

from benchmarks.measure import ROOT, best_of_calls
from benchmarks.table import Row, Time, print_rows, timed_row
from elitescript.environment.process import cores
from elitescript.robot import VirtualRobot
from elitescript.sweep.engines.local import LocalEngine
from elitescript.sweep.plans.plan import Plan
from elitescript.sweep.plans.variations import parse_variation
from elitescript.sweep.single import Runner

RUNS = int(os.environ.get("SWEEP_RUNS", "1500"))
TEXT = (ROOT / "examples" / "pick_and_place.script").read_text(encoding="utf-8").replace("PARTS = 20", "PARTS = 1")
SHORT = 'def p():\n  pause_s = 0.1\n  sleep(pause_s)\n  textmsg("done")\nend\n'
CHUNK = 50


def naive(seed: int) -> tuple[str, float]:
    """Run the program as it is written in a loop."""
    run = VirtualRobot("CS66", seed=seed).run(TEXT)
    return run.state, run.time_s


def plan_of(
    *ensure: str, text: str = TEXT, vary: str = "CLEARANCE=uniform(0.1,0.14)", step_s: float | None = None
) -> Plan:
    """Return a plan with one variation."""
    return Plan(text, variations=(parse_variation(vary),), ensure=ensure, step_s=step_s)


def one_run(plan: Plan) -> Time:
    """Return the best time of one run of a plan in this process."""
    runner = Runner(plan)
    return best_of_calls(lambda: runner.run(runner.choices_of(7)), runs=5, run_s=0.2)


def rate(jobs: int) -> tuple[float, float]:
    """Return runs of a sweep for each second of wall time, and CPU of the parent for each run, s."""
    with LocalEngine(jobs) as engine:
        pieces = engine.rows(plan_of(), [range(RUNS)])
        # The processes have begun when the first rows are there.
        began, cpu, before = perf_counter(), process_time(), len(next(pieces))
        done = sum(map(len, pieces))
        wall_s, cpu_s = perf_counter() - began, process_time() - cpu
    assert before + done == RUNS
    return done / wall_s, cpu_s / done


def pool_rate(jobs: int) -> float:
    """Return the same of a pool of processes of the standard library."""
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
        list(pool.map(naive, range(2 * jobs)))
        began = perf_counter()
        list(pool.map(naive, range(RUNS), chunksize=CHUNK))
        return RUNS / (perf_counter() - began)


def rows() -> list[Row]:
    """Return the table."""
    loop = best_of_calls(lambda: naive(7), runs=5, run_s=0.2)
    many = cores()
    single, parent_s = rate(1)
    together, _ = rate(many)
    beside = "loop of VirtualRobot().run"
    return [
        timed_row("a run of 10 s", one_run(plan_of()), other=loop.cpu_s, beside=beside),
        timed_row("with a property of the arm, each 40 ms", one_run(plan_of("max_of(tcp_speed) < 2", step_s=0.04))),
        timed_row("with a property of the arm, each tick", one_run(plan_of("max_of(tcp_speed) < 2"))),
        timed_row("a run of 0.1 s", one_run(plan_of(text=SHORT, vary="pause_s=uniform(0,0.2)"))),
        Row("CPU of the parent for each run", "us", value=parent_s * 1e6),
        Row("a sweep with one process", "runs/s", value=single),
        Row(f"a sweep with {many}", "runs/s", value=together, other=pool_rate(many), beside="ProcessPoolExecutor"),
        Row(f"{many} processes of {many} times one", "%", value=100 * together / (many * single)),
    ]


if __name__ == "__main__":
    print_rows(rows())
