"""Explains each code of `errors.CODES`: reason, example, remedy.

A rule carries its text as the docstring of its file. The texts of all other codes stand here, in the same form: what it
is and why in the first paragraphs, then an indented example whose comment says what to do.
"""

from __future__ import annotations

from inspect import cleandoc
from typing import Final

from elitescript.errors import CODES, UsageError
from elitescript.lint.registry import all_rules

_KINDS: Final = {
    "E0": "The program does not start.",
    "E1": "The program does not start.",
    "E3": "The line raises an exception when it is reached; `run` starts the program all the same, because it may "
    "catch it, and `run --strict` refuses it.",
    "R1": "An alarm: the program ends on this line, unless it catches the exception.",
    "W2": "The program starts.",
    "N2": "The program starts. A note: a sound program may have it too, and no verdict depends on it.",
}


_LENIENT: Final = frozenset(("E106", "E109", "E110", "W209"))
"""Codes of what a Python 3 controller refuses."""


def explanation(code: str) -> str:
    """Return the text of `check --explain`.

    Raises:
        UsageError: there is no such code.
    """
    name = code.strip().upper()
    if name not in CODES:
        raise UsageError(f"there is no code {code!r}{_near(name)}")
    return f"{name}: {CODES[name].title}\n{_facts(name)}\n\n{body(name)}"


def markdown(code: str) -> str:
    """Return the text of one code as Markdown, without a heading."""
    blocks = (
        f"```elite\n{cleandoc(block)}\n```" if block.startswith("    ") else block for block in body(code).split("\n\n")
    )
    return f"*{_facts(code)}*\n\n" + "\n\n".join(blocks)


def body(code: str) -> str:
    """Return what a code means, why, and an example; empty if there is no text."""
    for rule in all_rules():
        if rule.code == code:
            return cleandoc(rule.explanation)
    return cleandoc(_TEXTS.get(code, ""))


def _facts(code: str) -> str:
    row = CODES[code]
    default, strict = row.default_severity, row.strict_severity
    severity = default.capitalize() if default == strict else f"{default.capitalize()}; {strict} with --strict"
    if row.is_tolerated and code in _LENIENT:
        return f"{severity}. Only this implementation accepts it."
    since = next((f" Since {rule.since}." for rule in all_rules() if rule.code == code), "")
    return f"{severity}. {_KINDS.get(code[:2], '')}{since}"


def _near(name: str) -> str:
    from difflib import get_close_matches

    found = get_close_matches(name, list(CODES), 3, 0.6)
    if not found:
        return "; docs/reference/rules.md lists them all"
    return f"; did you mean {' or '.join(found)}?"


_TEXTS: Final[dict[str, str]] = {
    "E001": """
        A line that is no Python. EliteScript is Python in which a block may also end with `end`. The message names the
        mistake, and one mistake does not hide the next. Signs of an input method for Chinese are text in strings and
        comments; in code each line with them has one finding, and one repair writes the plain signs of code alone.

            def job():
              x = (1 + 2               # E001: this '(' is never closed
              textmsg(x)
              textmsg\uff08“完成”\uff09        # E001: full-width signs; --fix writes textmsg("完成")
              textmsg("完成\uff0c好")       # no finding
            end
        """,
    "E002": """
        A byte that is not UTF-8. Programs are UTF-8 text; editors of some systems save another encoding, and a binary
        file is no program at all. A file in GBK or UTF-16 is recognised, and `elitescript check --fix` converts it; of
        other encodings it is not known which one it is.

            textmsg("\\xcd\\xea\\xb3\\xc9")  # E002 in a file that was saved as GBK: it reads 完成
            textmsg("完成")              # saved as UTF-8: no finding

            textmsg("Gr\\xfc\\xdfe")      # E002 in a file that was saved as Latin-1: save it as UTF-8
        """,
    "E003": """
        A file that cannot be read: it does not exist, is a folder without programs, or may not be opened. The other
        files are checked all the same.

            elitescript check cell.scrpt    # E003: is cell.script meant?
        """,
    "E004": """
        A graphical program (`.task`) that has no script: its file is no XML or no task, or a node of it cannot be
        generated: a waypoint that was never taught, an empty expression, a node of a plugin or of a kind that is not
        known. The node is named by the row above it and its own row, as the pendant numbers them.

            cell.task: 4 MoveJ > 5 Above (script line 24): error E004: the waypoint has never been taught

        `elitescript task cell.task` prints what can be generated.
        """,
    "N225": """
        What a graphical program (`.task`) would find beside it, and which is not there: the files of its configuration,
        with the values of variables, TCP, payload, frames, and names of inputs and outputs. Its script is generated
        without them, and its sections stay empty; a variable that has no value ends the program where it is used.

            cell.task: script line 1: note N225: cell.configuration.variables is not beside the task

        Copy the files from the `program` folder of the controller, or name that folder with `--task-dir`.
        """,
    "W226": """
        A waypoint of a graphical program (`.task`) whose pose lies more than 1 mm or 1 mrad from where its joint
        positions lead, on the arm for which the task was made, with the TCP of its move. Which of both counts depends
        on the move, so an edit of it may send the arm elsewhere. A pose of six zeros is none.

            cell.task: 4 MoveL > 5 Above (script line 24): warning W226: its pose and its joint positions disagree

        Teach the waypoint again. If all waypoints are apart by the length of the tool, the tool is missing: put the
        `.configuration` file of the installation beside the task.
        """,
    "W227": """
        A variable of the installation that a node of a graphical program (`.task`) uses, and that has no value in
        `INST.configuration.variables`: it is not there, or its value is empty.

            cell.task: 4 MoveJ > 5 home (script line 24): warning W227: the variable home has no value
        """,
    "W228": """
        A script node of a graphical program (`.task`) with the text of a file as it was when the node was saved, and
        the file beside the task has another text now. The pendant runs the text in the node.

            cell.task: 3 Pick > 4 Script (script line 25): warning W228: the text in the node is not that of its file
        """,
    "W229": """
        A graphical program (`.task`) that runs on another arm than the one for which it was made. Joint positions lead
        elsewhere there, and poses may be out of reach.

            cell.task: script line 1: warning W229: the graphical program was made for a CS612, and this is a CS66

        `run`, `check`, `plot` and `sweep` take the arm of the task, unless `--robot` or the world file names one.
        """,
    "N227": """
        A condition, loop, case, event, thread or sub-task of a graphical program (`.task`) in which nothing stands but
        comments, placeholders and suppressed nodes. The default case of a switch may be empty.

            cell.task: 2 Robot Main Task > 3 If (script line 24): note N227: nothing stands in it
        """,
    "E101": """
        An `end` that closes nothing. Each `end` closes the block whose indentation it has. A surplus one often means
        that another block lost its header, or that a block was closed twice.

            def job():
              textmsg("one")
              end                      # E101: no block is open here; remove it
            end
        """,
    "E102": """
        A `def` or `sec` that is the program and has no `end`. Controllers need it to know where the program is
        complete.

            def job():
              textmsg("one")
                                       # E102: write `end` below, as far left as `def`
        """,
    "E103": """
        An `else`, `elif`, `except` or `finally` behind the `end` of its statement. One `end` closes the whole
        statement.

            if get_flag(0):
              textmsg("yes")
            end                        # remove this one
            else:                      # E103
              textmsg("no")
            end
        """,
    "E104": """
        A block without a statement; a comment is none. Python cannot tell whether something was forgotten, so `pass`
        says that nothing is meant.

            while not get_flag(0):
                                       # E104: write `pass`, or `sync()` to wait
            end
        """,
    "E105": """
        A secondary program inside a block. `sec` stands at the left margin, beside the program and not in it. When a
        text lost its indentation, that is the cause.

            def job():
              sec lamp():              # E105: move it out of `job`
                set_standard_digital_out(1, True)
              end
            end
        """,
    "E106": """
        The print statement of Python 2. It is accepted here because old programs have it; a controller with Python 3
        refuses it. `check --fix` repairs it.

            print "ready"              # E106: write print("ready")
        """,
    "E107": """
        A parameter of the program itself without a default. Nothing calls the program with arguments.

            def job(speed):            # E107: write speed=0.5, or a global
              textmsg(speed)
            end
        """,
    "E108": """
        An assignment in a `global` statement, which only says that a name is shared with the rest of the program. The
        value is given by a statement of its own. `check --fix` separates the two.

            global count = 0           # E108: write `global count`, and `count = 0` below
        """,
    "E109": """
        A `global` behind a use of its name in the same function. Python 3 refuses it; here it counts for the whole
        function. `check --fix` moves it to the top.

            def job():
              count = 1
              global count             # E109: move it above the first use
            end
        """,
    "E110": """
        The suffix of long integers of Python 2. Every int is long in Python 3. `check --fix` repairs it.

            mask = 0xFFFFL             # E110: write 0xFFFF
        """,
    "E111": """
        `<>` and backquotes of Python 2, which Python 3 cannot read. `check --fix` repairs the first; the second is a
        call of to_str or repr.

            if a <> b:                 # E111: write a != b
              textmsg(`a`)             # E111: write to_str(a)
            end
        """,
    "E112": """
        A statement of Python 2 that Python 3 writes differently: `exec` as a statement, `raise` and `except` with a
        comma.

            except ValueError, e:      # E112: write `except ValueError as e:`
        """,
    "E113": """
        An operator of C: `&&`, `||`, `!`, `++`, `--`, `? :`. Python writes the words `and`, `or`, `not`, and has no
        steps by one. `check --fix` repairs those whose meaning is certain.

            if a && !b:                # E113: write `a and not b`
              n++                      # E113: write `n += 1`
            end
        """,
    "E114": """
        A statement of URScript, another maker's language. Threads, for example, are functions here.

            thread watch():            # E114: write `def watch():`
              sync()
            end
            run watch()                # E114: write start_thread(watch, ())
        """,
    "E115": """
        A name or attribute that scripts may not use: names with two underscores at both ends reach Python's own
        machinery, which a program of a robot does not need and the sandbox does not give.

            x = (1).__class__          # E115: type(1) says what it is
        """,
    "W210": """
        An escape sequence that Python does not have, or one that Python 2 read in another way. Python keeps the
        backslash, which is rarely what a path or a message means. `check --fix` repairs it.

            textmsg("C:\\path")        # W210: write "C:\\\\path"
        """,
    "W222": """
        A text that was saved as GBK and is UTF-8 by chance. The bytes of `停止` in GBK are valid UTF-8 as well: they
        read as marks of scripts that no program mixes. The program runs, but its texts are those marks. `--fix`
        converts nothing, as both readings are possible. Texts in Latin, Greek, Cyrillic, Hebrew or Arabic letters are
        no finding.

            def job():
              textmsg("\u0221")                 # W222: in GBK, these bytes are 取
            end

        The same text, saved as UTF-8:

            def job():
              textmsg("取")                # no finding
            end
        """,
    "R100": """
        An exception of Python that nothing caught. The text says what was wrong, with the values.

            parts = [1, 2]
            textmsg(parts[2])          # R100: index 2 is out of range: `parts` has 2 elements
        """,
    "R101": """
        A command got an argument of the wrong type or length. `check` finds it as E304 where the value is certain.

            n = get_tcp_offset()
            sleep(n)                   # R101: t must be a number; write sleep(n[0])
        """,
    "R102": """
        A command got a number outside its range. The text names value, limit and unit; `check` finds it as E305 where
        the value is certain.

            i = 16
            set_standard_digital_out(i, True)    # R102: 0 to 15
        """,
    "R103": """
        A command was called with too many, too few or unknown arguments. `check` finds it as E303.

            set_standard_digital_out(1)          # R103: the level is missing
        """,
    "R104": """
        A value that has the right type and range and yet cannot be used, such as a combination of settings that
        exclude each other.

            serial_config(True, 9600, 0, 1, 7, True)    # R104: MODBUS-RTU has 8 bits
        """,
    "R105": """
        A command that came with a newer firmware than the chosen one. `check` finds it as E302.

            halt()                     # R105 with --firmware 2.10: choose --firmware 2.14
        """,
    "R106": """
        A command that is known but not simulated. It checks its arguments and then refuses, because an answer that is
        made up would be worse. `elitescript commands NAME` says which commands do so.

            try:
              path_offset_enable()     # R106: catch it where the program can go on without
            except NotImplementedError:
              pass
            end
        """,
    "R110": """
        A move to joint positions outside the limits of the arm. The text names the joint, the value and the limit;
        often degrees were taken for radians.

            movej([7.0, -1.57, 1.57, 0, 1.57, 0])    # R110: base goes up to 6.28 rad: subtract 2 pi
        """,
    "R111": """
        A pose that the arm cannot reach: too far away, or too near to its own base. Often millimetres were taken for
        metres, or the TCP is not the one with which the point was taught.

            movel([3.0, 0, 0.5, 3.14, 0, 0])         # R111: are millimetres taken for metres?
        """,
    "R112": """
        A straight line or an arc through a singularity, where a joint would have to jump.

            movel(BEHIND)              # R112: go there with movej, or by a waypoint beside the axis
        """,
    "R113": """
        An arc whose three points lie on a line or on each other, so that no plane and no radius follow from them. The
        arc goes from where the arm is, through the first point, to the second.

            movec(P1, P1)              # R113: the way point has to stand off the line
        """,
    "R114": """
        Two threads move the arm at the same time. One arm follows one motion, so a thread has to wait until the other
        one's move has ended.

            def other():
              movej(AWAY)              # R114 while the program itself moves: guard both with a lock
            end
        """,
    "R115": """
        The arm is not ready to move: no power, brakes closed, or a stop of the safety system.

            movej(HOME)                # R115: power on and release the brakes before
        """,
    "R116": """
        A motion along points begins where the arm is not. The first point has to be its position.

            movej(HOME)
            moveml(0)                  # R116: movej to the first of the points before
        """,
    "R117": """
        Points of a path that lie too far apart to be followed without a jump. Paths of points are followed as they are,
        without a plan of their own between two of them.

            points = [[0, 0, 0, 0, 0, 0], [3, 0, 0, 0, 0, 0]]    # R117: put points between them
        """,
    "R118": """
        A motion that a joint cannot follow, because its speed or acceleration would be above the limit of the arm.

            servoj(q, 0, 0, 0.004)     # R118 when q jumps: give it targets in smaller steps
        """,
    "R120": """
        A secondary program called a command that moves the arm, waits or starts threads. `check` finds it as W205.

            sec lamp():
              sleep(1)                 # R120: do it in the program
            end
        """,
    "R121": """
        More threads than the firmware allows at a time: 15 with 2.10, 20 with 2.14. Threads that have ended do not
        count.

            while True:
              start_thread(work, ())   # R121: join or stop threads before the next one begins
            end
        """,
    "R122": """
        An input or output that is in another mode, such as a tool pin that is an input.

            set_tool_digital(0, True)  # R122: make the pin an output with set_tool_digital_io_config before
        """,
    "R123": """
        Access that scripts do not have: files outside the task folder, processes, Python's own machinery.

            open("/etc/passwd")        # R123: paths count from the task folder
            open("conftest.py", "w")   # R123: programs write no files that other programs run, and no hidden ones
        """,
    "R130": """
        A deadlock: every thread waits for something that no other thread can do. The text lists what each waits for.

            lock = threading.Lock()
            lock.acquire()
            lock.acquire()             # R130: the lock is never released
        """,
    "R131": """
        A thread that cannot be stopped, because it catches even that. It is given up where it stands.

            while True:
              try:
                sync()
              except BaseException:    # R131: catch Exception instead
                pass
              end
            end
        """,
    "R132": """
        The process of a served robot did not answer in time and was ended; the robot goes on from where it was. A
        single call that computes very long does that.

            x = sum(range(10 ** 12))   # R132: compute it in pieces, with sync() between them
        """,
    "R133": """
        A remote procedure call that failed: no connection, no answer in time, or a fault as the answer. The alarm has
        the number and the text of the server's fault.

            camera = rpc_factory("xmlrpc", "http://192.168.1.9:8080")
            camera.find("part")        # R133: catch it and try again, or ask a person
        """,
    "R134": """
        A MODBUS signal with a watchdog that has not worked for longer than it allows: the device is silent, refuses the
        address, or the connection is lost. The text has the error codes of both.

            modbus_set_signal_watchdog("gripper", 0.5)    # R134 when the gripper is silent for longer than that
        """,
    "R135": """
        A served robot cannot stop, send or go on while one call computes. Calls that take 10 ms and more of processor
        time hold it up: the first of a program is warned of. When together they have held it up for 0.25 s
        (`held_up_max_s`) beyond 1 % of the time, the program ends. A long call every few seconds is no matter.

            while True:
              best = sorted(range(200000))   # R135: sort once, before the loop
            end
        """,
    "R140": """
        A protective stop: a collision, a limit of force, speed or position, or a plane that was passed. The arm has
        stopped on its path and keeps its power.

            movel(BELOW_THE_TABLE)     # R140: unlock it, and move back before the next try
        """,
    "R141": """
        An emergency stop: a button is pressed, here or on another machine. The power of the arm goes off.

            movej(HOME)                # R141 when the button is pressed: release it, power on, start again
        """,
    "W270": """
        Something that the program gave away before it ended (bytes of a socket or a serial port, a MODBUS request) had
        not arrived when the run gave up waiting: the peer does not read, does not answer, or has gone. The record of
        the end names it under `undelivered`.

            socket_send_line("done")           # W270: the peer does not read
        """,
    "W271": """
        A write to an output that is tied to the state of the task (`set_runstate_..._to_value`) has no effect: the
        output follows the task until it is untied.

            set_runstate_standard_digital_output_to_value(0, 3)
            set_standard_digital_out(0, True)  # W271: output 0 follows the task
        """,
    "W272": """
        `socket_read_ascii_float` reads up to the closing bracket. The line end that the sender put behind it is left,
        and the next reading of text begins with it.

            socket_read_ascii_float(2)
            socket_read_string()               # W272: begins with the line end
        """,
    "W273": """
        The arm, its tool or what it holds touches a thing of the world file, or itself: a real one would collide. The
        message has the line that runs when it begins, the time, and how deep the solids are in each other. What may
        touch stands in `ignore` of the thing. `elitescript run --world cell.toml` and `elitescript check --world
        cell.toml` find it; both run the program.

            movel([0.4, -0.2, 0.01, 3.14, 0, 0])  # W273: gripper touches table, 12.0 mm deep at 1.204 s
        """,
    "W274": """
        A run connects to what its world or its test puts beside the robot, and to loopback addresses of this computer.
        Any other address is a real machine: it is left alone, and the program goes on as if no host were there.
        `socket_open` returns False after its timeout, MODBUS signals get no answer, a remote procedure raises its
        timeout; no name is looked up. A serial port that nothing is bound to is open and silent: `--serial` binds it.
        `elitescript check --reach` lists all that a program names.

        The option `network` lets a connection through. It is written where the robot is made:

        - command line: `--network 192.168.1.5:502`
        - Python: `VirtualRobot(network="192.168.1.5:502")`
        - a test in Python: `@pytest.mark.elitescript(network="192.168.1.5:502")`
        - a test script, in the comments at its top: `# elitescript: network=192.168.1.5:502`
        - a world file: `[robot]`, and below it `network = "192.168.1.5:502"`
        - a launch configuration of an editor: `"network": "192.168.1.5:502"`
        - the studio: the button *Allow connections*

            socket_open("192.168.1.5", 502)    # W274: false after 2 s, as if no host were there
        """,
    "W275": """
        A device sends text in GBK, as cameras of Chinese systems do. Programs read UTF-8 (*assumed*): other bytes
        become U+FFFD, so that a comparison with a text is never true. The warning has what the bytes are in GBK; it
        comes once a connection.

            t = socket_read_string()           # W275, if the camera sends the bytes BA CF B8 F1
            if t == "合格":                    # never true
              textmsg("good")
            end
            data = socket_read_byte_list(4)    # no finding: bytes(data[1:]).decode("gbk") is the text
        """,
    "N280": """
        Data that a channel had received was not read when the program ended. Often it is the end of an answer of which
        the program read only the beginning; the next question to the same device then gets the answer to the last one.

            socket_send_line("GET POS")
            n = socket_read_ascii_float(1)     # the answer was (1.5, 2.5): what follows is left
        """,
    "W280": """
        The program ended while it still moved the arm: `servoj` was before its target, `speedj` or `speedl` had no
        stop behind it, force mode or the tracking of a conveyor was on. The arm brakes where it is at that moment.

            servoj(q, t=0.008)                 # W280: returns after 8 ms, 0.79 rad before q, and the program ends
        """,
    "W281": """
        `socket_get_var` sends `GET POS` and waits 2 s for a line such as `POS 10`; without one the value is 0. Lines of
        another form, such as an `ack` to `socket_set_var`, are passed over here; the manual does not say so, and a
        controller may take one for the answer. An answer that had come before the question was sent belongs to an
        earlier question, and from then on so does each.

            socket_set_var("GTO", 1, "g")      # the device answers "ack"
            pos = socket_get_var("POS", "g")   # W281: read "ack" first, socket_read_string("g", suffix="\\n")
        """,
    "W282": """
        `socket_read_ascii_float` drops what is more than it was asked for, and everything from the first field on that
        is no number. Six numbers for three are decimal commas: a comma separates numbers. Fewer numbers than asked for
        are no finding: the first element of the result says how many came.

            r = socket_read_ascii_float(3)     # W282 for (1,5, 2,5, 3,5): 1, 5 and 2; let (1.5, 2.5, 3.5) be sent
        """,
    "W283": """
        A reading ended by its timeout, so it gave no text or no numbers, although data had come: the prefix, the suffix
        or the parenthesis that it waits for was not in it. The data stays, and is in front of the next text. A reading
        of less than 0.5 s is told at the end of the program, and only if no later one has brought the data.

            s = socket_read_string("cam", suffix="\\r\\n")    # W283 for "12.5\\n": read with suffix="\\n"
        """,
    "W293": """
        A setting of a device beside the robot that is possible and hardly meant: a connection that takes 20 s or more,
        a wire or schedule that sets an output of the robot, or two wires that determine the level of one input.

            [[tcp]]
            port = 5000
            latency_s = 50                     # W293: 50 ms are 0.05
        """,
    "N290": """
        A machine of the world file takes 100 s or more. Some do; often milliseconds were meant.

            [[wire]]
            when = "standard_digital_out[0]"
            then = "standard_digital_in[1]"
            after_s = 500                      # N290: 500 ms are 0.5
        """,
    "N281": """
        The peer has closed the connection, or it broke, and the program goes on reading or sending. Readings give
        nothing, sending returns False. Told once a connection; what had arrived before the close is read without it.

            ok = socket_send_line("next", 0, "cam")    # N281: look at ok, close the name and open it anew
        """,
    "N282": """
        The manual has ASCII in texts. Other characters go as UTF-8, in two to four bytes each, which a receiver may
        read as something else.

            socket_send_line("22 °C")                  # N282: ° goes as c2 b0; "22 C" is let pass
        """,
    "N283": """
        A reading of so many bytes or numbers ended by its timeout with a part of them. The result says how many there
        are; a sound program looks at that.

            b = socket_read_byte_list(9)               # N283 for 5 bytes: b[0] is 5
        """,
    "W285": """
        A MODBUS signal is 0 or False until its device has answered for the first time, some 10 ms to 0.1 s after it was
        added. What was read before is no value. A signal that is added again in the loop that reads it never gets one.

            modbus_add_signal("192.168.1.50", 255, 0, 2, "level")
            level = modbus_get_signal_status("level")      # W285: sleep(0.5) between both lets it pass
        """,
    "W286": """
        A MODBUS output is sent 10 times a second. A value that the program replaces before that never reaches the
        device. Told at the end of the program; of a stream, such as a beat counter, it is the note N286.

            modbus_set_output_signal("start", True)
            sleep(0.02)
            modbus_set_output_signal("start", False)       # W286: sleep(0.2) lets the device see it
        """,
    "W287": """
        A register has 16 bits. Of a value that is not in -32768 to 65535 the low 16 bits are sent, which is another
        number.

            modbus_set_output_register("speed", 70000)     # W287: 4464 is sent; two registers hold it
        """,
    "W288": """
        An output, register or flag changed and changed back in one tick of 4 ms. Outside, on a wire, on RTSI, in a
        device, nothing has happened. In a block of `except` or `finally` it is the note N285.

            set_standard_digital_out(0, True)
            set_standard_digital_out(0, False)             # W288: sleep(0.1) between both makes it a pulse
        """,
    "W289": """
        A digital input changed to and fro between two looks of a line that looks again and again: a pulse was missed,
        and others will be. A line that looks at an input once a cycle, seldomer than each second, is no finding.

            while not get_standard_digital_in(3):          # W289 for a pulse of 20 ms
              sleep(0.1)                                   # sync() looks in every tick
            end
        """,
    "N284": """
        A line read a MODBUS signal before its first answer, and again later. The first readings were 0 or False, which
        no device had sent; a loop that waits for another value is not harmed by that.

            while modbus_get_signal_status("ready") == 0: sync()     # N284: the first zeros are no answers
        """,
    "N285": """
        An output, register or flag got two levels in one tick of 4 ms: nothing outside has seen the first one.

            write_output_integer_register(0, 5)
            write_output_integer_register(0, 6)            # N285: 5 was never there; sync() between shows both
        """,
    "N286": """
        A MODBUS output is set faster than it is sent, again and again, so that the device gets some of the values. For
        a beat counter or a measurement that is as good.

            modbus_set_output_register("beat", n % 256)    # N286 in every tick; modbus_set_signal_update_frequency
        """,
    "W290": """
        A target of `servoj` came after the arm had come to rest at the one before, three times at one line. The arm
        stops and starts at each target. A new target must come when the time `t` of the one before is over.

            servoj(q, t=0.008)                 # W290 with a sleep(0.1) behind it: give t=0.1 and no sleep
        """,
    "W291": """
        A conveyor was tracked for 0.5 s or more by an encoder that has not counted since the start of the robot, so the
        arm was not moved. It is not set up, nothing sets its count, or another encoder counts. A belt that has moved
        before and stands now is no finding.

            track_conveyor_linear([1, 0, 0, 0, 0, 0], 10000)    # W291: encoder_enable_set_tick_count comes before it
        """,
    "W292": """
        A command that moves the arm was refused 10 times in a row at one line, another one 100 times, at most 1 s
        apart, and the program caught it each time. The robot does nothing, and nothing shows why.

            while True:
              try: movel(p)                    # W292: end the loop in the block of except, or show the reason
              except Exception: sleep(0.05)
            end
        """,
    "N288": """
        Force mode was on for 0.5 s or more and ended, it had a force or torque to exert, and nothing has pressed
        against the tool. In the simulation only the world has something to touch.

            force_mode([0, 0, 0, 0, 0, 0], [0, 0, 1, 0, 0, 0], [0, 0, -10, 0, 0, 0], 0, [0.1] * 6)   # N288 in the air
        """,
    "R150": """
        The program has requested more memory than the run may have. Make shorter lists and texts, or keep fewer of
        them; `run --memory-limit` sets what a run may have.

            rows = [0] * 10**12                # R150
        """,
    "R151": """
        The process that ran the program has crashed, which Python does when iterators or objects are nested hundreds of
        thousands deep. The process beside it reports the line.

            for i in range(20000000):
                rows = map(abs, rows)          # R151: where the nested iterators are used
            end
        """,
    "R142": """
        A violation or fault of the safety system, which takes the power of the arm. Only a restart of the safety system
        leads back, and the arm has to be powered on again after it.

            movej(HOME)                # R142: `elitescript ctl restart`, then power on
        """,
}
