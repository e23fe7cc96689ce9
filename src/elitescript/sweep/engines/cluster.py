"""The runs of a plan on a Dask cluster that is there: extra `cluster`.

A task is a range of numbers, and drives the same child process as that of this computer does, so rows are the same.
Few tasks are given out at a time, so that neither the scheduler nor this process holds a long sweep, and so that a
cluster that grows sees that there is work. Every worker that sends rows, also one that has joined late, says on which
platform it made them.
"""

from __future__ import annotations

import asyncio
import json
import logging
import re
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import CancelledError
from contextlib import contextmanager
from math import ceil
from time import monotonic
from typing import TYPE_CHECKING, Any, Final

from elitescript import __version__
from elitescript.errors import InternalError, UsageError
from elitescript.extras import require
from elitescript.records import NamedTuple
from elitescript.sweep.engines.cluster_worker import platform_here, run_about, run_order, run_range, work_bytes
from elitescript.sweep.engines.engine import JOB, row_of_result, rows_of_results
from elitescript.sweep.engines.executor import MAX_WALL_S, Result
from elitescript.sweep.engines.reference import Platform, versions_here
from elitescript.sweep.plans.plan import CRASHED, Choices, Plan, Row
from elitescript.sweep.plans.plan_json import choices_data, plan_data
from elitescript.sweep.plans.variations import Draw

if TYPE_CHECKING:
    from distributed import Client, Future

CONNECT_S: Final = 8.0
"""Wall time in which a scheduler must answer, *assumed*: with the start of the command, 10 s."""

TASK_S: Final = 1.5
"""Wall time of a task: the scheduler's 1 to 3 ms beside it do not count."""

LEAST_S: Final = 0.1
"""Wall time of the last tasks, which get shorter so that all workers end together."""

SCHEDULER_S: Final = 0.01
"""Least wall time of a task for each thread of the cluster: with many of them the scheduler would be the limit."""

AHEAD_S: Final = 10.0
"""Work given out for each thread: twice what an adaptive cluster asks of a worker before it starts one more."""

AHEAD_MIN: Final = 3
"""Tasks for each thread: one under way, one that the worker has ready, one on its way."""

FIRST: Final = 4
"""Runs of the first tasks, by which later ones are sized."""

PARTS: Final = 8
"""A range whose workers have died, four of them, is given out again in so many parts, down to single runs."""

_CANNOT: Final = f"{{}}: elitescript cannot be imported ({{}}); install elitescript[cluster] {__version__} there"

_ADDRESS: Final = re.compile(r"(?:tcp|tls)://(?:\[[0-9A-Fa-f:.%]+\]|[\w.-]+):\d{1,5}/?")


def check_address(address: str) -> str:
    """Return the address of a scheduler.

    Raises:
        UsageError: not of the form `tcp://HOST:PORT` or `tls://HOST:PORT`.
    """
    if not _ADDRESS.fullmatch(address):
        raise UsageError(f"--dask {address}: write the address of the scheduler, as tcp://HOST:8786 or tls://HOST:8786")
    return address


class Pace:
    """How large the next task is, and how many are under way: from the work of those that have come back.

    Attributes:
        threads: of the cluster, now.
    """

    __slots__ = ("_run_s", "threads")

    def __init__(self) -> None:
        self.threads = 0
        self._run_s: float | None = None

    def learn(self, runs: int, took_s: float) -> None:
        """Note how long a task took."""
        run_s = max(took_s, 1e-6) / runs
        self._run_s = run_s if self._run_s is None else (self._run_s + run_s) / 2

    @property
    def task_s(self) -> float:
        """Wall time that a task should take."""
        return max(TASK_S, SCHEDULER_S * self.threads)

    def size(self, left: int) -> int:
        """Return the number of runs of the next task, of so many that are left: the last ones are shared by all."""
        if self._run_s is None:
            return FIRST
        full, least = int(self.task_s / self._run_s), int(LEAST_S / self._run_s)
        return max(1, least, min(full, ceil(left / max(1, 2 * self.threads))))

    def tasks(self) -> int:
        """Return how many tasks may be under way."""
        return max(1, self.threads) * max(AHEAD_MIN, ceil(AHEAD_S / self.task_s))


class Pieces:
    """The numbers that nobody has yet.

    Attributes:
        left: how many.
    """

    __slots__ = ("_ranges", "left")

    def __init__(self, wanted: Sequence[range]) -> None:
        self._ranges = deque(numbers for numbers in wanted if numbers)
        self.left = sum(map(len, self._ranges))

    def take(self, size: int) -> range:
        """Take at most so many numbers that follow each other; there must be some."""
        numbers = self._ranges.popleft()
        if len(numbers) > size:
            self._ranges.appendleft(numbers[size:])
            numbers = numbers[:size]
        self.left -= len(numbers)
        return numbers

    def give_back(self, numbers: range, parts: int) -> None:
        """Take back what was not done, in smaller pieces, to be given out first."""
        step = ceil(len(numbers) / parts)
        for start in reversed(range(0, len(numbers), step)):
            self._ranges.appendleft(numbers[start : start + step])
        self.left += len(numbers)


class _Answer(NamedTuple):
    """What came of a task.

    Attributes:
        results: None if all workers died that tried it.
        took_s: wall time in the worker.
    """

    results: list[Result] | None
    took_s: float


class Cluster:
    """A connection with a Dask cluster, to which pieces of work are given. Used as a context manager.

    Args:
        address: of the scheduler, or a client that is connected with it.
        is_mixed: whether workers may differ in the last digits of sine and cosine.
        note: called with a line of text if there is something to wait for.
    """

    def __init__(self, address: str | Client, *, is_mixed: bool, note: Callable[[str], None]) -> None:
        self._address = (
            check_address(address) if isinstance(address, str) else str(address.scheduler_info(n_workers=0)["address"])
        )
        self._client = None if isinstance(address, str) else address
        self._is_ours = self._client is None
        self._is_mixed = is_mixed
        self._note = note
        self._digits: str | None = None
        self._counted_at = 0.0
        self._pace = Pace()
        self._quiet: Any = None

    def __enter__(self) -> Cluster:
        require("cluster")
        from distributed import Client

        self._quiet = _no_logs()
        self._quiet.__enter__()
        try:
            if self._client is None:
                self._check_certificates()
                asyncio.run(self._greet())
                try:
                    self._client = Client(self._address, timeout=CONNECT_S, set_as_default=False, name="elitescript")
                except OSError as error:
                    raise UsageError(f"--dask {self._address}: no Dask scheduler answers there: {error}") from None
            self._check_scheduler()
            self.check_workers()
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        try:
            if self._is_ours and self._client is not None:
                self._client.close(timeout=1)
                self._client = None
        finally:
            if self._quiet is not None:
                self._quiet.__exit__(None, None, None)
                self._quiet = None

    def results(self, work: bytes, wanted: Sequence[range]) -> Iterator[list[Result]]:
        """Yield what came of numbered work, a list for each task: numbers that follow each other, in any order.

        Args:
            work: what every task is given, of `work_bytes`.
            wanted: numbers, without overlap.

        Raises:
            UsageError: a worker differs from the others, or cannot do the work, or the scheduler is gone.
        """
        pieces = Pieces(wanted)
        suspects: list[range] = []
        for numbers, answer in self._answers(work, pieces):
            if answer.results is not None:
                self._pace.learn(len(numbers), answer.took_s)
                yield answer.results
            elif len(numbers) > 1:
                pieces.give_back(numbers, PARTS)
            else:
                # It may have died of what ran beside it; so it is tried once more when nothing does.
                suspects.append(numbers)
        for numbers in suspects:
            for _, answer in self._answers(work, Pieces([numbers])):
                yield answer.results or [Result(numbers.start, self._about(work, numbers), CRASHED)]

    def _about(self, work: bytes, number: range) -> Any:
        """Return what the job says about a number that has ended every worker; None if nothing."""
        with _Tasks(self._connected(), work, self._lost) as tasks:
            tasks.add(number, run_about, number.start)
            results = self._answer(tasks.next()[1]).results
        return results[0].value if results else None

    def results_of(self, work: bytes, orders: Sequence[Any]) -> list[Result]:
        """Return what came of work that has no number, in its order: each, JSON-able, is given to the job."""
        found: dict[int, Result] = {}
        with _Tasks(self._connected(), work, self._lost) as tasks:
            for index, order in enumerate(orders):
                tasks.add(range(index, index + 1), run_order, json.dumps(order).encode())
            while tasks:
                numbers, outcome = tasks.next()
                results = self._answer(outcome).results
                found[numbers.start] = results[0] if results else Result(-1, None, CRASHED)
        return [found[index] for index in range(len(orders))]

    def _answers(self, work: bytes, pieces: Pieces) -> Iterator[tuple[range, _Answer]]:
        """Give out what is there, also what is given back meanwhile, and yield what comes of it."""
        with _Tasks(self._connected(), work, self._lost) as tasks:
            while True:
                self._count_threads()
                while pieces.left and len(tasks) < self._pace.tasks():
                    numbers = pieces.take(self._pace.size(pieces.left))
                    tasks.add(numbers, run_range, numbers.start, len(numbers))
                if not tasks:
                    return
                numbers, outcome = tasks.next()
                yield numbers, self._answer(outcome)

    def _answer(self, outcome: bytes | Exception) -> _Answer:
        """Return what a task's result says.

        Raises:
            UsageError: nothing that can be used.
        """
        from distributed.scheduler import KilledWorker

        if isinstance(outcome, KilledWorker):
            return _Answer(None, 0.0)
        if isinstance(outcome, Exception):
            # Most likely a worker that has joined late and has no elitescript, or another one.
            self.check_workers()
            raise outcome
        answer = json.loads(outcome)
        self._check_platform(answer["worker"], answer["platform"])
        if "refused" in answer:
            raise UsageError(answer["refused"])
        if "failed" in answer:
            raise UsageError(f"worker {answer['worker']}: {answer['failed']}")
        return _Answer([Result(*result) for result in answer["results"]], answer["took_s"])

    def _connected(self) -> Client:
        if self._client is None:
            raise InternalError("the cluster is used before `with`")
        return self._client

    def _count_threads(self) -> None:
        """Ask how large the cluster is, at most each second: workers join and leave."""
        if monotonic() - self._counted_at < 1:
            return
        try:
            threads = sum(self._connected().nthreads().values())
        except OSError:
            raise self._lost() from None
        if not threads and (self._pace.threads or not self._counted_at):
            self._note(f"{self._address}: waiting for workers")
        self._pace.threads = threads
        self._counted_at = monotonic()

    @property
    def threads(self) -> int:
        """Threads of all workers, at least one."""
        self._count_threads()
        return max(1, self._pace.threads)

    def _lost(self) -> UsageError:
        return UsageError(
            f"--dask {self._address}: the scheduler has gone, or has dropped the work; what had come is kept, "
            "--resume goes on from there"
        )

    async def _greet(self) -> None:
        """Exchange the first messages of Dask with what is at the address, and leave again.

        `Client` waits for ever for a server that accepts a connection and says nothing, and cannot be ended when it has
        got something else than a message.
        """
        from distributed import Security
        from distributed.comm.core import CommClosedError, connect
        from tornado.iostream import StreamClosedError

        try:
            async with asyncio.timeout(CONNECT_S):
                # Its own limit is for the connection alone, and says why there is none.
                arguments = Security().get_connection_args("client")
                connection = await connect(self._address, timeout=0.9 * CONNECT_S, **arguments)
                await connection.close()
        except TimeoutError:
            why = f"what is there says nothing within {CONNECT_S:g} s"
        except OSError as error:
            # What closes at once may be gone before the first message, which is tried again until the time is up.
            last = error if isinstance(error, CommClosedError) else error.__cause__
            ends = (type(None), StreamClosedError, ConnectionResetError)
            was_open = last is error or (isinstance(last, CommClosedError) and isinstance(last.__cause__, ends))
            why = "what is there closes the connection" if was_open else str(error)
        except Exception:
            # Whatever reading something else than a message raises.
            why = "what is there sends something else"
        else:
            return
        raise UsageError(f"--dask {self._address}: no Dask scheduler answers there: {why}")

    def _check_certificates(self) -> None:
        from distributed import Security

        if self._address.startswith("tls://") and Security().get_connection_args("client")["ssl_context"] is None:
            raise UsageError(
                f"--dask {self._address}: TLS needs the certificates in Dask's configuration, `distributed.comm.tls`"
            )

    def _check_scheduler(self) -> None:
        """Compare versions with those of the scheduler, which has to load our functions too."""
        try:
            versions = self._connected().run_on_scheduler(versions_here)
        except OSError:
            raise self._lost() from None
        except Exception as error:
            raise UsageError(f"--dask {self._address}: {_CANNOT.format('the scheduler', error)}") from None
        self._check_versions(f"scheduler {self._address}", versions)

    def check_workers(self) -> None:
        """Compare the platforms of all workers that are there."""
        try:
            answers = self._connected().run(platform_here, on_error="return")
        except OSError:
            raise self._lost() from None
        for worker, answer in sorted(answers.items()):
            if isinstance(answer, OSError):
                # It has left while it was asked.
                continue
            if isinstance(answer, BaseException):
                raise UsageError(_CANNOT.format(f"worker {worker}", answer))
            self._check_platform(worker, answer)

    def _check_platform(self, worker: str, texts: list[str]) -> None:
        if len(texts) == 1:
            raise UsageError(f"worker {worker}: {texts[0]}")
        platform = Platform(*texts)
        self._check_versions(f"worker {worker}", platform[:3])
        if self._digits is None:
            self._digits = platform.digits
        elif platform.digits != self._digits and not self._is_mixed:
            raise UsageError(
                f"worker {worker}: its reference run ends in {platform.digits}, that of the first worker in "
                f"{self._digits}: sine and cosine differ in the last digit (another processor or C library); --mixed "
                "takes rows of both"
            )

    def _check_versions(self, place: str, versions: Sequence[str]) -> None:
        for name, theirs, ours in zip(("elitescript", "Python", "greenlet"), versions, versions_here(), strict=True):
            if theirs != ours:
                raise UsageError(f"{place}: has {name} {theirs}, here is {ours}; a cluster needs the same everywhere")


class ClusterEngine:
    """Runs plans on a Dask cluster. Implements `Engine`.

    Args:
        address: of the scheduler, or a client that is connected with it.
        max_wall_s: wall time of one run, after which it is given up; None for no limit.
        memory_bytes: address space of a child process; None for no limit.
        is_mixed: whether workers may differ in the last digits of sine and cosine.
        note: called with a line of text if there is something to wait for.
    """

    def __init__(
        self,
        address: str | Client,
        *,
        max_wall_s: float | None = MAX_WALL_S,
        memory_bytes: int | None = None,
        is_mixed: bool = False,
        note: Callable[[str], None] = lambda text: None,
    ) -> None:
        self._cluster = Cluster(address, is_mixed=is_mixed, note=note)
        self._limits = max_wall_s, memory_bytes

    @property
    def workers(self) -> int:
        """Threads of all workers; see `Engine`."""
        return self._cluster.threads

    def __enter__(self) -> ClusterEngine:
        self._cluster.__enter__()
        return self

    def __exit__(self, *_: object) -> None:
        self._cluster.__exit__()

    def rows(self, plan: Plan, wanted: Sequence[range]) -> Iterator[list[Row]]:
        """Yield the rows of runs as they come; see `Engine`."""
        draw = Draw(plan.variations, plan.seed)
        for results in self._cluster.results(self._work(plan), wanted):
            yield [row_of_result(plan, draw, result) for result in results]

    def rows_of(self, plan: Plan, choices: Sequence[Choices]) -> list[Row]:
        """Return the rows of runs with given choices, in their order; see `Engine`."""
        results = self._cluster.results_of(self._work(plan), [choices_data(one) for one in choices])
        return rows_of_results(choices, results)

    def row(self, plan: Plan, choices: Choices) -> Row:
        """Return the row of one such run; see `Engine`."""
        return self.rows_of(plan, [choices])[0]

    def _work(self, plan: Plan) -> bytes:
        return work_bytes(JOB, plan_data(plan), *self._limits)


class _Tasks:
    """Tasks that are under way on a cluster; what is not fetched is cancelled at the end.

    Args:
        client: of the cluster.
        work: what every task is given.
        lost: makes what is raised when the scheduler has gone.
    """

    __slots__ = ("_client", "_done", "_items", "_lost", "_work")

    def __init__(self, client: Client, work: bytes, lost: Callable[[], Exception]) -> None:
        from distributed import as_completed

        self._client = client
        self._lost = lost
        # A task of its own: it is sent to each worker once, and made again if all of those that have it are gone.
        self._work = client.submit(bytes, work, pure=False)
        self._done = as_completed(loop=client.loop)
        self._items: dict[Future[bytes], range] = {}

    def __enter__(self) -> _Tasks:
        return self

    def __exit__(self, *_: object) -> None:
        if self._items and self._client.status == "running":
            self._client.cancel(list(self._items))
        for future in self._items:
            future.release()
        self._work.release()

    def __len__(self) -> int:
        return len(self._items)

    def add(self, numbers: range, function: Callable[..., bytes], *arguments: object) -> None:
        """Give out a task for those numbers."""
        future = self._client.submit(function, self._work, *arguments, pure=False)
        self._items[future] = numbers
        self._done.add(future)

    def next(self) -> tuple[range, bytes | Exception]:
        """Wait for a task, and return its numbers with its result, or with what it has raised."""
        future = next(self._done)
        numbers = self._items.pop(future)
        try:
            error = future.exception() if future.status == "error" else None
            return numbers, future.result() if error is None else error
        except (CancelledError, OSError):
            raise self._lost() from None
        finally:
            future.release()


@contextmanager
def _no_logs() -> Iterator[None]:
    """Keep what distributed logs from the terminal: what matters of it is raised here."""
    loggers = [logging.getLogger(name) for name in logging.root.manager.loggerDict if name.startswith("distributed")]
    handlers = [(logger, logger.handlers) for logger in loggers]
    for logger in loggers:
        logger.handlers = [logging.NullHandler()]
    try:
        yield
    finally:
        for logger, before in handlers:
            logger.handlers = before
