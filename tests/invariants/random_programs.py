"""Seeded random programs: moves, waits, outputs, threads, queues and loops that poll inputs."""

from __future__ import annotations

from random import Random

HOME = (0.0, -1.5708, -1.5708, -1.5708, 1.5708, 0.0)


def random_program(generator: Random) -> str:
    """A program that ends by itself within some simulated seconds."""
    writer = _Writer(generator)
    return writer.program()


class _Writer:
    def __init__(self, generator: Random) -> None:
        self._random = generator
        self._lines: list[str] = []

    def program(self) -> str:
        chance = self._random
        self._line(0, "def program():")
        self._line(1, "global count, done, seen")
        self._line(1, "count = 0")
        self._line(1, "done = False")
        self._line(1, "seen = []")
        self._line(1, "set_payload(2, [0.03, -0.02, 0.08])")
        self._line(1, "import math")
        self._line(1, "import queue")
        self._line(1, "box = queue.Queue(2)")
        threads = chance.randrange(0, 3)
        for number in range(threads):
            self._thread(number)
        for number in range(threads):
            self._line(1, f"h{number} = start_thread(worker{number}, ())")
        for _ in range(chance.randrange(2, 9)):
            self._statement(1, may_move=True)
        self._line(1, "done = True")
        for number in range(threads):
            self._line(1, chance.choice((f"stop_thread(h{number})", f"join_thread(h{number})", "sync()")))
        self._line(1, 'textmsg("end ", count)')
        self._line(0, "end")
        return "\n".join(self._lines) + "\n"

    def _line(self, depth: int, text: str) -> None:
        self._lines.append("  " * depth + text)

    def _thread(self, number: int) -> None:
        self._line(1, f"def worker{number}():")
        self._line(2, "global count")
        self._line(2, "while not done:")
        self._line(3, "count = count + 1")
        for _ in range(self._random.randrange(1, 3)):
            self._statement(3, may_move=False)
        self._line(3, self._random.choice(("sync()", "sleep(0.013)", "sleep(0.1)")))
        self._line(2, "end")
        self._line(1, "end")

    def _statement(self, depth: int, *, may_move: bool) -> None:
        chance = self._random
        kinds = ["sleep", "sync", "out", "message", "poll", "queue", "work", "read"]
        if may_move:
            kinds += ["movej", "movej", "movel", "loop", "speed_read", "drive", "stream", "blends", "blends", "chain"]
        kind = chance.choice(kinds)
        if kind == "sleep":
            self._line(depth, f"sleep({chance.uniform(0.0, 0.4):.5f})")
        elif kind == "sync":
            self._line(depth, "sync()")
        elif kind == "out":
            self._line(depth, f"set_standard_digital_out({chance.randrange(16)}, {chance.random() < 0.5})")
        elif kind == "message":
            self._line(depth, f'textmsg("at ", get_standard_digital_out({chance.randrange(16)}))')
        elif kind == "poll":
            self._line(depth, "n = 0")
            self._line(
                depth, f"while n < {chance.randrange(1, 30)} and not get_standard_digital_in({chance.randrange(4)}):"
            )
            self._line(depth + 1, "n = n + 1")
            self._line(depth + 1, "sync()")
            self._line(depth, "end")
        elif kind == "queue":
            self._line(depth, "try:")
            self._line(depth + 1, chance.choice(("box.put(count, timeout=0.05)", "seen.append(box.get(timeout=0.02))")))
            self._line(depth, "except queue.Full:")
            self._line(depth + 1, 'textmsg("full")')
            self._line(depth, "except queue.Empty:")
            self._line(depth + 1, 'textmsg("empty")')
            self._line(depth, "end")
        elif kind == "work":
            self._line(depth, f"for i in range({chance.randrange(1, 25000)}):")
            self._line(depth + 1, "pass")
            self._line(depth, "end")
        elif kind == "read":
            self._line(depth, f"textmsg({chance.choice(('get_target_joint_positions', 'get_joint_torques'))}())")
        elif kind == "speed_read":
            self._line(depth, "textmsg(get_target_tcp_speed())")
        elif kind == "movej":
            joints = [round(joint + chance.uniform(-0.4, 0.4), 4) for joint in HOME]
            duration = f", t={chance.uniform(0.5, 2.0):.3f}" if chance.random() < 0.3 else ""
            self._line(
                depth, f"movej({joints}, a={chance.uniform(0.5, 4):.3f}, v={chance.uniform(0.2, 2):.3f}{duration})"
            )
        elif kind == "movel":
            self._line(depth, "p = get_target_tcp_pose()")
            self._line(depth, f"p[{chance.randrange(3)}] += {chance.uniform(-0.05, 0.05):.4f}")
            self._line(depth, "if get_inverse_kin_has_solution(p):")
            self._line(depth + 1, "try:")
            self._line(depth + 2, f"movel(p, a={chance.uniform(0.3, 2):.3f}, v={chance.uniform(0.05, 0.5):.3f})")
            self._line(depth + 1, "except Exception as e:")
            self._line(depth + 2, 'textmsg("refused ", e)')
            self._line(depth + 1, "end")
            self._line(depth, "end")
        elif kind == "drive":
            self._drive(depth)
        elif kind == "stream":
            self._stream(depth)
        elif kind == "blends":
            self._blends(depth)
        elif kind == "chain":
            self._chain(depth)
        else:
            self._line(depth, f"for i in range({chance.randrange(1, 4)}):")
            self._statement(depth + 1, may_move=False)
            self._line(depth, "end")

    def _blends(self, depth: int) -> None:
        """Moves with radii, one after the other, sometimes with something between them."""
        chance = self._random
        self._line(depth, "try:")
        for _ in range(chance.randrange(2, 7)):
            radius = chance.choice((0, 0.0005, 0.004, 0.02, 0.1))
            law = f"a={chance.uniform(0.3, 2):.3f}, v={chance.uniform(0.03, 0.5):.3f}, r={radius}"
            kind = chance.random()
            if kind < 0.4:
                joints = [round(joint + chance.uniform(-0.4, 0.4), 4) for joint in HOME]
                duration = f", t={chance.uniform(0.5, 2.0):.3f}" if chance.random() < 0.2 else ""
                self._line(
                    depth + 1,
                    f"movej({joints}, a={chance.uniform(0.5, 4):.3f}, v={chance.uniform(0.2, 2):.3f}, "
                    f"r={radius}{duration})",
                )
            elif kind < 0.85:
                self._line(depth + 1, "p = get_target_waypoint()")
                for _ in range(chance.randrange(1, 4)):
                    index = chance.randrange(5)
                    size = 0.05 if index < 3 else 0.06
                    self._line(depth + 1, f"p[{index}] += {chance.uniform(-size, size):.4f}")
                duration = f", t={chance.uniform(0.3, 2.0):.3f}" if chance.random() < 0.15 else ""
                self._line(depth + 1, f"movel(p, {law}{duration})")
            else:
                self._line(depth + 1, "p = get_target_waypoint()")
                self._line(depth + 1, "via = list(p)")
                self._line(depth + 1, f"via[0] += {chance.uniform(0.005, 0.03):.4f}")
                self._line(depth + 1, f"via[1] += {chance.uniform(-0.03, 0.03):.4f}")
                self._line(depth + 1, f"p[1] += {chance.uniform(-0.06, 0.06):.4f}")
                self._line(depth + 1, f"p[2] += {chance.uniform(0.002, 0.03):.4f}")
                self._line(depth + 1, f"movec(via, p, {law}, mode=1)")
            if chance.random() < 0.25:
                self._statement(depth + 1, may_move=False)
        self._line(depth, "except Exception as e:")
        self._line(depth + 1, 'textmsg("refused ", e)')
        self._line(depth, "end")

    def _chain(self, depth: int) -> None:
        """Steps of `movep` along a random curve."""
        chance = self._random
        self._line(depth, "try:")
        self._line(depth + 1, "p = get_target_waypoint()")
        self._line(depth + 1, f"for i in range({chance.randrange(1, 60)}):")
        for _ in range(chance.randrange(1, 3)):
            size = chance.choice((0.0005, 0.002, 0.008))
            turn = f" * math.cos(i * {chance.uniform(0, 2):.3f})" if chance.random() < 0.6 else ""
            self._line(depth + 2, f"p[{chance.randrange(3)}] += {chance.uniform(-size, size):.6f}{turn}")
        if chance.random() < 0.3:
            self._line(depth + 2, f"p[{chance.randrange(3, 6)}] += {chance.uniform(-0.02, 0.02):.4f}")
        radius = chance.choice((0.0, 0.0, 0.0003, 0.01))
        self._line(
            depth + 2, f"movep(p, {chance.uniform(0.3, 2):.3f}, {chance.choice((0.006, 0.05, 0.25, 1)):.3f}, {radius})"
        )
        if chance.random() < 0.2:
            self._line(depth + 2, f"sleep({chance.uniform(0, 0.05):.4f})")
        self._line(depth + 1, "end")
        self._line(depth, "except Exception as e:")
        self._line(depth + 1, 'textmsg("refused ", e)')
        self._line(depth, "end")

    def _drive(self, depth: int) -> None:
        """Motions at a speed, one after the other, with whatever else between them; a stop at the end."""
        chance = self._random
        self._line(depth, "try:")
        for _ in range(chance.randrange(1, 4)):
            self._line(depth + 1, self._drive_call())
            self._statement(depth + 1, may_move=False)
        self._line(depth, "except Exception as e:")
        self._line(depth + 1, 'textmsg("refused ", e)')
        self._line(depth, "end")
        self._line(depth, chance.choice(("stopj(8)", "stopj(1.5)", "stopl(0.8)")))

    def _drive_call(self) -> str:
        chance = self._random
        time = chance.choice(("", f", t={chance.uniform(0.001, 0.5):.4f}"))
        if chance.random() < 0.5:
            speeds = [round(chance.uniform(-0.6, 0.6), 3) for _ in range(6)]
            return f"speedj({speeds}, {chance.uniform(0.5, 6):.3f}{time})"
        speeds = [round(chance.uniform(-0.1, 0.1), 3) for _ in range(3)]
        speeds += [round(chance.uniform(-0.2, 0.2), 3) for _ in range(3)]
        return f"speedl({speeds}, {chance.uniform(0.2, 2):.3f}{time})"

    def _stream(self, depth: int) -> None:
        chance = self._random
        self._line(depth, "q = get_target_joint_positions()")
        self._line(depth, f"for i in range({chance.randrange(1, 40)}):")
        self._line(depth + 1, f"q[{chance.randrange(6)}] += {chance.uniform(-0.01, 0.01):.4f}")
        self._line(
            depth + 1,
            f"servoj(q, t={chance.choice((0.004, 0.008, 0.02))}, "
            f"lookahead_time={chance.choice((0.03, 0.1, 0.2))}, gain={chance.choice((100, 300, 2000))})",
        )
        self._line(depth, "end")
        self._line(depth, f"stopj({chance.uniform(1, 9):.2f})")
