"""Runs on a Dask cluster: the same rows as here, whatever happens to its workers."""

from __future__ import annotations

import json
import os
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from elitescript.errors import UsageError
from elitescript.sweep.engines import cluster, cluster_worker
from elitescript.sweep.engines.cluster import ClusterEngine, Pace, Pieces, check_address
from elitescript.sweep.engines.executor import Result
from elitescript.sweep.engines.local import LocalEngine
from elitescript.sweep.plans.plan import Plan, Row, Variation
from elitescript.sweep.plans.plan_json import row_data

pytest.importorskip("distributed", reason="extra `cluster`")

PROGRAM = """\
def cell():
  SPEED = 1.0
  movej([0, -1.57, -1.57, -1.57, 1.57, 0], v=SPEED)
  if SPEED > 1.9:
    halt()
  end
end
"""
PLAN = Plan(PROGRAM, variations=(Variation("SPEED", "uniform", (0.5, 2.0)),), seed=3)


def rows_of(engine: Any, count: int, plan: Plan = PLAN) -> list[list[Any]]:
    """Run the first runs of a plan; return their rows in the order of their numbers."""
    with engine:
        rows: list[Row] = [row for piece in engine.rows(plan, [range(count)]) for row in piece]
    rows.sort(key=lambda row: row.choices.run)
    assert [row.choices.run for row in rows] == list(range(count))
    return [row_data(row) for row in rows]


@pytest.fixture
def here() -> Iterator[str]:
    """A cluster of one worker with two threads, in this process."""
    from distributed import LocalCluster

    with LocalCluster(
        n_workers=1, threads_per_worker=2, processes=False, protocol="tcp", host="127.0.0.1", dashboard_address=None
    ) as found:
        yield found.scheduler_address
    cluster_worker.end_children()


def test_rows_are_those_of_this_computer(here: str):
    assert rows_of(ClusterEngine(here), 12) == rows_of(LocalEngine(1), 12)


@pytest.mark.parametrize(
    "address", ["127.0.0.1:8786", "tcp://", "tcp://host", "tcp://host:x", "http://host:1", "tcp://a b:1", "tcp://h:1;x"]
)
def test_an_address_that_is_none_is_refused(address: str):
    with pytest.raises(UsageError, match="tcp://HOST"):
        ClusterEngine(address)


@pytest.mark.parametrize("address", ["tcp://10.0.0.1:8786", "tls://scheduler.example:8786", "tcp://[::1]:8786"])
def test_an_address_of_a_scheduler_is_taken(address: str):
    assert check_address(address) == address


STRANGERS = {
    "silent": (None, "what is there says nothing within 0.3 s"),
    "closes at once": (b"", "what is there closes the connection"),
    "HTTP": (b"HTTP/1.0 400 Bad request\r\n\r\n", "what is there sends something else"),
    "SSH": (b"SSH-2.0-OpenSSH_9.2p1\r\n", "what is there sends something else"),
    "a message of nothing": (bytes(64), "what is there sends something else"),
}
"""What servers that are no scheduler send when somebody connects, None for ever nothing; and what is said of them."""


@pytest.mark.parametrize("stranger", STRANGERS)
def test_what_is_no_scheduler_is_told_in_time(stranger: str, monkeypatch: pytest.MonkeyPatch):
    sent, said = STRANGERS[stranger]
    monkeypatch.setattr(cluster, "CONNECT_S", 0.3)
    kept = []

    def serve(server: socket.socket) -> None:
        while True:
            try:
                connection, _ = server.accept()
            except OSError:
                return
            if sent:
                connection.sendall(sent)
            kept.append(connection) if sent is None else connection.close()

    with socket.create_server(("127.0.0.1", 0)) as server:
        threading.Thread(target=serve, args=(server,), daemon=True).start()
        address = f"tcp://127.0.0.1:{server.getsockname()[1]}"
        with pytest.raises(UsageError) as caught, ClusterEngine(address):
            pass
        server.shutdown(socket.SHUT_RDWR)
    assert str(caught.value) == f"--dask {address}: no Dask scheduler answers there: {said}"
    for connection in kept:
        connection.close()


@pytest.mark.parametrize(
    ("cause", "said"),
    [
        (None, "what is there closes the connection"),
        (ConnectionResetError(), "what is there closes the connection"),
        (ConnectionRefusedError(), "Timed out trying to connect"),
    ],
)
def test_what_closes_before_the_first_message_is_told(
    cause: Exception | None, said: str, monkeypatch: pytest.MonkeyPatch
):
    from distributed.comm.core import CommClosedError

    async def connect(*_: object, **__: object) -> None:
        last = CommClosedError()
        last.__cause__ = cause
        raise OSError("Timed out trying to connect") from last

    monkeypatch.setattr("distributed.comm.core.connect", connect)
    with pytest.raises(UsageError, match=rf"there: {said}$"), ClusterEngine("tcp://127.0.0.1:9"):
        pass


def test_nobody_at_the_address_is_said_after_a_while(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(cluster, "CONNECT_S", 0.2)
    with pytest.raises(UsageError, match="no Dask scheduler answers"), ClusterEngine("tcp://127.0.0.1:9"):
        pass


def test_tls_without_certificates_is_refused_before_anything_is_sent():
    with pytest.raises(UsageError, match="certificates"), ClusterEngine("tls://127.0.0.1:9"):
        pass


def test_a_plan_that_makes_no_sense_is_refused_as_here(here: str):
    plan = Plan(PROGRAM, variations=(Variation("SPED", "uniform", (0.5, 2.0)),))
    with pytest.raises(UsageError, match=r"^--vary SPED: the program has no such name"):
        rows_of(ClusterEngine(here), 3, plan)


OURS = ["0.1.0", "3.11", "3.1", "0" * 16]


class Disordered:
    """An executor whose child has died once: its numbers come after others."""

    def results(self, wanted: list[range]) -> Iterator[list[Result]]:
        assert wanted == [range(5, 9)]
        yield [Result(7, "c"), Result(8, "d")]
        yield [Result(6, "about 6", "hung")]
        yield [Result(5, "a")]


def test_a_task_gives_its_numbers_in_order_whatever_its_child_did(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(cluster_worker, "platform_here", lambda: OURS)
    monkeypatch.setattr("distributed.get_worker", lambda: SimpleNamespace(address="tcp://a:1"))
    monkeypatch.setattr(cluster_worker, "_CHILDREN", SimpleNamespace(one=lambda work: nullcontext(Disordered())))
    answer = json.loads(cluster_worker.run_range(b"", 5, 4))
    assert answer["results"] == [[5, "a", ""], [6, "about 6", "hung"], [7, "c", ""], [8, "d", ""]]


@pytest.mark.parametrize(
    ("index", "other", "text"),
    [
        (0, "9.9", "worker tcp://b:1: has elitescript 9.9, here is 0.1.0"),
        (1, "3.99", "worker tcp://b:1: has Python 3.99, here is 3.11"),
        (2, "99.0", "worker tcp://b:1: has greenlet 99.0, here is 3.1"),
        (3, "1" * 16, "worker tcp://b:1: its reference run ends in 1111111111111111"),
    ],
)
def test_a_worker_that_differs_is_refused_by_its_name(
    monkeypatch: pytest.MonkeyPatch, index: int, other: str, text: str
):
    monkeypatch.setattr(cluster, "versions_here", lambda: tuple(OURS[:3]))
    theirs = [*OURS[:index], other, *OURS[index + 1 :]]
    connection = cluster.Cluster("tcp://127.0.0.1:9", is_mixed=False, note=print)
    monkeypatch.setattr(connection, "_client", Fake({"tcp://b:1": theirs, "tcp://a:1": OURS}))
    with pytest.raises(UsageError) as caught:
        connection.check_workers()
    assert str(caught.value).startswith(text)


def test_other_digits_are_taken_if_it_is_asked_for(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(cluster, "versions_here", lambda: tuple(OURS[:3]))
    connection = cluster.Cluster("tcp://127.0.0.1:9", is_mixed=True, note=print)
    monkeypatch.setattr(connection, "_client", Fake({"tcp://b:1": [*OURS[:3], "1" * 16], "tcp://a:1": OURS}))
    connection.check_workers()


def test_a_worker_without_elitescript_is_named():
    connection = cluster.Cluster("tcp://127.0.0.1:9", is_mixed=False, note=print)
    connection._client = Fake({"tcp://a:1": ModuleNotFoundError("No module named 'elitescript'")})  # type: ignore[assignment]
    with pytest.raises(UsageError, match=r"worker tcp://a:1: elitescript cannot be imported .*elitescript\[cluster\]"):
        connection.check_workers()


class Fake:
    """A client that has asked its workers."""

    def __init__(self, answers: dict[str, Any]) -> None:
        self.answers = answers

    def run(self, *_: object, **__: object) -> dict[str, Any]:
        return self.answers


# ---------------------------------------------------------------- sizes of tasks


def test_the_first_tasks_are_small_and_later_ones_take_their_time():
    pace = Pace()
    pace.threads = 4
    assert pace.size(1_000_000) == cluster.FIRST
    pace.learn(4, 4 * 0.003)
    assert pace.size(1_000_000) == 500  # 1.5 s of runs of 3 ms


def test_the_last_tasks_are_shared_by_all_but_not_too_short():
    pace = Pace()
    pace.threads = 4
    pace.learn(100, 100 * 0.003)
    assert pace.size(800) == 100
    assert pace.size(80) == 33  # 0.1 s
    pace.learn(1, 100.0)
    assert pace.size(80) == 1


def test_a_large_cluster_gets_longer_tasks_so_that_its_scheduler_keeps_up():
    pace = Pace()
    pace.threads = 1000
    assert pace.task_s == 10.0
    # 1,000 threads with tasks of 10 s: 100 tasks a second.
    assert pace.tasks() == 3000


def test_an_adaptive_cluster_sees_more_work_than_its_workers_have():
    pace = Pace()
    # It asks for a worker for each 5 s of work.
    assert pace.tasks() * pace.task_s >= 2 * 5
    pace.threads = 10
    assert pace.tasks() * pace.task_s >= 2 * 10 * 5


def test_every_number_is_given_out_once():
    pieces = Pieces([range(10), range(0), range(20, 25)])
    assert pieces.left == 15
    taken = [pieces.take(4)]
    pieces.give_back(taken.pop(), 3)
    assert pieces.left == 15
    while pieces.left:
        taken.append(pieces.take(4))
    assert taken == [range(2), range(2, 4), range(4, 8), range(8, 10), range(20, 24), range(24, 25)]


# ---------------------------------------------------------------- processes that are killed


class Processes:
    """A cluster of processes on this computer, which a test may kill."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.file = folder / "scheduler.json"
        self.started: list[subprocess.Popen[bytes]] = []
        self.scheduler = self.start("scheduler", "--scheduler-file", str(self.file), "--port", "0", "--no-show")
        end = time.monotonic() + 30
        while not self.file.exists() and time.monotonic() < end:
            time.sleep(0.05)
        self.address = json.loads(self.file.read_text())["address"]

    def start(self, kind: str, *arguments: str, **variables: str) -> subprocess.Popen[bytes]:
        log = (self.folder / f"{kind}-{len(self.started)}.log").open("wb")
        with log:
            started = subprocess.Popen(
                [
                    sys.executable,
                    "-m",
                    f"distributed.cli.dask_{kind}",
                    *arguments,
                    "--host",
                    "127.0.0.1",
                    "--no-dashboard",
                ],
                stdout=log,
                stderr=log,
                cwd=self.folder,
                env={**os.environ, "DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "1", **variables},
            )
        self.started.append(started)
        return started

    def worker(self, **variables: str) -> subprocess.Popen[bytes]:
        return self.start("worker", self.address, "--nthreads", "1", "--no-nanny", **variables)


@contextmanager
def processes(folder: Path) -> Iterator[Processes]:
    found = Processes(folder)
    try:
        yield found
    finally:
        for started in found.started:
            started.kill()
        for started in found.started:
            started.wait()


LONG = Plan(
    PROGRAM.replace("  if", "  i = 0\n  while i < 3000:\n    i = i + 1\n  end\n  if"), variations=PLAN.variations
)


@pytest.mark.slow
@pytest.mark.timeout(180)
def test_a_killed_worker_costs_nothing_and_one_that_joins_later_helps(tmp_path: Path):
    with processes(tmp_path) as found:
        workers = [found.worker(), found.worker()]
        rows: list[Row] = []
        with ClusterEngine(found.address) as engine:
            for piece in engine.rows(LONG, [range(1500)]):
                if len(rows) < 100 <= len(rows) + len(piece):
                    workers[0].kill()
                    found.worker()
                rows += piece
    rows.sort(key=lambda row: row.choices.run)
    assert [row_data(row) for row in rows] == rows_of(LocalEngine(2), 1500, LONG)


@pytest.mark.slow
@pytest.mark.timeout(180)
def test_a_lost_scheduler_is_said_and_what_had_come_is_kept(tmp_path: Path):
    rows: list[Row] = []
    with processes(tmp_path) as found:
        found.worker()
        with pytest.raises(UsageError, match="the scheduler has gone"), ClusterEngine(found.address) as engine:
            for piece in engine.rows(LONG, [range(5000)]):
                rows += piece
                if len(rows) > 50:
                    found.scheduler.kill()
    assert 50 < len(rows) < 5000
    assert {row.state for row in rows} <= {"finished", "stopped"}


@pytest.mark.slow
@pytest.mark.timeout(300)
def test_a_run_that_kills_its_workers_is_found_and_costs_itself_alone(tmp_path: Path):
    from distributed import Client

    with processes(tmp_path) as found, Client(found.address, set_as_default=False) as client:
        # Workers die of run 37, as of a limit of a container that counts the memory of children.
        (tmp_path / "sitecustomize.py").write_text(DEADLY)
        path = os.pathsep.join([str(tmp_path), *filter(None, [os.environ.get("PYTHONPATH", "")])])
        alive = [found.worker(PYTHONPATH=path) for _ in range(2)]
        with ClusterEngine(client) as engine:
            rows: list[Row] = []
            pieces = engine.rows(PLAN, [range(60)])
            with replaced(found, alive, path):
                for piece in pieces:
                    rows += piece
    rows.sort(key=lambda row: row.choices.run)
    assert [row.choices.run for row in rows] == list(range(60))
    assert [row.choices.run for row in rows if row.state == "crashed"] == [37]


DEADLY = """\
import sys

if any("dask_worker" in word for word in sys.orig_argv):
    import os
    from elitescript.sweep.engines import cluster_worker
    do = cluster_worker._answer

    def run_range(work, first, count):
        if first <= 37 < first + count:
            os._exit(9)
        return do(work, lambda executor: [r for rs in executor.results([range(first, first + count)]) for r in rs])

    run_range.__module__, run_range.__qualname__ = "elitescript.sweep.engines.cluster_worker", "run_range"
    cluster_worker.run_range = run_range
"""


@contextmanager
def replaced(found: Processes, alive: list[subprocess.Popen[bytes]], path: str) -> Iterator[None]:
    """Start a new worker for each one that has died, as a nanny or a batch system does."""
    from threading import Event, Thread

    ends = Event()

    def watch() -> None:
        while not ends.wait(0.2):
            for index, worker in enumerate(alive):
                if worker.poll() is not None:
                    alive[index] = found.worker(PYTHONPATH=path)

    thread = Thread(target=watch)
    thread.start()
    try:
        yield
    finally:
        ends.set()
        thread.join()


@pytest.mark.slow
@pytest.mark.timeout(120)
@pytest.mark.skipif(sys.platform != "linux", reason="the C library of Linux can be told to leave out instructions")
def test_a_worker_with_other_digits_is_refused_unless_mixed(tmp_path: Path):
    with processes(tmp_path) as found:
        found.worker()
        found.worker(GLIBC_TUNABLES="glibc.cpu.hwcaps=-FMA,-AVX2")
        from distributed import Client

        with Client(found.address, set_as_default=False) as client:
            client.wait_for_workers(2)
            if len({answer[3] for answer in client.run(cluster_worker.platform_here).values()}) == 1:
                pytest.skip("this processor has no such instructions")
        with pytest.raises(UsageError, match=r"worker tcp://127.0.0.1:\d+: its reference run ends in"):
            rows_of(ClusterEngine(found.address), 4)
        assert rows_of(ClusterEngine(found.address, is_mixed=True), 40) == rows_of(LocalEngine(1), 40)


@pytest.mark.slow
@pytest.mark.timeout(120)
def test_an_adaptive_cluster_grows_from_nothing(monkeypatch: pytest.MonkeyPatch):
    from distributed import LocalCluster

    said: list[str] = []
    with LocalCluster(
        n_workers=0, threads_per_worker=1, processes=False, protocol="tcp", host="127.0.0.1", dashboard_address=None
    ) as adaptive:
        adaptive.adapt(minimum=0, maximum=3, interval="200ms")
        most = 0
        rows: list[Row] = []
        with ClusterEngine(adaptive.scheduler_address, note=said.append) as engine:
            for piece in engine.rows(LONG, [range(2500)]):
                rows += piece
                most = max(most, len(adaptive.scheduler.workers))
    cluster_worker.end_children()
    assert len(rows) == 2500
    assert most == 3
    assert said == [f"{adaptive.scheduler_address}: waiting for workers"]
