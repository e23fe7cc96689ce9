"""Arms with hidden parameters, their program, and recordings of them made in memory from the bytes of the RTSI port."""

import random
from array import array
from itertools import pairwise
from typing import Any, NamedTuple

from elitescript import VirtualRobot
from elitescript.audit.fit.lengths import LENGTHS
from elitescript.client.rtsi_messages import (
    FrameReader,
    OutputLayout,
    message,
    output_request,
    set_up_of,
    version_request,
)
from elitescript.models.model import load_model
from elitescript.protocol.rtsi.variables import OUTPUTS
from elitescript.recorder.recording import Recording

VARIABLES = (
    "timestamp",
    "script_control_line",
    "target_joint_positions",
    "target_joint_speeds",
    "actual_joint_positions",
    "actual_joint_torques",
    "target_TCP_pose",
    "target_TCP_speed",
    "payload_mass",
    "speed_scaling",
    "target_speed_fraction",
)


class HiddenArm(NamedTuple):
    """True parameters of one arm, by the names of a fit."""

    true: dict[str, float]
    seed: int

    @property
    def arm_file(self) -> str:
        true = self.true
        limits = [true[f"qd_max.{joint + 1}"] for joint in range(6)]
        lines = [
            'base = "CS66"',
            "[arm]",
            *(f"{name} = {true[name]!r}" for name in LENGTHS),
        ]
        lines += ["[joints]", f"qd_max = {limits!r}"]
        lines += ["[plant]", f"lag_s = {true['plant.lag_s']!r}", f"noise_rad = {true['plant.noise_rad']!r}"]
        return "\n".join([*lines, f"seed = {self.seed}", ""])

    @property
    def world_file(self) -> str:
        return f"[robot]\nspeed = {self.true['speed_slider']!r}\n"

    @property
    def true_program(self) -> str:
        """What the arm runs: moves of the second program with the hidden defaults written out."""
        true = self.true
        return program(
            f", a={true['default_joint_acceleration']!r}, v={true['default_joint_speed']!r}",
            f", a={true['default_tool_acceleration']!r}, v={true['default_tool_speed']!r}",
            true["payload_kg"],
        )


KNOWN_PROGRAM_PAYLOAD = 1.0


def program(joint: str, tool: str, payload_kg: float) -> str:
    """Return a program of 12 s: moves without speed, two moves that ask for more than joints can do, rests."""
    return (
        "def cell():\n"
        "  set_tcp([0.0, 0.0, 0.12, 0.0, 0.0, 0.0])\n"
        f"  set_payload({payload_kg!r}, [0.0, 0.01, 0.05])\n"
        f"  movej([-0.7, -1.3, -1.6, -1.8, 1.6, 0.2]{joint})\n"
        "  sleep(0.75)\n"
        f"  movej([0.9, -1.7, -1.2, -1.2, 1.1, 0.9]{joint})\n"
        "  sleep(0.75)\n"
        "  movej([2.9, -1.7, -1.2, -1.2, 1.1, 0.9], a=10.0, v=6.0)\n"
        "  movej([2.9, -1.7, -1.2, 0.8, 1.1, 0.9], a=10.0, v=6.0)\n"
        f"  movel([-0.45, 0.12, 0.45, 3.0, 0.2, 1.0]{tool})\n"
        "end\n"
    )


AUDITED_PROGRAM = program("", "", KNOWN_PROGRAM_PAYLOAD)
"""What is known of the program that an arm ran: the same lines without the hidden numbers."""


def hidden_arm(seed: int) -> HiddenArm:
    """Return an arm that differs from a CS66 in everything that a recording can show."""
    rng = random.Random(seed)
    model = load_model("CS66")
    true: dict[str, float] = {name: getattr(model.arm, name) + rng.uniform(-0.005, 0.005) for name in LENGTHS}
    true.update({f"qd_max.{joint + 1}": model.joints[joint].qd_max * rng.uniform(0.5, 1.0) for joint in range(6)})
    true["qd_max.4"] = 3.0 * rng.uniform(0.5, 0.9)
    true["default_joint_speed"] = rng.uniform(0.5, 1.1)
    true["default_joint_acceleration"] = rng.uniform(1.0, 3.0)
    true["default_tool_speed"] = rng.uniform(0.1, 0.3)
    true["default_tool_acceleration"] = rng.uniform(0.5, 1.5)
    true["plant.lag_s"] = rng.uniform(0.005, 0.03)
    true["plant.noise_rad"] = rng.uniform(1e-5, 2e-4)
    true["payload_kg"] = rng.uniform(0.2, 4.0)
    true["speed_slider"] = round(rng.uniform(0.5, 1.0), 3)
    return HiddenArm(true, seed)


def recorded_in_memory(hidden: HiddenArm, path: Any, lost: float = 0.02, until_s: float = 60.0) -> Recording:
    """Return a recording of an arm's program, decoded from the bytes of its RTSI port, with packages lost at random."""
    arm = path / f"hidden{hidden.seed}.toml"
    arm.write_text(hidden.arm_file, encoding="utf-8")
    text = path / f"hidden{hidden.seed}.script"
    text.write_text(hidden.true_program, encoding="utf-8")
    robot = VirtualRobot(str(arm), speed=hidden.true["speed_slider"])
    client = robot.connect("rtsi")
    frames = FrameReader()
    found: list[tuple[float, ...]] = []
    rng = random.Random(hidden.seed)

    def answer(request: bytes) -> bytes:
        client.send(request)
        robot.advance(0.008)
        return next(frame.payload for frame in frames.feed(client.receive()) if frame.command != ord("U"))

    answer(version_request())
    layout_answer = set_up_of(answer(output_request(VARIABLES, 250.0)), VARIABLES, "output")
    layout = OutputLayout(layout_answer.ident, VARIABLES, layout_answer.words, 250.0)
    answer(message("S"))

    def take(_: Any = None) -> None:
        for frame in frames.feed(client.receive()):
            if frame.command == ord("U") and rng.random() >= lost:
                found.append(layout.flat(frame.payload))

    robot.run(text, until_s=until_s, watch=take)
    robot.advance(0.8)
    take()
    return recording_of(layout, found)


def recording_of(layout: OutputLayout, rows: list[tuple[float, ...]]) -> Recording:
    names = []
    for name in layout.names:
        length = OUTPUTS[name].type.length
        names += [name] if length == 1 else [f"{name}.{index}" for index in range(length)]
    columns = {name: array("d", (float(row[at + 1]) for row in rows)) for at, name in enumerate(names)}
    t = columns["timestamp"]
    gaps = tuple((a, b) for a, b in pairwise(t) if b - a > 0.006)
    return Recording(
        t=t,
        arrived_s=array("d", t),
        columns=columns,
        rate_hz=250.0,
        gaps=gaps,
        facts={"tcp_offset": [0, 0, 0.12, 0, 0, 0]},
    )
