"""What common clients do, in their order: small clients of our own in robot time."""

from __future__ import annotations

from pathlib import Path

from elitescript import VirtualRobot
from tests.protocol import primary_client, rtsi_client

TICK_S = 0.004
FILES = {
    "wait_program.task": "<task/>",
    "wait_program.script": "def wait_program():\n  while True:\n    sleep(0.1)\n  end\nend\n",
    "default.configuration": "",
}


class Shell:
    """A client of the dashboard that reads a reply for each command."""

    def __init__(self, robot: VirtualRobot) -> None:
        self.client = robot.connect("dashboard")
        self.client.expect(b"NAME.\r\n")

    def ask(self, command: str) -> str:
        self.client.send(command.encode() + b"\n")
        return self.client.expect(b"\r\n").decode().removesuffix("\r\n")

    def until(self, command: str, reply: str) -> None:
        for _ in range(1000):
            if self.ask(command) == reply:
                return
        raise AssertionError(f"{command} has never been answered with {reply!r}")


def test_a_bad_program_is_answered_by_an_exception_of_the_script() -> None:
    robot = VirtualRobot()
    client = robot.connect("primary")
    client.send(b'def hello():\n\ttextmsg("hello world")\nend\n')
    client.send(b"def exFunc():\n\t1abcd\nend\n")
    stream = client.expect(b"SyntaxError")
    robot.advance(0.1)
    stream += client.receive()
    found = []
    while stream:
        size = int.from_bytes(stream[:4])
        message, stream = stream[:size], stream[size:]
        if message[4] == 20:
            found.append(primary_client.robot_message(message))
    (exception,) = [message for message in found if message["kind"] == 10]
    assert exception["line"] == 2


def test_an_rtsi_client_sets_an_output_and_sees_it() -> None:
    robot = VirtualRobot()
    where = rtsi_client.STANDARD_OUTPUTS.index("actual_digital_output_bits")
    for _ in range(3):
        client = robot.connect("rtsi")

        def asked(message: bytes, client=client) -> bytes:
            client.send(message)
            robot.advance(TICK_S)
            ((letter, body), *_) = rtsi_client.messages(client.receive())
            assert letter == chr(message[2])
            return body

        assert asked(rtsi_client.message("V", b"\0\1")) == b"\1"
        assert len(asked(rtsi_client.message("v"))) == 16
        ident, types = rtsi_client.set_up(asked(rtsi_client.input_recipe(rtsi_client.STANDARD_INPUTS)))
        assert ident == 1
        _, kinds = rtsi_client.set_up(asked(rtsi_client.output_recipe(250.0, rtsi_client.STANDARD_OUTPUTS)))
        assert asked(rtsi_client.message("S")) == b"\1"
        for level in (0, 1, 0):
            values = dict.fromkeys(rtsi_client.STANDARD_INPUTS, 0)
            values |= {"standard_digital_output_mask": 1, "standard_digital_output": level}
            values["external_force_torque"] = (0.0,) * 6
            body = asked(rtsi_client.package(ident, types, values.values()))
            assert rtsi_client.values(body, kinds)[where] & 1 == level
        # The next one claims the same inputs.
        client.close()


def test_a_dashboard_client_runs_a_task(tmp_path: Path) -> None:
    for name, text in FILES.items():
        (tmp_path / name).write_text(text)
    shell = Shell(VirtualRobot(task_dir=tmp_path))
    assert shell.ask("closeSafetyDialog") == "closing safety dialog"
    assert shell.ask("task -p wait_program.task") == "Loaded task: wait_program.task"
    shell.until("task", "Relative path:wait_program.task")
    assert shell.ask("robotControl -off") == "Powering off"
    shell.until("robotMode", "robotMode: POWER_OFF")
    assert shell.ask("robotControl -on") == "Powering on"
    shell.until("robotMode", "robotMode: IDLE")
    assert shell.ask("brakeRelease").startswith("Brake ")
    shell.until("robotMode", "robotMode: RUNNING")
    for _ in range(2):
        assert shell.ask("play") == "Starting task"
        shell.until("task -s", "Task is running")
        assert shell.ask("pause") == "Pausing task"
        shell.until("task -s", "Task is paused")
    assert shell.ask("stop") == "Stopping task"
    shell.until("task -s", "Task is stopped")
    assert shell.ask("robotControl -off") == "Powering off"
    assert shell.ask("stop") == "Stopping task"
    assert shell.ask("log -a Testing Log:") == "Log has been added."
    assert shell.ask("configuration -p default.configuration").startswith("Loading Configuration :")
    shell.until("configuration", "configuration: Relative path:default.configuration")
