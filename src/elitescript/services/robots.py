"""Composition of a served robot: its link (a jailed child, a child, or none at all), and its server with all parts."""

from __future__ import annotations

import time
from collections.abc import Awaitable, Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Final

from elitescript.environment.allowance import TASK_DIR_BYTES, Allowance
from elitescript.environment.local import LocalFiles
from elitescript.environment.memory import MemoryFiles
from elitescript.environment.request_channels import RequestEnvironment
from elitescript.errors import ElitescriptError
from elitescript.kernel import Kernel, RobotOptions
from elitescript.messages.inputs import Input
from elitescript.messages.outputs import Output
from elitescript.messages.snapshot_parts import ALL_PARTS
from elitescript.records import replace
from elitescript.runtime.environment import Files
from elitescript.runtime.threads.meter import SHARE_NS, ClockMeter
from elitescript.services.channels.connect_policy import ConnectPolicy
from elitescript.services.child.jail import Layer
from elitescript.services.child.link import ChildLink
from elitescript.services.child.spare import Spares
from elitescript.services.debugging import debugging
from elitescript.services.journal.replay import RecordedRobot
from elitescript.services.journal.writer import Journal
from elitescript.services.log import Listen, ServerLog
from elitescript.services.robot_link import InProcessLink, RobotLink
from elitescript.services.robot_server import RobotServer
from elitescript.services.state_keeper import StateKeeper
from elitescript.services.time.lockstep import TIMEOUT_S

if TYPE_CHECKING:
    from elitescript.devices.world import World
    from elitescript.services.served_devices import ServedDevices
    from elitescript.services.ssh.desk import SshDesk

SHARE_MIN_NS: Final = 100_000
"""Least time of the programs of a robot in a tick, however many robots share the process."""


def robot_link(
    options: RobotOptions,
    *,
    task_dir: Path | None,
    task_dir_limit: int = TASK_DIR_BYTES,
    in_process: bool,
    is_jailed: bool,
    journal: Path | None,
    spares: Spares | None = None,
    robots: int = 1,
    is_lockstep: bool = False,
) -> RobotLink:
    """Return the way to one robot.

    Args:
        options: of the robot.
        task_dir: its task folder; an empty one in memory if None.
        task_dir_limit: bytes that its programs may add to it.
        in_process: keep it in this process.
        is_jailed: lock its process in.
        journal: file to write the session to.
        spares: keeps a child ready for the robots of this process; none if None.
        robots: that share this process, if `in_process`: each has its part of the time that programs have in a tick.
        is_lockstep: no wall clock rules, so nothing but work ends ticks.

    Raises:
        UsageError: the journal cannot be written.
    """
    allowance = Allowance(task_dir_limit)
    files: Files = MemoryFiles({}, allowance) if task_dir is None else LocalFiles(task_dir.resolve(), allowance)
    if not in_process:
        options = replace(options, compiles_elsewhere=True)
    # A child has a meter of its own.
    meter = shared_meter(robots) if in_process and not is_lockstep else None
    record = None if journal is None else Journal(journal, options, is_metered=not in_process or meter is not None)
    if not in_process:
        return ChildLink(options, files=files, is_jailed=is_jailed, journal=record, spares=spares)
    if record is None:
        return InProcessLink(Kernel(options, RequestEnvironment(files), debugging=debugging(), meter=meter))
    return _RecordedLink(RecordedRobot(options, files, record, meter), record)


def shared_meter(robots: int) -> ClockMeter:
    """Return what ends the ticks of one of several robots whose programs share a thread."""
    share_ns = max(SHARE_NS // robots, SHARE_MIN_NS)
    return ClockMeter(time.monotonic_ns, time.thread_time_ns, share_ns=share_ns)


def served_robot(
    name: str,
    link: RobotLink,
    listen: Listen,
    *,
    world: World | None = None,
    keeper: StateKeeper | None = None,
    ssh_password: str | None = None,
    is_lockstep: bool = False,
    lockstep_timeout_s: float = TIMEOUT_S,
    lines: Mapping[str, str] | None = None,
    policy: ConnectPolicy | None = None,
) -> RobotServer:
    """Return the server of one robot.

    Args:
        name: unique among the robots of this `serve`.
        link: the way to the robot.
        listen: takes every event of the robot, and every line about clients, ports and time; must not block.
        world: virtual devices beside the robot.
        keeper: writes down what the robot keeps; nothing is written if None.
        ssh_password: that SSH clients log in with; there is no SSH port if None.
        is_lockstep: see `RobotServer`.
        lockstep_timeout_s: see `RobotServer`.
        lines: see `RobotServer`.
        policy: see `RobotServer`.
    """
    log = ServerLog(name, listen)
    if keeper is not None:
        keeper.warn = lambda text: log.note("state", text, is_problem=True)
    devices: ServedDevices | None = None
    if world is not None:
        from elitescript.services.served_devices import ServedDevices

        devices = ServedDevices(world, log)
    ssh: SshDesk | None = None
    if ssh_password is not None:
        from elitescript.services.ssh.desk import SshDesk

        ssh = SshDesk(log, ssh_password)
    return RobotServer(
        link,
        log,
        is_lockstep=is_lockstep,
        lockstep_timeout_s=lockstep_timeout_s,
        lines=lines,
        devices=devices,
        keeper=keeper,
        policy=policy,
        ssh=ssh,
    )


def numbered_path(path: Path, index: int) -> Path:
    """Return the file of one of several robots: `day.journal`, `day.1.journal`, `day.2.journal`, ..."""
    return path if index == 0 else path.with_name(f"{path.stem}.{index}{path.suffix}")


async def probe_jail() -> tuple[tuple[Layer, ...], str]:
    """Return the layers of the jail that a child finds here, and why it did not come up; empty if it did."""
    link = ChildLink(RobotOptions())
    try:
        await link.open()
    except ElitescriptError as error:
        return link.layers, str(error)
    finally:
        await link.close()
    return link.layers, ""


class _RecordedLink(InProcessLink):
    """A robot in this process with a journal."""

    __slots__ = ("_journal",)

    def __init__(self, robot: RecordedRobot, journal: Journal) -> None:
        super().__init__(robot)
        self._journal = journal

    async def tick(
        self,
        inputs: Sequence[Input],
        parts: int = ALL_PARTS,
        number: int | None = None,
        *,
        asks_due: bool = True,
        outlet: Callable[[], Awaitable[None]] | None = None,
    ) -> Output:
        # The digests of the journal cover the snapshot of every tick, so it is there already.
        output = await super().tick(inputs, ALL_PARTS, number, asks_due=asks_due, outlet=outlet)
        warning = self._journal.take_warning(output.tick)
        return replace(output, events=(*output.events, *warning)) if warning else output

    async def close(self) -> None:
        self._journal.close()
