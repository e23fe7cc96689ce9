"""`elitescript serve`: serves virtual controllers on the network."""

from __future__ import annotations

import asyncio
import contextlib
import os
import sys
import time
from collections.abc import Callable, Collection
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from elitescript.cli.last_resort import last_resort
from elitescript.cli.output.library_lines import library_lines
from elitescript.cli.output.remedies import served
from elitescript.cli.output.report import JsonRunReport, RunReport, TextRunReport, parse_logs
from elitescript.cli.output.terminal import QueuedStream, TaggedStream
from elitescript.cli.output.writable import Writable
from elitescript.cli.robot_options import options_from
from elitescript.cli.settings import parse_size
from elitescript.cli.ssh_login import Login, ssh_login
from elitescript.environment.addresses import NONE
from elitescript.environment.line_bindings import parse_bindings
from elitescript.environment.start_values import parse_settings
from elitescript.environment.state_file import StateFile
from elitescript.environment.stop_signals import handled_signals
from elitescript.errors import UsageError
from elitescript.findings.found import Tally
from elitescript.json_records import jsonlines
from elitescript.kernel import Kernel, RobotOptions
from elitescript.kernel.arm import named_model
from elitescript.kernel.options import DEFAULTS, robot_options
from elitescript.messages.enums import TaskState
from elitescript.messages.events import Event, TaskLoaded, TaskStateChanged
from elitescript.messages.snapshot import RobotDescription
from elitescript.messages.timing import seconds
from elitescript.paths import real_path
from elitescript.protocol.ports import SERVICES, services_of
from elitescript.records import replace
from elitescript.services.capacity import Capacity, own_capacity
from elitescript.services.channels.connect_policy import ConnectPolicy, policy_values
from elitescript.services.child.jail import is_complete
from elitescript.services.child.spare import Spares
from elitescript.services.clients.direct import watchable_loop
from elitescript.services.hosts import hosts_of, is_loopback, range_of
from elitescript.services.log import DEVICE, LogLine
from elitescript.services.port_numbers import NAMES, SSH, port_numbers, spare_numbers
from elitescript.services.robot_link import RobotLink
from elitescript.services.robot_server import RobotServer
from elitescript.services.robots import numbered_path, probe_jail, robot_link, served_robot
from elitescript.services.server import ServeSession
from elitescript.services.state_keeper import StateKeeper
from elitescript.services.time.lockstep import TIMEOUT_S as LOCKSTEP_TIMEOUT_S
from elitescript.shown import shown, shown_word

if TYPE_CHECKING:
    import argparse

if TYPE_CHECKING:
    from elitescript.devices.world import World

ROBOTS_MAX: Final = 32
OVERTAKING: Final = frozenset({"stopped", "alarm", "paused"})
"""States that are printed before messages that still wait; a program that finishes has said all before."""
_TASK_WORDS: Final = {TaskState.PLAYING: "started", TaskState.PAUSED: "paused", TaskState.STOPPED: "stopped"}

ALL: Final = "all"
"""Name of every port for `--port`."""


def serve(options: argparse.Namespace) -> int:
    """Serve until a signal comes; return the exit code."""
    configs, worlds = robot_configs(options)
    for config in {(config.model, config.model_text): config for config in configs}.values():
        # An invalid robot is reported before a port is open or a process started.
        _check_ports(options, Kernel(config).description)
    _check_host(options, len(configs))
    chosen = chosen_ports(options.port, (*NAMES, SSH.name) if options.ssh else NAMES)
    login = ssh_login(options)
    has_ssh = login is not None
    # Robots with an address each have the same ports.
    steps = [0 if range_of(options.host) else index for index in range(len(configs))]
    numbers = [port_numbers(options.instance, chosen, robot=step, has_ssh=has_ssh) for step in steps]
    spares = [spare_numbers(options.instance, chosen, robot=step, has_ssh=has_ssh) for step in steps]
    _lockstep_timeout_s(options)
    if options.studio:
        from elitescript.cli.studio_beside import check_studio

        check_studio()
    if not is_in_process(options):
        return _run(options, configs, worlds, numbers, spares, login, _on_signals)
    # Programs run in this process, and may block its signal handlers.
    with last_resort("elitescript serve") as listen:
        return _run(options, configs, worlds, numbers, spares, login, lambda stop: listen(_threadsafe(stop)))


def _run(
    options: argparse.Namespace,
    configs: list[RobotOptions],
    worlds: list[World | None],
    numbers: list[dict[str, int]],
    spares: list[dict[str, int]],
    login: Login | None,
    on_signals: Callable[[asyncio.Event], None],
) -> int:
    out = QueuedStream(sys.stdout, missing_record) if options.json else QueuedStream(sys.stdout)
    err = QueuedStream(sys.stderr)
    try:
        names = [config.robot_id for config in configs]
        log = ServeLog(out, err, names, is_json=options.json, logs=parse_logs(options.log))
        with contextlib.ExitStack() as held:
            keepers = _keepers(options.state, len(configs), held)
            configs = list(map(_remembering, configs, keepers))
            held.enter_context(library_lines(log.library))
            with asyncio.Runner(loop_factory=watchable_loop) as runner:
                runner.run(_serve(options, configs, worlds, keepers, numbers, spares, login, log, on_signals))
    finally:
        out.close()
        err.close()
    return 0


async def _serve(
    options: argparse.Namespace,
    configs: list[RobotOptions],
    worlds: list[World | None],
    keepers: list[StateKeeper | None],
    numbers: list[dict[str, int]],
    spares: list[dict[str, int]],
    login: Login | None,
    log: ServeLog,
    on_signals: Callable[[asyncio.Event], None],
) -> None:
    lines = line_bindings(options.serial, len(configs))
    policy = ConnectPolicy(policy_values(options.allow_connect, _network(options.world)))
    stop = asyncio.Event()
    on_signals(stop)
    children = Spares(is_jailed=not options.no_jail)
    servers = [
        served_robot(
            config.robot_id,
            make_link(options, config, index, children),
            log.take,
            is_lockstep=options.lockstep is not None,
            lockstep_timeout_s=_lockstep_timeout_s(options),
            lines=lines,
            world=worlds[index],
            keeper=keeper,
            policy=policy,
            ssh_password=None if login is None else login.password,
        )
        for index, (config, keeper) in enumerate(zip(configs, keepers, strict=True))
    ]
    session = ServeSession(servers, hosts_of(options.host, len(configs)), numbers, options.instance, spares)
    await session.open()
    try:
        capacity = own_capacity(len(configs), is_in_process=is_in_process(options))
        log.ready(options.host, session, configs, policy.text, login, None if options.lockstep else capacity)
        with contextlib.ExitStack() as held:
            if options.studio:
                from elitescript.cli.studio_beside import studios

                names = [config.robot_id for config in configs]
                robots = list(zip(names, session.control_addresses, strict=True))
                held.enter_context(studios(robots, session.hosts, options.task_dir, _from_thread(log.studio)))
            await session.run(stop)
    finally:
        await session.close()
    log.end()


def make_link(
    options: argparse.Namespace, config: RobotOptions, index: int, children: Spares | None = None
) -> RobotLink:
    """Return the link to a robot."""
    return robot_link(
        config,
        task_dir=None if options.task_dir is None else Path(options.task_dir),
        task_dir_limit=parse_size(options.task_dir_limit, "--task-dir-limit"),
        in_process=is_in_process(options),
        is_jailed=not options.no_jail,
        journal=None if options.journal is None else numbered_path(Path(options.journal), index),
        spares=children,
        robots=max(len(options.models or ()), 1) * options.robots,
        is_lockstep=options.lockstep is not None,
    )


def _keepers(path: str | None, count: int, held: contextlib.ExitStack) -> list[StateKeeper | None]:
    """Return the state keeper of each robot; `held` releases the files in the end.

    Raises:
        UsageError: another process uses a file.
    """
    keepers: list[StateKeeper | None] = [None] * count
    if path is not None:
        for index in range(count):
            file = StateFile(numbered_path(Path(path), index))
            held.callback(file.release)
            keepers[index] = StateKeeper(file)
    return keepers


def _remembering(config: RobotOptions, keeper: StateKeeper | None) -> RobotOptions:
    """Return a robot that begins with the kept signals; those of the command line have priority."""
    if keeper is None:
        return config
    return replace(config, signals=tuple({**keeper.load(), **dict(config.signals)}.items()))


def is_in_process(options: argparse.Namespace) -> bool:
    """Return whether the robots are in this process: by option, for lockstep, or as the only way on this system."""
    return bool(options.in_process) or options.lockstep is not None or os.name != "posix"


def _lockstep_timeout_s(options: argparse.Namespace) -> float:
    """Return the timeout of a client in lockstep, s.

    Raises:
        UsageError: an invalid time, or no lockstep.
    """
    timeout_s: float | None = options.lockstep_timeout
    if timeout_s is None:
        return LOCKSTEP_TIMEOUT_S
    if options.lockstep is None:
        raise UsageError("--lockstep-timeout needs --lockstep rtsi")
    if not timeout_s > 0.0:
        raise UsageError(f"--lockstep-timeout must be more than 0 s, or inf for no limit; got {timeout_s:g}")
    return timeout_s


def _check_world_place(options: argparse.Namespace) -> None:
    """Refuse a world file that programs can write: it names Python files, which run outside the jail.

    Raises:
        UsageError: it is in the task folder of jailed robots.
    """
    if options.world is None or options.task_dir is None or is_in_process(options):
        return
    if real_path(options.task_dir) in real_path(options.world).parents:
        raise UsageError(
            f"--world {options.world}: it is in the task folder {options.task_dir}, where programs of the robot can "
            "change it and the Python files that it names; keep it elsewhere, or add --in-process if you trust them"
        )


def _network(world: str | None) -> str | None:
    """Return what a world file says programs reach; None if it says nothing."""
    if world is None:
        return None
    from elitescript.world_file import load_world_file

    found: str | None = load_world_file(world, with_world=False).options.get("network")
    return found


def robot_configs(options: argparse.Namespace) -> tuple[list[RobotOptions], list[World | None]]:
    """Return the options of each robot, and the world beside it.

    Raises:
        UsageError: an invalid option.
    """
    from elitescript.devices.channels.machine_faults import machine_fault
    from elitescript.devices.surroundings import REAL
    from elitescript.world_file import WorldFile, load_world_file

    if not 1 <= options.robots <= ROBOTS_MAX:
        raise UsageError(f"--robots must be from 1 to {ROBOTS_MAX}, got {options.robots}")
    models: list[str | None] = [model for model in options.models or [None] for _ in range(options.robots)]
    if len(models) > ROBOTS_MAX:
        raise UsageError(f"one serve has {ROBOTS_MAX} robots at most, not {len(models)}")
    signals, presets = parse_settings(options.set)
    if presets:
        raise UsageError(f"--set {min(presets)}: there is no such signal")
    if options.task_dir is not None and not Path(options.task_dir).is_dir():
        raise UsageError(f"--task-dir {options.task_dir}: there is no such folder")
    _check_world_place(options)
    given = options_from(options)
    configs: list[RobotOptions] = []
    worlds: list[World | None] = []
    for index, model in enumerate(models):
        file = WorldFile() if options.world is None else load_world_file(options.world, network=REAL)
        arm, named = named_model(file.options.get("model", DEFAULTS["model"]) if model is None else model)
        robot_id = file.options.get("robot_id", arm.name)
        worlds.append(file.world)
        if len(models) > 1:
            robot_id = f"{robot_id}-{options.instance + index}"
        configs.append(
            robot_options(
                {**given, **named, "robot_id": robot_id},
                file.options,
                epoch_s=time.time(),
                signals=tuple({**file.signals, **signals}.items()),
                faults=() if file.world is None else tuple(map(machine_fault, file.world.faults)),
            )
        )
    return configs, worlds


def line_bindings(texts: list[str], robots: int) -> dict[str, str]:
    """Return the bindings of the robot's serial ports.

    Raises:
        UsageError: an invalid binding, or several robots that would share a port.
    """
    if texts and robots > 1:
        raise UsageError(f"--serial {texts[0]}: {robots} robots cannot share a serial port; serve one robot")
    return parse_bindings(texts)


def chosen_ports(texts: list[str], names: tuple[str, ...] = NAMES) -> dict[str, int]:
    """Return ports by name from `NAME=NUMBER`; `all` means those of `names`.

    Raises:
        UsageError: not of this form.
    """
    chosen: dict[str, int] = {}
    for text in texts:
        name, _, number = text.partition("=")
        name, number = name.strip(), number.strip()
        if not (number.isascii() and number.isdecimal()):
            raise UsageError(f"--port {text}: write NAME=NUMBER, such as rtsi=40004")
        if name == ALL and int(number):
            raise UsageError(f"--port {text}: only {ALL}=0 makes sense; --instance N moves all ports")
        chosen |= dict.fromkeys(names, 0) if name == ALL else {name: int(number)}
    return chosen


def _check_ports(options: argparse.Namespace, description: RobotDescription) -> None:
    has = {row.name for row in services_of(description.firmware)}
    for text in options.port:
        name = text.partition("=")[0].strip()
        if name in NAMES and name not in has:
            major, minor = description.firmware
            raise UsageError(f"--port {text}: firmware {major}.{minor} does not have that port")


def _check_host(options: argparse.Namespace, robots: int) -> None:
    hosts_of(options.host, robots)
    if is_loopback(options.host):
        return
    if options.ssh and not options.trust_network:
        raise UsageError(
            f"--ssh --host {options.host} lets other computers log in and bridge the serial ports; nothing but the "
            "password keeps them out. Insist with --trust-network"
        )
    why = _why_not_jailed(options)
    if not why:
        _warn(f"every computer that reaches {options.host} can run programs on the robots")
        return
    if not options.trust_network:
        raise UsageError(
            f"--host {options.host} lets other computers run programs on this one, and no jail is active that would "
            f"keep them away from its files and network ({why}). Insist with --trust-network"
        )
    _warn(f"every computer that reaches {options.host} can run programs here, and no jail is active")


def _warn(text: str) -> None:
    print(f"WARNING: {shown(text)}", file=sys.stderr, flush=True)


def _why_not_jailed(options: argparse.Namespace) -> str:
    """Return why programs are not in a jail; empty if they are."""
    if is_in_process(options):
        return "the robots are in this process"
    if options.no_jail:
        return "--no-jail"
    layers, trouble = asyncio.run(probe_jail())
    if trouble or is_complete(layers):
        return trouble
    return "; ".join(f"{layer.name}: {layer.detail}" for layer in layers if not layer.is_active)


def _ports_text(server: RobotServer, place: str = "") -> str:
    ports = ", ".join(f"{name} {number}" for name, number in server.ports.items())
    release = server.link.description.firmware
    absent = [row.name for row in SERVICES if row.name not in server.ports]
    closed = f" (firmware {release[0]}.{release[1]} has no {', '.join(absent)})" if absent else ""
    return f"{server.name}{place}: {ports}{closed}"


def _on_signals(stop: asyncio.Event) -> None:
    loop = asyncio.get_running_loop()
    for number in handled_signals():
        loop.add_signal_handler(number, stop.set)


def _threadsafe(stop: asyncio.Event) -> Callable[[int], None]:
    """Return a function that sets the event from a signal handler."""
    loop = asyncio.get_running_loop()

    def set_stop(_number: int) -> None:
        with contextlib.suppress(RuntimeError):
            # The loop is closed: it has stopped already.
            loop.call_soon_threadsafe(stop.set)

    return set_stop


def _from_thread(say: Callable[[str, str], None]) -> Callable[[str, str], None]:
    """Return a function that other threads may call in its place."""
    loop = asyncio.get_running_loop()

    def said(name: str, line: str) -> None:
        with contextlib.suppress(RuntimeError):
            # The loop is closed: nothing is printed any more.
            loop.call_soon_threadsafe(say, name, line)

    return said


def missing_record(count: int) -> str:
    """Return the JSON line in the place of dropped lines."""
    text = f"{count} lines are missing here: they came faster than they could be printed"
    record = {"type": "serve", "what": "missing", "level": "problem", "text": text, "count": count}
    return jsonlines.line(record) + "\n"


class ServeLog:
    """Prints the output of a `serve`.

    Args:
        out: for messages.
        err: for problems, if the lines are text.
        names: of the robots; with several of them every line begins with the name.
        is_json: whether to print one JSON object per line.
        logs: further events for lines of text, of `report.LOGS`.
    """

    def __init__(
        self, out: Writable, err: Writable, names: list[str], *, is_json: bool, logs: Collection[str] = ()
    ) -> None:
        self._out = out
        self._err = err
        self._is_json = is_json
        self._are_several = len(names) > 1
        self._held: list[tuple[str, Event | LogLine]] | None = []
        """Events and lines before all ports were open; None afterwards."""
        self._reports: dict[str, RunReport] = {}
        self._task_states: dict[str, TaskState] = {}
        self._tallies = {name: Tally() for name in names}
        for name in names:
            if is_json:
                tag = f'{{"robot":{jsonlines.line({"": name})[4:-1]},' if self._are_several else "{"
                self._reports[name] = JsonRunReport(TaggedStream(out, "{", tag))
            else:
                tag = self._tag(name)
                self._reports[name] = TextRunReport(TaggedStream(out, "", tag), TaggedStream(err, "", tag), logs)

    def ready(
        self,
        host: str,
        session: ServeSession,
        configs: list[RobotOptions],
        reach: str,
        login: Login | None = None,
        capacity: Capacity | None = None,
    ) -> None:
        """Print that every port is open, what programs reach, how many robots fit, and then the earlier events."""
        self._print_ready(host, session, configs, reach, login, capacity)
        held, self._held = self._held or [], None
        for robot, what in held:
            self.take(robot, what)

    def _print_ready(
        self,
        host: str,
        session: ServeSession,
        configs: list[RobotOptions],
        reach: str,
        login: Login | None,
        capacity: Capacity | None,
    ) -> None:
        if self._is_json:
            robots: list[dict[str, Any]] = [
                {"robot": config.robot_id, "model": config.model, "host": at, "ports": server.ports, "ctl": address}
                for config, at, server, address in zip(
                    configs, session.hosts, session.servers, session.control_addresses, strict=True
                )
            ]
            if login is not None:
                for robot, server in zip(robots, session.servers, strict=True):
                    robot["ssh"] = {"user": login.user, "host_key": server.host_key}
                    if login.is_random:
                        robot["ssh"]["password"] = login.password
            ready = {"type": "ready", "host": host, "robots": robots, "allow_connect": reach}
            self._record(ready if capacity is None else {**ready, "cores": capacity.cores, "holds": capacity.held})
            return
        places = [f" at {at}" if at != host else "" for at in session.hosts]
        robots_text = "; ".join(map(_ports_text, session.servers, places))
        self._out.write(f"ready on {host}: {robots_text}\n")
        self._out.write(f"ctl at {', '.join(session.control_addresses)}\n")
        self._out.write(f"programs reach {'no address' if reach == NONE else reach}\n")
        if login is not None:
            password = f"password {login.password}" if login.is_random else "password as given"
            keys = ", ".join(server.host_key for server in session.servers)
            self._out.write(f"ssh: user {login.user}, {password}, host key {keys}\n")
        if capacity is not None and capacity.robots > 1:
            (self._err if capacity.is_exceeded else self._out).write(f"{capacity}\n")
        for address, usual in zip(session.control_addresses, session.usual_addresses, strict=True):
            if address != usual:
                self._err.write(
                    f"another serve has {usual}: `elitescript ctl` speaks to that one; "
                    f"to this robot with `elitescript ctl --socket {address}`\n"
                )
        self._err.flush()
        self._out.flush()

    def take(self, robot: str, what: Event | LogLine) -> None:
        """Print an event of a robot, or a line about a client, a port or time."""
        if self._held is not None:
            self._held.append((robot, what))
            return
        if not isinstance(what, LogLine):
            self._tallies[robot].take(what)
        if isinstance(what, TaskLoaded | TaskStateChanged):
            self._task(robot, what)
        elif not isinstance(what, LogLine):
            self._reports[robot].event(served(what))
            self._out.flush()
            self._err.flush()
        elif self._is_json:
            level = "problem" if what.is_problem else "info"
            details = {**what.details, "t": seconds(what.tick)}
            head = {"type": "serve", "robot": what.robot, "what": what.kind, "level": level, "text": what.text}
            self._record({**head, **details})
        elif what.is_problem or what.kind == DEVICE:
            stream = self._err if what.is_problem else self._out
            stream.write(f"{self._tag(what.robot)}{seconds(what.tick):10.3f} s  {shown(what.text)}\n")
            stream.flush()

    def _task(self, robot: str, event: TaskLoaded | TaskStateChanged) -> None:
        """Print a change of the task: loaded, started, paused, resumed, finished, stopped, ended by an alarm."""
        what = "loaded"
        if isinstance(event, TaskStateChanged):
            before = self._task_states.get(robot, TaskState.STOPPED)
            self._task_states[robot] = event.state
            is_resumed = before is TaskState.PAUSED and event.state is TaskState.PLAYING
            what = "resumed" if is_resumed else event.ending or _TASK_WORDS[event.state]
        successor = event.replaced_by if isinstance(event, TaskStateChanged) else ""
        is_end = isinstance(event, TaskStateChanged) and event.state is TaskState.STOPPED
        found = self._tallies[robot].findings if is_end else None
        if self._is_json:
            record = {"type": "task", "robot": robot, "t": seconds(event.tick), "state": what, "name": event.name}
            if found is not None:
                record["findings"] = found.counts()
            line = jsonlines.line({**record, "replaced_by": successor} if successor else record) + "\n"
            if isinstance(self._out, QueuedStream):
                # A stop shows when it acts, also where much of what the program has said before is still to be read.
                self._out.write_state(line, overtakes=what in OVERTAKING)
            else:
                self._out.write(line)
            self._out.flush()
            return
        words = "ended by an alarm" if what == "alarm" else what
        name = shown_word(event.name) or "a program without a name"
        by = f", replaced by {shown_word(successor)}" if successor else ""
        by += f", {found.words}" if found else ""
        self._out.write(f"{self._tag(robot)}{seconds(event.tick):10.3f} s  [{shown_word(words)}] {name}{by}\n")
        self._out.flush()

    def studio(self, robot: str, line: str) -> None:
        """Print what the studio of a robot says, its address above all; an empty line: it has ended."""
        stream = self._out if line else self._err
        if self._is_json:
            _, _, address = line.partition(" ")
            self._record({"type": "studio", "robot": robot, "address": address})
        else:
            said = f"{line} {robot}" if line and self._are_several else line
            stream.write(f"{shown(said or f'the studio of {robot} has ended; the robot goes on')}\n")
            stream.flush()

    def library(self, text: str) -> None:
        """Print what a library reports, which is a problem of none of the robots."""
        if self._is_json:
            self._record({"type": "serve", "what": "library", "level": "problem", "text": text})
        else:
            self._err.write(f"serve: {shown(text)}\n")
            self._err.flush()

    def _tag(self, robot: str) -> str:
        """Return the begin of the lines about a robot, by its name."""
        return f"{shown_word(robot)}: " if self._are_several else ""

    def end(self) -> None:
        """Print that everything is closed."""
        if self._is_json:
            self._record({"type": "stopped"})
        else:
            self._out.write("stopped\n")
            self._out.flush()

    def _record(self, record: dict[str, Any]) -> None:
        self._out.write(jsonlines.line(record) + "\n")
        self._out.flush()
