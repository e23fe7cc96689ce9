"""The reference page of the ports, from the table of services."""

from __future__ import annotations

from inspect import signature

from elitescript.debugger.living import EVENTS, REQUESTS, LivingDebugger
from elitescript.kernel.external_control import PORT as SENDER_PORT
from elitescript.messages.timing import TICKS_PER_S
from elitescript.protocol.ports import SERVICES
from elitescript.services.capacity import ROBOTS_IN_PROCESS, ROBOTS_PER_CORE
from elitescript.services.channels.broker import CHANNELS_MAX
from elitescript.services.channels.connect_policy import DEFAULT_TEXT
from elitescript.services.clients import binding, listener, liveness, shares, tcp
from elitescript.services.control.verbs import VERBS
from elitescript.services.port_numbers import PORTS_PER_INSTANCE, SSH
from elitescript.services.ssh import commands as ssh_commands
from elitescript.services.time.cycle import CATCH_UP_TICKS
from elitescript.services.time.lockstep import PATIENCE_FACTOR, PATIENCE_MIN_S, TRUSTED_ANSWERS
from elitescript.services.time.lockstep import TIMEOUT_S as LOCKSTEP_TIMEOUT_S
from tools.markdown import NOTICE, cell

_PAGES = {
    "dashboard": "dashboard.md",
    "primary": "primary.md",
    "rtsi": "rtsi.md",
    "interpreter": "interpreter.md",
    "query": "interpreter.md",
    "modbus": "modbus.md",
    "ssh": "../how-to/ssh.md",
}


def ports_page() -> str:
    """Ports, what every port promises, and the verbs of `ctl`."""
    lines = [
        "# Ports",
        "",
        NOTICE,
        "What `elitescript serve` opens. `--port NAME=NUMBER` moves one, `--port all=0` takes free ones,",
        f"`--instance N` moves all of them by {PORTS_PER_INSTANCE} * N; further robots of one `serve` have the",
        "next instances.",
        "",
        "| name | port | what it serves | firmware | evidence |",
        "|---|---:|---|---|---|",
    ]
    for row in SERVICES:
        name = f"[`{row.name}`]({_PAGES[row.name]})" if row.name in _PAGES else f"`{row.name}`"
        since = f"{row.since[0]}.{row.since[1]} and later" if any(row.since) else "all"
        lines.append(f"| {name} | {row.number} | {cell(row.summary)} | {since} | {cell(row.evidence)} |")
    name = f"[`{SSH.name}`]({_PAGES[SSH.name]})"
    lines.append(f"| {name} | {SSH.number} | {cell(SSH.summary)} | all | {cell(SSH.evidence)} |")
    backlog, most = tcp.SAMPLE_BACKLOG // 1024, tcp.BACKLOG_MAX // 1024
    stalled_s = tcp.STALLED_TICKS // TICKS_PER_S
    lines += [
        "",
        "With an older `--firmware` a port stays closed, and the `ready` line says so (*assumed*: what a controller of",
        "that firmware does there is not known).",
        "",
        "## What every port promises (*assumed*)",
        "",
        "- A message is one write, without delay (`TCP_NODELAY`).",
        f"- Up to {listener.CLIENTS_MAX} clients for each port; more are accepted and closed at once.",
        f"  No more than {listener.ACCEPTS_PER_TICK} are accepted in a tick; {binding.BACKLOG} may wait for that.",
        f"  What `ssh` has instead stands on [its page]({_PAGES[SSH.name]}).",
        f"- A client whose computer has vanished is let go after {liveness.UNTAKEN_S} s without a sign of life",
        "  (TCP keepalive), and what it had claimed is free.",
        "- What arrives counts from the next tick of 4 ms; what a tick gives leaves at once.",
        "- A client that reads too slowly misses packages of its stream when more than",
        f"  {backlog} KiB wait for it. It is cut off when {most} KiB wait, or when it has taken nothing for",
        f"  {stalled_s} s. Other clients do not wait.",
        f"- Of what one client sends, so much is read in a tick as takes {shares.SHARE_NS / 1e6:g} ms, of all clients",
        f"  together {shares.READ_BUDGET_NS / 1e6:g} ms; the rest stays in the sockets. Clients that send little",
        "  are read first. The socket of `ctl` keeps to this, too.",
        "- More requests than the robot can do in a tick wait: in the order of each client, in turns",
        "  between clients.",
        "- What cannot be understood as the protocol of the port closes that one connection.",
        "- A connection that begins as a web browser's does (HTTP with any method, TLS, STUN) is closed before",
        "  anything of it counts.",
        "- A client that ends its own half of the connection is answered what it has asked; a program that",
        "  it has begun counts as sent. The state of the primary port goes on for it.",
        "",
        "## Time",
        "",
        "A tick that begins 4 ms late or more is an *overrun*; `elitescript ctl state` shows how many there",
        f"were. Ticks that were missed are made up for at once, up to {CATCH_UP_TICKS}; beyond that they are left",
        "out, and a line says so. A robot of which 1 % of the time was late or left out is named in a line with that",
        "share, after ten seconds and then once a minute. `timestamp` of RTSI counts ticks: where ticks were left out",
        "it goes on without a gap, and falls behind the wall clock by 4 ms for each; a package that comes late has the",
        "time of its tick; one that repeats the last has that one's. So its steps are those of the robot, and the",
        "difference to the client's clock grows by what the server could not do.",
        f"`serve` says at the start how many robots fit: {ROBOTS_PER_CORE} for each core in children,",
        f"{ROBOTS_IN_PROCESS} with `--in-process`, each with a client at 250 Hz and its arm at rest.",
        "",
        "`--lockstep rtsi`: robot time waits for RTSI clients. A client that has set up an output recipe takes part",
        "from its first input package (`U`) after the start (`S`) on, until it pauses (`P`) or goes. A tick comes",
        "only when every such client has answered the last package that it got by an input package. With a recipe",
        "of 125 Hz two ticks follow each answer. Clients that have sent no input only listen, and miss nothing.",
        f"A client that has not answered for {LOCKSTEP_TIMEOUT_S:g} s of wall time (*assumed*) is let go with a line",
        "in the log: time goes on without it, and it takes part again from its next input package on. The same holds",
        "for one that does not read its packages, until it reads again. `--lockstep-timeout SECONDS` sets another",
        f"bound, `inf` none. Each time that a client is let go it is waited for {PATIENCE_FACTOR:g} of the time",
        f"from then on, {PATIENCE_MIN_S:g} s at least, until it has answered {TRUSTED_ANSWERS} packages one after the",
        "other: the vendor's `RtsiIOInterface` sends nothing unless a value was set since its last package.",
        "So lockstep gives the same bytes in every run to clients that answer every package; with one that answers",
        "some of them time passes about as on the wall.",
        "While no client takes part, time passes as on the wall. The robot is in this process then, without the jail",
        "and without the protection against calls that do not come back: a program that calls `sum(range(10**12))`",
        "holds up the whole `serve`.",
        "",
        "## Tasks",
        "",
        "`task -p NAME.task` and `play` on the dashboard run the script of the tree in `NAME.task` of the task folder",
        "(`--task-dir`). Of a file that is no tree, it is `NAME.script`,",
        "or else `NAME.task.script`. If the first line of `NAME.task` is `external_control HOST [PORT]`, the",
        f"program comes from the client there instead (port {SENDER_PORT} by default): the controller sends",
        "`request_program`, and runs what comes, up to the comment `# NODE_CONTROL_LOOP_ENDS`. `play` is",
        "answered when the program has begun, or refused with the reason.",
        "",
        "## Connections that programs open",
        "",
        f"TCP, at most {CHANNELS_MAX} at a time. A peer that does not read stops the program that writes to it, and",
        "the other way round.",
        "",
        f"Programs reach {DEFAULT_TEXT}; `--allow-connect` changes that. What counts",
        "is the address that a name or another way to write an address stands for, of sockets, remote procedure",
        "calls and MODBUS alike. A refusal is a warning of the program with the option that would allow it; the",
        "`ready` line and `elitescript doctor` say what is reached.",
        "",
        "## SSH",
        "",
        "`serve --ssh` ([what it is for](../how-to/ssh.md)) answers SFTP and SCP with files in memory, and these",
        "commands; `PORT` and `NUMBER` are decimal, `...` are further options. There is no shell: anything else ends",
        f"with status {ssh_commands.NO_SUCH_COMMAND}.",
        "",
        "| command | what it does |",
        "|---|---|",
        *(f"| `{cell(row.form)}` | {cell(row.effect)} |" for row in ssh_commands.COMMANDS),
        "",
        "## `elitescript ctl`",
        "",
        "A person's hands on a served robot, through a local channel that only the same user can open; it",
        "works in local control too. The line after `ready` names the socket of each robot: `serve-N.sock` of instance",
        "N, in the folder `elitescript` of `XDG_RUNTIME_DIR`, or `elitescript-UID` of the folder for temporary files.",
        "`--instance N` or `--socket PATH` chooses one; on Windows the file `serve-N.json` tells port and secret. An",
        "order is answered when the robot has done or refused it; a refusal gives the reason and exit code 1.",
        "",
        "| verb | what it does |",
        "|---|---|",
    ]
    lines += [f"| `{cell(verb.usage)}` | {cell(verb.summary)} |" for verb in VERBS.values()]
    lines += _debug_lines()
    return "\n".join(lines) + "\n"


def _debug_lines() -> list[str]:
    """Return what a debugger can ask of a served robot."""
    lines = [
        "",
        "### `debug`",
        "",
        "`elitescript dap` attaches to a served robot with this verb; so can any program. A request of a debugger is",
        'the line `{"verb": "debug", "values": {"do": NAME, ARGUMENT: VALUE, ...}}`, its answer has',
        '`{"result": {"result": ...}}`, or the reason of a refusal. The first request of a connection attaches it, its',
        "end removes all breakpoints and lets a program that was stopped go on. One debugger is attached at a time.",
        "Objects have the fields of the records in `elitescript.debugger.api`; arguments in brackets may be left out.",
        "",
        "A stop is a pause of the task: the arm brakes, clients see a paused task, the ports are served. The thread",
        "that has stopped stays before its statement, the others where they are; secondary programs run on. Whoever",
        "resumes the task lets the program go on. A journal has what a debugger asks, so a replay stops where the",
        "session has.",
        "",
        "| `do` | arguments | what it does |",
        "|---|---|---|",
    ]
    for name in REQUESTS:
        method = getattr(LivingDebugger, name)
        arguments = ", ".join(
            f"`{item.name}`" if item.default is item.empty else f"[`{item.name}`]"
            for item in list(signature(method).parameters.values())[1:]
        )
        summary = " ".join((method.__doc__ or "").split("\n\n")[0].split())
        lines.append(f"| `{name}` | {arguments} | {cell(summary)} |")
    lines += [
        "",
        "Between answers come lines with what happens meanwhile:",
        "",
        "| `event` | with | when |",
        "|---|---|---|",
    ]
    return lines + [f"| `{name}` | {content} | {cell(text)} |" for name, (content, text) in EVENTS.items()]
