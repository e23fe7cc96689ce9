"""What a Dask cluster costs beside processes of this computer: the same runs by both engines, in turn."""

from __future__ import annotations

import os
from collections.abc import Callable
from importlib.util import find_spec
from time import perf_counter
from typing import Any

from benchmarks.measure import least
from benchmarks.table import Row, Time, timed_row
from elitescript.sweep.engines import cluster_worker
from elitescript.sweep.engines.cluster import Cluster, ClusterEngine
from elitescript.sweep.engines.cluster_worker import work_bytes
from elitescript.sweep.engines.engine import Engine
from elitescript.sweep.engines.local import LocalEngine
from elitescript.sweep.plans.plan import Plan, Variation
from elitescript.sweep.plans.plan_json import plan_data, row_data

RUNS = 600
ORDERS = 1000
ROUNDS = 2
JOBS = 2
PROGRAM = """\
def cell():
  SPEED = 1.0
  HOME = [0, -1.57, -1.57, -1.57, 1.57, 0]
  movej(HOME)
  i = 0
  while i < 2:
    movej([0.4, -1.4, -1.5, -1.7, 1.5, 0.2], a=3, v=SPEED)
    set_standard_digital_out(0, True)
    sleep(0.3)
    movel(pose_trans(get_actual_tcp_pose(), [0, 0, 0.1, 0, 0, 0]), a=1, v=0.3)
    movej(HOME, a=3, v=SPEED)
    set_standard_digital_out(0, False)
    sleep(0.3)
    i = i + 1
  end
end
"""
PLAN = Plan(PROGRAM, variations=(Variation("SPEED", "uniform", (0.5, 2.0)),), seed=1)


def rows() -> list[Row]:
    """Each engine's time of a run with all processes, and what a task and a row cost."""
    if not find_spec("distributed"):
        return []
    from distributed import LocalCluster

    ours, theirs, tasks = [], [], []
    with LocalCluster(
        n_workers=1, threads_per_worker=JOBS, processes=False, protocol="tcp", host="127.0.0.1", dashboard_address=None
    ) as cluster:
        address = cluster.scheduler_address
        for _ in range(ROUNDS):
            ours.append(_time_of(lambda: _run(LocalEngine(JOBS))))
            theirs.append(_time_of(lambda: _run(ClusterEngine(address))))
            tasks.append(_time_of(lambda: _tasks(address)))
    local, dask, task = (_each(least(times), count) for times, count in ((ours, RUNS), (theirs, RUNS), (tasks, ORDERS)))
    with LocalEngine(1) as engine:
        (row,) = next(engine.rows(PLAN, [range(1)]))
    size = len(_json(row_data(row)))
    return [
        timed_row("a run of a sweep, processes of this computer", local, "ms"),
        timed_row("the same on Dask: client, scheduler, worker", dask, "ms", other=local.cpu_s, beside="here"),
        timed_row("a Dask task without work, with its answer", task, "ms"),
        Row("the plan, once for each worker", "bytes", value=len(_json(plan_data(PLAN)))),
        Row("a row on its way to the client", "bytes", value=size),
    ]


def nothing(_: Any) -> Callable[[Any], Any]:
    """Return a job without work."""
    return lambda order: order


def _run(engine: Engine) -> None:
    with engine:
        assert sum(len(piece) for piece in engine.rows(PLAN, [range(RUNS)])) == RUNS
    cluster_worker.end_children()


def _tasks(address: str) -> None:
    work = work_bytes("benchmarks.cluster:nothing", None, None, None)
    with Cluster(address, is_mixed=False, note=print) as cluster:
        assert len(cluster.results_of(work, list(range(ORDERS)))) == ORDERS
    cluster_worker.end_children()


def _time_of(run: Callable[[], object]) -> Time:
    """Return the time of all processes: CPU of children counts when they have ended."""
    wall, cpu = perf_counter(), sum(os.times()[:4])
    run()
    return Time(perf_counter() - wall, sum(os.times()[:4]) - cpu)


def _each(time: Time, count: int) -> Time:
    return Time(time.wall_s / count, time.cpu_s / count)


def _json(data: Any) -> bytes:
    import json

    return json.dumps(data, separators=(",", ":")).encode()
