"""Programs of random sessions: those of other random tests, with threads beside them that press, shift and raise."""

from __future__ import annotations

from collections.abc import Callable
from random import Random

from tests.debugger import random_programs as threads_programs
from tests.invariants import test_conveyor_invariants as conveyors
from tests.invariants import test_micro_invariants as micro
from tests.invariants.random_devices import random_talk
from tests.invariants.random_programs import random_program
from tests.invariants.test_path_offset_invariants import shifting
from tests.kernel.test_interpreter_interleavings import HOSTS
from tests.language import random_programs as language_programs

MICRO_FILE = "p.txt"


def moves(chance: Random) -> str:
    """Moves, streams, drives, waits and threads."""
    return random_program(chance)


def talk(chance: Random) -> str:
    """Threads that talk with devices."""
    return random_talk(chance)[0]


def shifts(chance: Random) -> str:
    """Moves that a thread shifts."""
    return _beside(random_program(chance), shifting(chance))


def belts(chance: Random) -> str:
    """Moves along a conveyor."""
    return conveyors.random_program(chance)


def points(chance: Random) -> str:
    """A motion along the points of a file, or a part of it."""
    first = chance.randrange(0, 40)
    return micro.program_of(chance.random() < 0.5, chance.choice((2, 4, 10)), first, first + chance.randrange(-5, 150))


def presses(chance: Random) -> str:
    """Moves beside a thread that presses, is guided by hand, and changes tool and load."""
    return _beside(random_program(chance), _thread(chance, "presser", _pressing))


def raises(chance: Random) -> str:
    """Moves beside threads in which something is raised."""
    text = random_program(chance)
    for number in range(chance.randrange(1, 4)):
        text = _beside(text, _thread(chance, f"raiser{number}", _raising, tries=False))
    return text


def interpreted(chance: Random) -> str:
    """A program that runs the lines of clients."""
    return "def host():\n" + "".join(f"  {line}\n" for line in _closed(chance.choice(HOSTS[:4]))) + "end\n"


def _closed(lines: tuple[str, ...]) -> list[str]:
    """Return lines with the `end` of each block that they begin."""
    found: list[str] = []
    depths: list[int] = []
    for line in (*lines, ""):
        depth = len(line) - len(line.lstrip())
        goes_on = line.lstrip().startswith(("except", "else"))
        while depths and depth <= depths[-1]:
            if depth == depths[-1] and goes_on:
                break
            found.append(" " * depths.pop() + "end")
        if line.endswith(":") and not goes_on:
            depths.append(depth)
        if line:
            found.append(line)
    return found


def _beside(program: str, thread: list[str]) -> str:
    """Return a program that starts a thread before everything else."""
    head, *body = program.rstrip("\n").split("\n")
    return "\n".join([head, *thread, *body]) + "\n"


def _thread(chance: Random, name: str, statement: Callable[[Random], str], *, tries: bool = True) -> list[str]:
    lines = [f"  def {name}():", f"    sleep({chance.uniform(0.0, 1.0):.3f})"]
    for _ in range(chance.randrange(1, 9)):
        text = statement(chance)
        if tries:
            lines += [
                "    try:",
                f"      {text}",
                "    except Exception as e:",
                '      textmsg("refused ", e)',
                "    end",
            ]
        else:
            lines.append(f"    {text}")
        lines.append(f"    sleep({chance.choice((0.0, 0.004, 0.05, 0.3))})")
    return [*lines, "  end", f"  start_thread({name}, ())"]


def _numbers(chance: Random, *sizes: float) -> str:
    return f"[{', '.join(f'{chance.uniform(-size, size):.3f}' for size in sizes)}]"


def _pressing(chance: Random) -> str:
    axes = [chance.choice((0, 1)) for _ in range(6)]
    return chance.choice(
        (
            f"force_mode({_numbers(chance, *[0.3] * 6)}, {axes}, {_numbers(chance, *[25.0] * 3, *[1.0] * 3)}, "
            f"{chance.randrange(4)}, [0.1, 0.1, 0.1, 0.5, 0.5, 0.5])",
            f"force_mode([0, 0, 0, 0, 0, 0], [0, 0, 1, 0, 0, 0], [0, 0, {chance.choice((-20, 10))}, 0, 0, 0], "
            f"{chance.randrange(4)}, [0.05, 0.05, 0.05, 0.5, 0.5, 0.5])",
            "end_force_mode()",
            "zero_ftsensor()",
            "textmsg(get_tcp_force(False), force())",
            f"force_mode_set_gain_scaling({chance.choice((0.1, 1, 2))})",
            f"force_mode_set_damping({chance.choice((0, 0.01, 0.9))})",
            f"freedrive_mode({axes})",
            "end_freedrive_mode()",
            f"set_tcp({_numbers(chance, 0.05, 0.05, 0.2, 0.4, 0.4, 0.4)})",
            f"set_payload({chance.uniform(0.0, 6.0):.2f}, {_numbers(chance, 0.1, 0.1, 0.1)})",
            f"set_gravity({_numbers(chance, 4.0, 4.0, 9.0)})",
            "stopl(2)",
            "textmsg(get_joint_torques())",
        )
    )


def _raising(chance: Random) -> str:
    return chance.choice(
        (
            "sync()",
            "sync()",
            "textmsg(count)",
            "raise ValueError(count)",
            "count_of_nothing = 1 / 0",
            "undefined_name()",
            "movej([9, 9, 9, 9, 9, 9])",
            "movej([0.1, -1.5, -1.5, -1.5, 1.5, 0])",
            "movel([9, 9, 9, 0, 0, 0])",
            "set_standard_digital_out(99, True)",
            "halt()",
            "pause()",
            "popup('stop', blocking=True)",
            "popup('go on')",
            "stopj(3)",
            "box.get(timeout=0.01)",
            "def deeper(n):\n      return deeper(n + 1)\n    end\n    deeper(0)",
        )
    )


PROGRAMS: dict[str, Callable[[Random], str]] = {
    "moves": moves,
    "threads": threads_programs.random_program,
    "talk": talk,
    "shifts": shifts,
    "belts": belts,
    "points": points,
    "presses": presses,
    "raises": raises,
    "interpreted": interpreted,
    "language": language_programs.random_program,
}
"""By the kind of a session."""

SHARES = {"moves": 5, "threads": 3, "talk": 4, "presses": 3, "raises": 2, "interpreted": 2}
"""How often a kind is drawn, beside those that are drawn once."""
