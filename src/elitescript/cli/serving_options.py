"""Options of the commands that serve a robot and speak to one."""

from __future__ import annotations

from elitescript.environment.allowance import OPTION, TASK_DIR_BYTES, shown_size
from elitescript.messages.timing import RPC_TIMEOUT_S

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse

SERVE_NOTE = (
    "A line that starts with `ready` names every port once all are open; then the programs' messages and errors "
    "follow. Ctrl-C ends it."
)


def add_connections(parser: argparse.ArgumentParser) -> None:
    """Add what programs reach outside: `--serial`, `--rpc-timeout`."""
    parser.add_argument(
        "--serial",
        action="append",
        default=[],
        metavar="PORT=DEVICE",
        help="what is on a serial port: tool=/dev/ttyUSB0, box=socket://HOST:PORT; may be repeated",
    )
    parser.add_argument(
        "--rpc-timeout",
        type=float,
        default=RPC_TIMEOUT_S,
        metavar="SECONDS",
        help="how long a remote procedure call waits for its answer; 0 waits for ever (default %(default)g)",
    )


def add_color(parser: argparse.ArgumentParser) -> None:
    """Add the option about colours."""
    parser.add_argument(
        "--color",
        default="auto",
        choices=["auto", "always", "never"],
        help="colours: on a terminal unless NO_COLOR is set, always, or never (default %(default)s)",
    )


def add_log(parser: argparse.ArgumentParser) -> None:
    """Add `--log`."""
    parser.add_argument(
        "--log",
        metavar="signals,channels",
        help="print these too: changes of signals, what passes on connections; --json has them always",
    )


def add_trace_signals(parser: argparse.ArgumentParser) -> None:
    """Add `--trace-signals`."""
    parser.add_argument(
        "--trace-signals",
        metavar="NAME,...|all",
        help="columns of the trace for these signals, such as standard_digital_in[3], or families: standard_digital_in",
    )


def add_task_dir_limit(parser: argparse.ArgumentParser, folder: str) -> None:
    """Add `--task-dir-limit`, which bounds what programs write into a folder."""
    parser.add_argument(
        OPTION,
        default=str(TASK_DIR_BYTES),
        metavar="SIZE",
        help=f"bytes that programs may add to {folder}, such as 500MB (default {shown_size(TASK_DIR_BYTES)})",
    )


def add_serve(
    subparsers: argparse._SubParsersAction[argparse.ArgumentParser], firmware: argparse.ArgumentParser
) -> None:
    """Add `serve`."""
    import argparse

    serve = subparsers.add_parser(
        "serve",
        parents=[firmware],
        help="the virtual controller on the network",
        description=f"Serve virtual controllers: primary port, RTSI, dashboard and the others. {SERVE_NOTE}",
    )
    serve.add_argument("--host", default="127.0.0.1", metavar="ADDRESS", help="where to listen (default %(default)s)")
    serve.add_argument(
        "--trust-network",
        action="store_true",
        help="serve other computers although no jail keeps their programs away from this one, or with --ssh",
    )
    serve.add_argument(
        "--ssh",
        action="store_true",
        help="an SSH port as well (extra `ssh`): SFTP, SCP, the log and bridges to serial ports; never a shell or a "
        "file of this computer",
    )
    serve.add_argument(
        "--ssh-password",
        metavar="TEXT|@FILE",
        help="of the user root (default: a random one, printed once); other users of this computer can read TEXT",
    )
    serve.add_argument("--instance", type=int, default=0, metavar="N", help="moves every port by 100 * N (default 0)")
    serve.add_argument(
        "--port",
        action="append",
        default=[],
        metavar="NAME=NUMBER",
        help="one port, such as rtsi=40004 (0: any free one); NAME `all` means every port; may be repeated",
    )
    serve.add_argument(
        "--robot",
        action="append",
        metavar="MODEL",
        help="arm: CS63 CS66 CS612 CS616 CS620 CS625, or a file my_arm.toml (default CS66); repeat it for more robots, "
        "each the next instance",
    )
    serve.add_argument("--robots", type=int, default=1, metavar="N", help="so many of each --robot (default 1)")
    serve.add_argument("--task-dir", metavar="DIR", help="task folder of the robots (default: an empty one in memory)")
    add_task_dir_limit(serve, "each robot's task folder")
    serve.add_argument("--power-on", action="store_true", help="begin with power on and brakes released")
    serve.add_argument("--local", action="store_true", help="begin in local control: clients may only look")
    serve.add_argument("--joints", metavar="Q1,...,Q6", help="joint positions at the start, rad")
    serve.add_argument(
        "--speed", type=float, default=1.0, metavar="0..1", help="speed slider as a fraction (default 1)"
    )
    serve.add_argument("--seed", type=int, default=0, metavar="N", help="seed of random() (default 0)")
    serve.add_argument(
        "--set", action="append", default=[], metavar="NAME=VALUE", help="signal at the start; may be repeated"
    )
    serve.add_argument(
        "--state",
        metavar="FILE",
        help="remember registers, flags and general Modbus values in this file over restarts, as the robot does; of "
        "further robots in files with a number in their names (default: nothing is remembered)",
    )
    serve.add_argument("--world", metavar="FILE.toml", help="what is around each robot, as for run")
    serve.add_argument("--cell", dest="world", help=argparse.SUPPRESS)
    add_connections(serve)
    serve.add_argument(
        "--allow-connect",
        action="append",
        default=[],
        metavar="WHAT",
        help="what programs reach: HOST[:PORT], a network such as 192.168.1.0/24, own-ports (of these robots, besides "
        "what else is allowed), any, none, default (every address except link-local ones and these robots' own ports); "
        "may be repeated (default: default)",
    )
    serve.add_argument("--in-process", action="store_true", help="keep the robots in this process instead of children")
    serve.add_argument(
        "--no-jail",
        action="store_true",
        help="do not lock the robots' processes in: programs can then do whatever you can",
    )
    serve.add_argument(
        "--journal",
        metavar="FILE",
        help="write the session down for `elitescript replay`; of further robots to files with a number in their names",
    )
    add_log(serve)
    serve.add_argument(
        "--lockstep",
        choices=["rtsi"],
        help="robot time goes on only when the RTSI clients have answered their packages (implies --in-process)",
    )
    serve.add_argument(
        "--lockstep-timeout",
        type=float,
        metavar="SECONDS",
        help="how long robot time waits for the answer of a client in lockstep before it goes on without it; inf for "
        "no limit (default 0.5)",
    )


def add_ctl(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add `ctl`."""
    ctl = subparsers.add_parser(
        "ctl",
        help="work inputs, faults, popups and tasks of a running serve",
        description="Speak to a `serve` on this computer. `elitescript ctl help` lists the verbs.",
    )
    ctl.add_argument("--instance", type=int, default=0, metavar="N", help="which robot (default 0)")
    ctl.add_argument("--socket", metavar="PATH", help="which robot, by the address that serve has printed")
    ctl.add_argument("--json", action="store_true", help="print one JSON object")
    ctl.add_argument(
        "--wait", action="store_true", help="with play: return when the task has ended; exit code 1 after an alarm"
    )
    ctl.add_argument("verb", metavar="VERB")
    ctl.add_argument("arguments", nargs="*", metavar="ARGUMENT")


def add_devices(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add `devices`."""
    devices = subparsers.add_parser(
        "devices",
        help="the devices of a world file on real ports and serial lines",
        description="Serve the devices of a world file to a real robot or to any other program: TCP devices on their "
        "ports, serial devices on pseudo-terminals or on serial ports. Ctrl-C ends it.",
    )
    devices.add_argument("file", metavar="FILE.toml", help="the world file")
    devices.add_argument("--host", default="127.0.0.1", metavar="ADDRESS", help="where to listen (default %(default)s)")
    devices.add_argument(
        "--port",
        action="append",
        default=[],
        metavar="PORT=NUMBER",
        help="another number for the port of a device, such as 502=5020 (0: any free one); may be repeated",
    )
    add_connections(devices)
    devices.add_argument("--json", action="store_true", help="print one JSON object per line")


def add_replay(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add `replay`."""
    replay = subparsers.add_parser(
        "replay",
        help="play a recorded session of serve again",
        description="Play a journal of serve --journal as fast as possible, print what the session printed, and check "
        "that every tick comes out the same. Exit code 1 if one does not.",
    )
    replay.add_argument("file", metavar="FILE", help="the journal")
    replay.add_argument("--until", type=float, metavar="SECONDS", help="stop after so much robot time")
    replay.add_argument("--json", action="store_true", help="print one JSON object per line")
    replay.add_argument("--trace", metavar="OUT.csv|OUT.jsonl", help="write a row for every tick")
    add_trace_signals(replay)
    add_log(replay)
    add_color(replay)


def add_doctor(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add `doctor`."""
    doctor = subparsers.add_parser(
        "doctor",
        help="what this computer has that serving needs",
        description="Say which layers of the jail are active, and why not; versions, ports, timers. Exit code 1 if "
        "a layer is missing.",
    )
    doctor.add_argument("--instance", type=int, default=0, metavar="N", help="look at the ports of instance N")
    doctor.add_argument("--json", action="store_true", help="print one JSON object")
