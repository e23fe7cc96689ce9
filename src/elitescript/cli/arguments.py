"""Arguments of the commands: one function for each command, called only for the one that is run.

An argument whose value is a path, or may name one, says what it `reads` or `writes`: a key of `cli.call_paths.READS` or
`WRITES`. From that its paths are checked, and shells complete its value.
"""

from __future__ import annotations

from typing import Final

from elitescript.cli.plain_call import OMITTED
from elitescript.environment.allowance import OPTION, TASK_DIR_BYTES, shown_size

TYPE_CHECKING = False
if TYPE_CHECKING:
    from argparse import ArgumentParser
    from collections.abc import Callable

    from elitescript.cli.plain_call import PlainCall

    Parser = ArgumentParser | PlainCall

FOLDER_OF_FILE: Final = "folder for open() and get_task_path() (default: FILE's folder)"


def add_run(parser: Parser) -> None:
    from elitescript.cli.robot_options import add_options
    from elitescript.environment.process import MEMORY_DEFAULT

    parser.description = (
        "Run a program to its end in virtual time. Exit code: 0 finished or stopped, 1 alarm, 2 usage, 3 the program "
        "does not compile, 4 time limit, 5 stuck, 130 Ctrl-C. With --strict 1 also if it finished with "
        "warnings of its own."
    )
    parser.add_argument(
        "file", nargs="?", metavar="FILE", reads="program", help="program text, UTF-8; with --case that of the case"
    )
    clock = "controller clock at the start: seconds since 1970 or ISO 8601"
    add_options(parser, "run", epoch_s={"help": clock})
    _add_case(parser)
    _add_generated(parser)
    parser.add_argument("--realtime", action="store_true", help="one tick per 4 ms of wall time")
    _add_until(parser)
    parser.add_argument("--max-wall", type=float, metavar="SECONDS", help="stop after so much wall time")
    parser.add_argument("--task-dir", metavar="DIR", reads="folder", help=FOLDER_OF_FILE)
    _add_task_dir_limit(parser, "the task folder")
    _add_set(parser, "signal or global at the start, e.g. standard_digital_in[3]=true; may be repeated")
    _add_world(parser, "what is around the robot: options of it, devices, wires, safety limits, inputs")
    _add_serial(parser)
    parser.add_argument(
        "--state",
        metavar="FILE",
        writes="state",
        help="begin with the registers, flags and general Modbus values of this file, and write them back at the end",
    )
    parser.add_argument(
        "--memory-limit",
        default=MEMORY_DEFAULT,
        metavar="SIZE",
        help="memory that the run may have, such as 8GiB (default %(default)s)",
    )
    parser.add_argument(
        "--trace",
        metavar="OUT.csv|jsonl|parquet",
        writes="trace",
        help="write a row for every tick; .parquet needs the extra parquet",
    )
    parser.add_argument(
        "--step",
        type=float,
        metavar="SECONDS",
        help="time between two rows of the trace, in whole control periods of 0.004 s (default 0.004)",
    )
    _add_trace_signals(parser)
    _add_log(parser)
    parser.add_argument(
        "--keep",
        metavar="all|none|KIND,...",
        default="all",
        help="kinds of events that the run keeps in memory besides writing them, such as Alarm,Warned (default all: "
        "the last 50,000 at least, about 1 MiB for an hour of moves); less is known of a run that is stuck",
    )
    _add_watch(parser)
    parser.add_argument(
        "--format",
        choices=["text", "json", "github", "sarif"],
        help="form of the report: text, JSON lines (as --json), or the findings of text and run as GitHub workflow "
        "commands or SARIF 2.1.0, with all else on standard error",
    )
    _add_color(parser)
    _add_json_lines(parser)


def add_sweep(parser: Parser) -> None:
    from elitescript.cli.robot_options import add_options
    from elitescript.environment.process import MEMORY_DEFAULT
    from elitescript.sweep.engines.executor import MAX_WALL_S
    from elitescript.sweep.failures.shrinking import BUDGET

    parser.description = (
        "Run a program many times and say what holds. Exit code: 0 all hold, 1 something failed, 2 usage, 3 the "
        "program does not compile, 130 Ctrl-C."
    )
    parser.add_argument("file", metavar="FILE", reads="program", help="program text, UTF-8")
    _add_generated(parser)
    parser.add_argument(
        "--vary",
        action="append",
        default=[],
        metavar="NAME=KIND(...)",
        help="a signal, a constant or global of the program, or a world setting such as box.table.x, of FILE.task also "
        "task.NAME and installation.NAME: uniform(a,b), normal(mean,deviation), choice(a,b,...), grid(a,b,points); "
        "may be repeated",
    )
    parser.add_argument(
        "--runs", type=int, metavar="N", help="number of runs (default: every grid point once, else 100)"
    )
    parser.add_argument(
        "--seed", dest="sweep_seed", type=int, default=0, metavar="N", help="of everything that is drawn (default 0)"
    )
    parser.add_argument(
        "--ensure",
        action="append",
        default=[],
        metavar="EXPRESSION|FILE.py:FUNCTION",
        reads="expression",
        help="what must hold in every run; may be repeated (default: never_stuck and no_alarm)",
    )
    parser.add_argument(
        "--measure",
        action="append",
        default=[],
        metavar="NAME=EXPRESSION",
        reads="expression",
        help="a column of numbers; may be repeated",
    )
    parser.add_argument(
        "--chaos",
        metavar="PROFILE",
        reads="profile",
        help="what goes wrong: channels, inputs, stops, people, all, or FILE.toml",
    )
    parser.add_argument("--margins", action="store_true", help="a column with the margin of each property")
    parser.add_argument(
        "--step", type=float, metavar="SECONDS", help="time between two rows of a moving arm that properties see"
    )
    parser.add_argument(
        "--out", metavar="FILE.csv|jsonl|parquet", writes="table", help="table of the runs, in their order"
    )
    parser.add_argument(
        "--page",
        metavar="FILE.html",
        writes="page of a sweep",
        help="a page with plots and failures; replays are in the folder FILE.replays",
    )
    _add_force(parser)
    parser.add_argument("--only", type=int, metavar="RUN", help="only the run of this number; with --page, its replay")
    parser.add_argument(
        "--resume", action="store_true", help="go on with a sweep that was ended, or with more runs than its table has"
    )
    parser.add_argument(
        "--no-cases",
        action="store_true",
        help="write no CASE.toml, and shrink no failure, nor play those that are there",
    )
    parser.add_argument(
        "--shrink-runs",
        type=int,
        default=BUDGET,
        metavar="N",
        help="runs that making one failure smaller may take (default %(default)s); 0 leaves failures as they are",
    )
    parser.add_argument("--jobs", type=int, metavar="N", help="processes (default: one for each processor)")
    parser.add_argument(
        "--dask",
        metavar="tcp://HOST:PORT",
        help="run on this Dask cluster instead of on this computer; needs the extra `cluster`",
    )
    parser.add_argument(
        "--mixed",
        action="store_true",
        help="take workers of the cluster whose processor or C library has another last digit in sine and cosine",
    )
    _add_search(parser)
    add_options(parser, "sweep")
    _add_until(parser, "end a run after so much virtual time")
    parser.add_argument(
        "--max-wall",
        type=float,
        default=MAX_WALL_S,
        metavar="SECONDS",
        help="give up a run after so much wall time (default %(default)g)",
    )
    parser.add_argument(
        "--memory-limit",
        default=MEMORY_DEFAULT,
        metavar="SIZE",
        help="memory that a process may have, such as 8GiB (default %(default)s)",
    )
    parser.add_argument("--task-dir", metavar="DIR", reads="folder", help=f"{FOLDER_OF_FILE}; each run has a copy")
    _add_set(parser, "signal or global at the start of every run; may be repeated")
    _add_world(parser, "what is around the robot, as for run")
    _add_color(parser)
    _add_json_lines(parser)


def _add_search(parser: Parser) -> None:
    parser.add_argument(
        "--minimise",
        metavar="EXPRESSION",
        reads="expression",
        help="look for the values of --over that make this measure smallest, with as "
        "many runs as --runs says, while every --ensure holds; needs the extra `optimise`",
    )
    parser.add_argument("--maximise", metavar="EXPRESSION", reads="expression", help="the same, largest")
    parser.add_argument(
        "--over",
        nargs="+",
        action="extend",
        default=[],
        metavar="NAME=KIND(...)",
        help="what may change: named as for --vary; uniform, choice or grid",
    )
    parser.add_argument(
        "--repeat",
        type=int,
        default=1,
        metavar="N",
        help="runs of each candidate, with other values of --vary and --chaos",
    )
    parser.add_argument("--worst", action="store_true", help="of these the worst counts, not the mean")


def add_check(parser: Parser) -> None:
    from elitescript.cli.robot_options import add_options

    parser.description = (
        "Report every problem with its place, code, text and hint. Exit code: 0 no errors, 2 usage, or a file of this "
        "call cannot be read, 3 errors."
    )
    parser.add_argument(
        "files",
        nargs="*",
        metavar="FILE",
        reads="programs",
        help="programs, folders (every *.script in them), or - for standard input",
    )
    _add_generated(parser)
    add_options(
        parser, "check", model={"help": "arm that the programs are for, with its limits and its reach (default: any)"}
    )
    _add_watch(parser)
    parser.add_argument(
        "--format",
        choices=["text", "json", "github", "sarif"],
        help="form of the report: text, JSON lines (as --json), GitHub workflow commands, SARIF 2.1.0",
    )
    parser.add_argument(
        "--fix", action="store_true", writes="programs", help="make the repairs that are safe; of - to standard output"
    )
    parser.add_argument(
        "--baseline",
        metavar="FILE",
        writes="baseline",
        help="leave out the findings of this file, which are known; a file that does not exist is written with all "
        "that is found now",
    )
    parser.add_argument("--explain", metavar="CODE", help="say what a code such as E303 means, with an example")
    parser.add_argument(
        "--reach",
        action="store_true",
        help="list every address, port, serial port and file that the programs name, and whether the options let it "
        "through, in place of problems",
    )
    _add_serial(parser)
    parser.add_argument(
        "--world",
        metavar="FILE",
        reads="world",
        help="what is around the robot: its options and the joint ranges of its safety count",
    )
    _add_color(parser)
    _add_json_lines(parser)


def add_fmt(parser: Parser) -> None:
    parser.description = (
        "Lay out programs: two blanks for each block, `end` below what it closes, one blank around operators and "
        "behind commas. What runs stays the same, and every statement stays in its line. A program with syntax errors "
        "stays as it is. Exit code: 0 done, 1 with --check: a file is not formatted, 2 usage, or a file of this call "
        "cannot be read, 3 syntax errors."
    )
    parser.add_argument(
        "files",
        nargs="*",
        metavar="FILE",
        reads="programs",
        writes="programs",
        help="programs, folders (every *.script in them), or - to format standard input to standard output",
    )
    parser.add_argument("--check", action="store_true", help="change nothing; exit code 1 if a file is not formatted")
    parser.add_argument("--diff", action="store_true", help="change nothing; print what would change, as a diff")
    parser.add_argument(
        "--pendant", action="store_true", help="format programs that the pendant has written, with `$ LINE` marks, too"
    )
    _add_color(parser)


def add_task(parser: Parser) -> None:
    parser.description = (
        "Print the script of a graphical program as the pendant generates it, its tree, or what differs between two; "
        "make a new task, or one that holds a script. Exit code: 0 done, 1 with --diff: the trees differ, 2 usage, or "
        "a file cannot be read, 3 a node cannot be generated."
    )
    parser.add_argument(
        "file", nargs="?", metavar="FILE", reads="task", help="a .task file; or a .script file that becomes a task"
    )
    parser.add_argument(
        "-o", "--output", metavar="OUT", writes="text", help="write to this file instead of standard output"
    )
    parser.add_argument("--tree", action="store_true", help="print the tree: row, kind, name and values of each node")
    parser.add_argument("--json", action="store_true", help="print the tree as one JSON object")
    parser.add_argument(
        "--diff", metavar="OTHER", reads="other task", help="print what differs in another task, node by node"
    )
    parser.add_argument("--new", metavar="NAME", help="make an empty task of this name; needs -o")
    parser.add_argument(
        "--robot", default="CS66", metavar="MODEL", reads="arm", help="of a new task (default %(default)s)"
    )
    parser.add_argument(
        "--task-dir",
        metavar="DIR",
        reads="folder",
        help="folder below which a task names the folder of its configuration (default: that of FILE)",
    )


def add_plot(parser: Parser) -> None:
    from elitescript.cli.robot_options import add_options

    parser.description = (
        "Run a program, or read the trace of a run, and write one HTML page with path, joints, time line and cycle "
        "time by line. Runs of more than 800 s are sampled less often than every control period. Exit code of a "
        "program: as for run."
    )
    parser.add_argument(
        "file",
        nargs="?",
        metavar="FILE",
        reads="program or trace",
        help="a program, or a trace: OUT.csv or OUT.jsonl of run --trace",
    )
    parser.add_argument(
        "-o",
        "--output",
        metavar="OUT.html",
        default="",
        writes="page of a plot",
        help="the page (default: NAME.plot.html, in this folder)",
    )
    _add_force(parser)
    _add_case(parser)
    _add_generated(parser)
    add_options(parser, "plot", model={"help": "arm whose limits are drawn, or its file (default CS66)"})
    _add_until(parser, "stop after so much virtual time (default 300)")
    parser.add_argument("--task-dir", metavar="DIR", reads="folder", help=FOLDER_OF_FILE)
    _add_set(parser, "signal or global at the start; may be repeated")
    _add_world(parser, "what is around the robot, as for run")
    parser.add_argument(
        "--compare",
        metavar="OTHER",
        reads="compared",
        help="lay a second run over the first: another program, or a trace",
    )
    parser.add_argument(
        "--compare-robot",
        metavar="MODEL",
        reads="arm",
        help="arm of the second run; without --compare: of the same program",
    )
    parser.add_argument(
        "--compare-world", metavar="WORLD.toml", reads="world", help="world of the second run, in the same way"
    )
    _add_color(parser)


def add_serve(parser: Parser) -> None:
    from elitescript.cli.robot_options import add_options, help_text

    parser.description = (
        "Serve virtual controllers: primary port, RTSI, dashboard and the others. A line that starts with `ready` "
        "names every port once all are open; then the programs' messages and errors follow. Ctrl-C ends it."
    )
    parser.add_argument(
        "--host",
        default="127.0.0.1",
        metavar="ADDRESS",
        help="where to listen (default %(default)s); 127.0.0.11-13: three --robots, each with an own address and "
        "the usual ports",
    )
    parser.add_argument(
        "--trust-network",
        action="store_true",
        help="serve other computers although no jail keeps their programs away from this one, or with --ssh",
    )
    parser.add_argument(
        "--ssh",
        action="store_true",
        help="an SSH port as well (extra `ssh`): SFTP, SCP, the log and bridges to serial ports; never a shell or a "
        "file of this computer",
    )
    parser.add_argument(
        "--ssh-password",
        metavar="TEXT|@FILE",
        reads="password",
        help="of the user root (default: a random one, printed once); other users of this computer can read TEXT",
    )
    parser.add_argument("--instance", type=int, default=0, metavar="N", help="moves every port by 100 * N (default 0)")
    parser.add_argument(
        "--port",
        action="append",
        default=[],
        metavar="NAME=NUMBER",
        help="one port, such as rtsi=40004 (0: any free one); NAME `all` means every port; may be repeated",
    )
    add_options(
        parser,
        "serve",
        model={
            "action": "append",
            "dest": "models",
            "default": [],
            "help": f"{help_text('model')}; repeat it for more robots, each the next instance",
        },
        remote={"help": "begin in local control: clients may only look"},
    )
    parser.add_argument("--robots", type=int, default=1, metavar="N", help="so many of each --robot (default 1)")
    parser.add_argument(
        "--task-dir", metavar="DIR", reads="folder", help="task folder of the robots (default: an empty one in memory)"
    )
    _add_task_dir_limit(parser, "each robot's task folder")
    _add_set(parser, "signal at the start; may be repeated")
    parser.add_argument(
        "--state",
        metavar="FILE",
        writes="state",
        help="remember registers, flags and general Modbus values in this file over restarts, as the robot does; of "
        "further robots in files with a number in their names (default: nothing is remembered)",
    )
    parser.add_argument(
        "--studio",
        action="store_true",
        help="the studio as well, a page on this computer with a pendant for each robot; needs the extra `studio`",
    )
    _add_world(parser, "what is around each robot, as for run")
    _add_serial(parser)
    parser.add_argument(
        "--allow-connect",
        action="append",
        default=[],
        metavar="WHAT",
        help="what programs reach: HOST[:PORT], a network such as 192.168.1.0/24, own-ports (of these robots, besides "
        "what else is allowed), any, none, default (every address except link-local ones and these robots' own ports); "
        "may be repeated (default: default)",
    )
    parser.add_argument("--in-process", action="store_true", help="keep the robots in this process instead of children")
    parser.add_argument(
        "--no-jail",
        action="store_true",
        help="do not lock the robots' processes in: programs can then do whatever you can",
    )
    parser.add_argument(
        "--journal",
        metavar="FILE",
        writes="session",
        help="write the session down for `elitescript replay`; of further robots to files with a number in their names",
    )
    _add_log(parser)
    parser.add_argument(
        "--lockstep",
        choices=["rtsi"],
        help="robot time goes on only when the RTSI clients have answered their packages (implies --in-process)",
    )
    parser.add_argument(
        "--lockstep-timeout",
        type=float,
        metavar="SECONDS",
        help="how long robot time waits for the answer of a client in lockstep before it goes on without it; inf for "
        "no limit (default 0.5)",
    )
    _add_json_lines(parser)


def add_ctl(parser: Parser) -> None:
    parser.description = "Speak to a `serve` on this computer. `elitescript ctl help` lists the verbs."
    parser.add_argument("--instance", type=int, default=0, metavar="N", help="which robot (default 0)")
    parser.add_argument(
        "--socket", metavar="PATH", reads="address", help="which robot, by the address that serve has printed"
    )
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    parser.add_argument(
        "--wait", action="store_true", help="with play: return when the task has ended; exit code 1 after an alarm"
    )
    parser.add_argument("verb", metavar="VERB")
    parser.add_argument("arguments", nargs="*", metavar="ARGUMENT")


def add_devices(parser: Parser) -> None:
    parser.description = (
        "Serve the devices of a world file to a real robot or to any other program: TCP devices on their ports, serial "
        "devices on pseudo-terminals or on serial ports. Ctrl-C ends it."
    )
    parser.add_argument("file", metavar="FILE.toml", reads="world", help="the world file")
    parser.add_argument("--host", default="127.0.0.1", metavar="ADDRESS", help="where to listen (default %(default)s)")
    parser.add_argument(
        "--port",
        action="append",
        default=[],
        metavar="PORT=NUMBER",
        help="another number for the port of a device, such as 502=5020 (0: any free one); may be repeated",
    )
    _add_serial(parser)
    _add_json_lines(parser)


def add_replay(parser: Parser) -> None:
    parser.description = (
        "Play a journal of serve --journal as fast as possible, print what the session printed, and check that every "
        "tick comes out the same. Exit code 1 if one does not."
    )
    parser.add_argument("file", metavar="FILE", reads="session", help="the journal")
    _add_until(parser, "stop after so much robot time")
    parser.add_argument(
        "--trace",
        metavar="OUT.csv|jsonl|parquet",
        writes="trace",
        help="write a row for every tick; .parquet needs the extra parquet",
    )
    _add_trace_signals(parser)
    _add_log(parser)
    _add_color(parser)
    _add_json_lines(parser)


def add_dap(parser: Parser) -> None:
    parser.description = (
        "Debug programs for an editor: the Debug Adapter Protocol on standard input and output. What to run, and with "
        "which robot, is in the editor's launch configuration."
    )
    parser.add_argument(
        "--tcp",
        type=int,
        metavar="PORT",
        help="listen on a port of this computer instead, for one editor after the other (0: any free one, printed)",
    )


def add_doctor(parser: Parser) -> None:
    parser.description = (
        "Say which layers of the jail are active, and why not; versions, ports, timers. Exit code 1 if a layer is "
        "missing."
    )
    parser.add_argument("--instance", type=int, default=0, metavar="N", help="look at the ports of instance N")
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def add_lsp(parser: Parser) -> None:
    parser.description = (
        "Serve one editor with the Language Server Protocol, on standard input and output: findings while typing, "
        "completion, hover, rename, layout, times of the last run. How to set up editors: docs/how-to/editors.md. "
        "Needs: pip install 'elitescript[lsp]'"
    )
    parser.add_argument(
        "--tcp",
        type=int,
        metavar="PORT",
        help="serve the first client of this port of 127.0.0.1 instead (0: any free one)",
    )
    parser.add_argument("--stdio", action="store_true", help="the default; many editors add it by themselves")


def add_mcp(parser: Parser) -> None:
    parser.description = (
        "Serve one agent on standard input and output with the Model Context Protocol: check, run, sample and step "
        "through programs, explain codes, look commands up. Only files in FOLDER can be named; nothing outside the "
        "robot is real. Needs: pip install 'elitescript[mcp]'"
    )
    parser.add_argument(
        "folder", nargs="?", default=".", metavar="FOLDER", reads="folder", help="folder of programs (default: this)"
    )
    parser.add_argument(
        "--max-wall",
        type=float,
        default=30.0,
        metavar="SECONDS",
        help="end a call that takes more wall time (default %(default)s)",
    )


def add_studio(parser: Parser) -> None:
    from elitescript.cli.robot_options import add_options

    parser.description = (
        "Serve the studio, a page on this computer: it checks and runs the program again with every edit, and shows "
        "path, time line, signals and messages. A line `ready ADDRESS` names the page once it is there. Ctrl-C ends "
        "it. Needs: pip install 'elitescript[studio]'"
    )
    parser.add_argument(
        "path",
        nargs="?",
        metavar="FILE|FOLDER",
        reads="folder",
        writes="edited",
        help="a program, which need not exist yet, or a folder of programs (default: this one; with --connect none)",
    )
    parser.add_argument(
        "--port", type=int, default=0, metavar="N", help="port of this computer (default: any free one)"
    )
    parser.add_argument("--no-browser", action="store_true", help="only print the address of the page")
    add_options(parser, "studio")
    _add_world(parser, "what is around the robot, as for run")
    parser.add_argument(
        "--urdf",
        metavar="FILE",
        reads="urdf",
        help="draw the arm from this URDF, with the meshes in the folder of the file",
    )
    parser.add_argument(
        "--connect", metavar="HOST", help="show the controller at this address through its ordinary ports instead"
    )
    parser.add_argument("--control", action="store_true", help="with --connect: commands too, not only looking")
    parser.add_argument(
        "--instance", type=int, default=0, metavar="N", help="with --connect: which robot of a serve (default 0)"
    )
    parser.add_argument(
        "--socket",
        metavar="PATH",
        reads="address",
        help="with --connect: the ctl address of a robot that is served on this computer",
    )
    parser.add_argument(
        "--ends-with-input",
        action="store_true",
        help="end when standard input ends, as with the process that has started it",
    )
    parser.add_argument(
        "--jog-register",
        type=int,
        metavar="N",
        help="with --control: first of the RTSI input registers that jogging writes, two integer and six float ones "
        "(default 40)",
    )


def add_audit(parser: Parser) -> None:
    from elitescript.cli.robot_options import add_options

    parser.description = (
        "Run the program of a recording on the simulated robot, with the recorded inputs, and say where both part: "
        "target joints, times, signals. Exit code: 0 they agree, 1 they differ or the recording is not "
        "complete, 2 usage. Needs: pip install 'elitescript[mcap]'"
    )
    parser.add_argument("file", metavar="RUN.mcap", reads="recording", help="a recording of `elitescript record`")
    parser.add_argument(
        "--program", metavar="FILE", reads="program", help="the program that ran (default: the one in the recording)"
    )
    _add_generated(parser)
    add_options(
        parser,
        "audit",
        model={
            "help": "arm, or its file (default: the arm file in the recording, that of the world, the recorded model)"
        },
    )
    _add_world(parser, "what is around the robot (default: the world file in the recording)")
    parser.add_argument(
        "--run", default="all", metavar="N|all", help="which run of a program in the recording (default %(default)s)"
    )
    parser.add_argument(
        "--partial", action="store_true", help="a recording that begins or ends within the program may agree too (0)"
    )
    _add_tolerance(parser)
    parser.add_argument(
        "--fit", metavar="MY_ARM.toml", writes="arm", help="write an arm file with what the recording determines"
    )
    parser.add_argument(
        "--page", metavar="OUT.html", writes="page", help="write a page that lays both runs over each other"
    )
    _add_force(parser)
    _add_color(parser)
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def add_fit(parser: Parser) -> None:
    parser.description = (
        "Find the lengths of an arm from points that are known as joints and as pose: those of programs "
        "(get_inverse_kin(pose, qnear=joints), pick_q and pick_p), or of a file. Exit code: 0 the model agrees, 1 it "
        "differs, 2 usage."
    )
    parser.add_argument("files", nargs="*", metavar="FILE", reads="programs", help="programs of one arm")
    parser.add_argument(
        "--pairs",
        action="append",
        default=[],
        metavar="FILE",
        reads="points",
        help="points of the same arm: CSV with q1 to q6 (rad) and x, y, z, rx, ry, rz (m, rad), or JSON with a list of "
        '{"q": [...], "pose": [...]}; may be repeated',
    )
    parser.add_argument(
        "--robot",
        default="CS66",
        metavar="MODEL",
        reads="arm",
        help="model to begin with, or its file (default %(default)s)",
    )
    parser.add_argument(
        "--tcp", metavar="X,Y,Z,RX,RY,RZ", help="TCP offset of the poses, m and rad (default: set_tcp of the program)"
    )
    parser.add_argument("--zeros", action="store_true", help="find the zeros of the joints as well")
    parser.add_argument("--out", metavar="MY_ARM.toml", writes="arm", help="write an arm file for --robot")
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def add_record(parser: Parser) -> None:
    parser.description = (
        "Write down what a controller shows: RTSI, states and messages of the primary port, answers of the dashboard, "
        "into MCAP. It only reads, and needs no program on the robot. Ctrl-C ends it. Exit code: 0 recorded, 1 the "
        "recording cannot be kept, 2 usage, or nothing answers at the address. Needs: pip install 'elitescript[mcap]'"
    )
    parser.add_argument("host", metavar="HOST", help="name or address of the controller")
    parser.add_argument(
        "--out",
        metavar="RUN.mcap",
        default="run.mcap",
        writes="recording",
        help="the file, which must not exist (default %(default)s)",
    )
    parser.add_argument(
        "--for", dest="seconds", type=float, metavar="SECONDS", help="end so long after the first connection"
    )
    parser.add_argument(
        "--program", metavar="FILE", reads="program", help="the program that runs there, to be kept in the recording"
    )
    _add_fetching(parser)
    parser.add_argument(
        "--world", metavar="FILE.toml", reads="world", help="what is around the robot, to be kept in the recording"
    )
    parser.add_argument(
        "--robot", metavar="MODEL", reads="arm", help="model of the arm, or its file, which is kept in the recording"
    )
    parser.add_argument(
        "--rotate",
        metavar="SIZE|SECONDS",
        help="begin another file, RUN.0001.mcap and so on, at this size (500MB) or after this time (3600s)",
    )
    parser.add_argument(
        "--rate", type=float, default=250.0, metavar="HZ", help="rows a second to ask for (default 250)"
    )
    _add_read_ports(parser)
    _add_color(parser)


def add_shadow(parser: Parser) -> None:
    from elitescript.cli.robot_options import add_options

    parser.description = (
        "Follow a controller, run its program on the simulated robot beside it, and say within a second where both "
        "part. It only reads. Ctrl-C ends it. Exit code: 0 they agreed, 1 they parted, 2 usage, or nothing answers "
        "at the address."
    )
    parser.add_argument("host", metavar="HOST", help="name or address of the controller")
    parser.add_argument("--program", metavar="FILE", reads="program", help="the program that runs there")
    _add_fetching(parser)
    add_options(
        parser,
        "shadow",
        model={"help": "arm, or its file (default: that of the world, else the one that the controller names)"},
        speed={"help": "speed slider that is expected, as a fraction (default 1)"},
    )
    _add_world(parser, "what is around the robot: its devices answer the simulated program")
    parser.add_argument(
        "--payload",
        metavar="KG[,X,Y,Z]",
        help="payload that is expected when a program begins, with its centre in m (default: what the arm has then)",
    )
    _add_tolerance(parser)
    parser.add_argument(
        "--wait",
        type=float,
        default=30.0,
        metavar="SECONDS",
        help="so long a program may wait in one place, unless it sleeps (default 30)",
    )
    parser.add_argument(
        "--for", dest="seconds", type=float, metavar="SECONDS", help="end so long after the first connection"
    )
    _add_read_ports(parser)
    _add_color(parser)
    _add_json_lines(parser)


def add_commands(parser: Parser) -> None:
    parser.description = (
        "Print the list of all robot commands, one command in full, or those that a word finds in names, parameters "
        "and descriptions. Exit code 2 if it finds none."
    )
    parser.add_argument(
        "name", nargs="?", metavar="WORD", help="a command, or a word to look for in all of them; all if left out"
    )
    parser.add_argument("--json", action="store_true", help="print one JSON array with all that is known of each")


def add_completion(parser: Parser) -> None:
    parser.description = (
        "Print a script that lets a shell complete calls of elitescript: commands, options, values, files. For bash: "
        "source <(elitescript completion bash), also in ~/.bashrc."
    )
    parser.add_argument("shell", metavar="SHELL", help="bash, zsh or fish")


COMMANDS: Final[dict[str, tuple[str, Callable[[Parser], None]]]] = {
    "run": ("run a program to its end in virtual time", add_run),
    "sweep": ("run a program many times and say what holds", add_sweep),
    "check": ("report every problem of programs without running them", add_check),
    "fmt": ("lay out programs without changing what they do", add_fmt),
    "task": ("graphical programs: their script, their tree, differences, new ones", add_task),
    "plot": ("write a page that shows a program's run, or a trace", add_plot),
    "serve": ("the virtual controller on the network", add_serve),
    "ctl": ("work inputs, faults, popups and tasks of a running serve", add_ctl),
    "devices": ("the devices of a world file on real ports and serial lines", add_devices),
    "replay": ("play a recorded session of serve again", add_replay),
    "audit": ("hold a recording of a controller against the simulated robot", add_audit),
    "record": ("write down what a controller shows, without touching the robot", add_record),
    "shadow": ("follow a controller with its program beside it, and say where they part", add_shadow),
    "dap": ("debug programs for an editor, back and forth in time", add_dap),
    "doctor": ("what this computer has that serving needs", add_doctor),
    "lsp": ("what editors show of programs, by the Language Server Protocol", add_lsp),
    "mcp": ("check, run and step through programs for agents", add_mcp),
    "studio": ("a page that shows the program while it is written, or a controller", add_studio),
    "fit": ("lengths of an arm from points with joints and pose", add_fit),
    "commands": ("the catalogue of robot commands", add_commands),
    "completion": ("completion of calls for bash, zsh and fish", add_completion),
}
"""Every command: its summary in the list of commands, and the function that adds its arguments."""


# ---------------------------------------------------------------- arguments of several commands


def _add_json_lines(parser: Parser) -> None:
    parser.add_argument("--json", action="store_true", help="print one JSON object per line")


def _add_tolerance(parser: Parser) -> None:
    parser.add_argument(
        "--tolerance",
        action="append",
        default=[],
        metavar="RAD|NAME=VALUE",
        help="what does not count: joints=0.001 (rad), time=0.008 (s) or share=0.01 of a duration, whichever is more",
    )


def _add_fetching(parser: Parser) -> None:
    parser.add_argument(
        "--fetch-program",
        metavar="PATH",
        reads="elsewhere",
        help="read the program from this path of the controller instead, by SFTP (extra `ssh`); needs --ssh-password",
    )
    parser.add_argument(
        "--ssh-password",
        metavar="TEXT|@FILE",
        reads="password",
        help="of the user root of the controller, for --fetch-program",
    )


def _add_read_ports(parser: Parser) -> None:
    parser.add_argument("--instance", type=int, default=0, metavar="N", help="moves every port by 100 * N (default 0)")
    parser.add_argument(
        "--port",
        action="append",
        default=[],
        metavar="NAME=NUMBER",
        help="one port of rtsi, primary and dashboard, such as rtsi=40004; may be repeated",
    )


def _add_until(parser: Parser, text: str = "stop after so much virtual time") -> None:
    parser.add_argument("--until", type=float, metavar="SECONDS", help=text)


def _add_watch(parser: Parser) -> None:
    parser.add_argument(
        "--watch",
        action="store_true",
        help="do it again whenever a file has changed: the program, what it names in its task folder, world file, arm "
        "file; Ctrl-C ends it",
    )


def _add_generated(parser: Parser) -> None:
    parser.add_argument(
        "--generated",
        action="store_true",
        help="of FILE.task, the script that the pendant has written beside it, FILE.task.script, instead of the tree",
    )


def _add_case(parser: Parser) -> None:
    parser.add_argument(
        "--case",
        metavar="CASE.toml",
        reads="case",
        help="play a run again that failed in a sweep, with all that went wrong in it",
    )


def _add_set(parser: Parser, text: str) -> None:
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", help=text)


def _add_world(parser: Parser, text: str) -> None:
    parser.add_argument("--world", metavar="FILE.toml", reads="world", help=text)
    parser.add_argument("--cell", dest="world", reads="world", help=OMITTED)


def _add_serial(parser: Parser) -> None:
    parser.add_argument(
        "--serial",
        action="append",
        default=[],
        metavar="PORT=DEVICE",
        reads="device",
        help="what is on a serial port: tool=/dev/ttyUSB0, box=socket://HOST:PORT; may be repeated",
    )


def _add_task_dir_limit(parser: Parser, folder: str) -> None:
    parser.add_argument(
        OPTION,
        default=str(TASK_DIR_BYTES),
        metavar="SIZE",
        help=f"bytes that programs may add to {folder}, such as 500MB (default {shown_size(TASK_DIR_BYTES)})",
    )


def _add_color(parser: Parser) -> None:
    parser.add_argument(
        "--color",
        default="auto",
        choices=["auto", "always", "never"],
        help="colours: on a terminal unless NO_COLOR is set, always, or never (default %(default)s)",
    )


def _add_log(parser: Parser) -> None:
    parser.add_argument(
        "--log",
        metavar="signals,channels",
        help="print these too: changes of signals, what passes on connections; --json has them always",
    )


def _add_trace_signals(parser: Parser) -> None:
    parser.add_argument(
        "--trace-signals",
        metavar="NAME,...|all",
        help="columns of the trace for these signals, such as standard_digital_in[3], or families: standard_digital_in",
    )


def _add_force(parser: Parser) -> None:
    parser.add_argument(
        "--force", action="store_true", help="let the page replace a file that is no page of elitescript"
    )
