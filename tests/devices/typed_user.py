"""A program of a user as type checkers see it: settings of devices, common fields of events, what a run says.

`make types` checks it: each line with `type: ignore` is a mistake that mypy must find, since it refuses a
`type: ignore` that has nothing to ignore. Nothing runs it.
"""

from __future__ import annotations

from elitescript import VirtualRobot
from elitescript.testing.world import Device, ModbusClient, ModbusDevice, Schedule, TcpServer, Wire, World


class Camera(TcpServer):
    port = 5000
    exposure_s: float = 0.1


class Button(Device):
    input: str = "standard_digital_in[0]"


devices = [
    Camera(port=5001, exposure_s=0.2, name="eye"),
    Button(input="standard_digital_in[1]"),
    ModbusDevice(),
    ModbusClient(),
    Schedule(signal="safeguard_stop", at=[(5.0, True)]),
]
world = World(devices=devices, wires=[Wire(when="a", then="b", after_s=0.1)])
run = VirtualRobot(world=world).run("x", until_s=1)
times: list[float] = [event.t for event in run.events]
lines: list[int] = [event.line for event in run.events]
bad: int = run.findings.warning + run.findings.error
where: list[tuple[str, int, float | None]] = [(found.severity, found.line, found.t) for found in run.findings]

print(run.events[0].tt)  # type: ignore[union-attr]
print(run.findings[0].sverity)  # type: ignore[attr-defined]
Camera(prt=5001)  # type: ignore[call-arg]
Camera(port="5001")  # type: ignore[arg-type]
Camera(exposre_s=0.1)  # type: ignore[call-arg]
Button(inptu="x")  # type: ignore[call-arg]
Wire(whn="a")  # type: ignore[call-arg]
Schedule(evry_s=1)  # type: ignore[call-arg]
World(wires=3)  # type: ignore[arg-type]
World(wold=1)  # type: ignore[call-arg]
VirtualRobot(wold=1)  # type: ignore[call-arg]
