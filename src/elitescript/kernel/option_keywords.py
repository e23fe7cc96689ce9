"""Types of the options that `VirtualRobot` takes. Written by `python tools/write_reference.py`; do not edit."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypedDict

if TYPE_CHECKING:
    from elitescript.controller.force.contact import ContactConfig
    from elitescript.controller.safety.limits import SafetyLimits
    from elitescript.messages.motion import Six
    from elitescript.messages.plant import PlantConfig


class RobotKeywords(TypedDict, total=False):
    """Options by their names; those of `RobotOptions` that users set."""

    firmware: str
    """controller firmware (default: '2.14')"""
    controller_version: str
    """version that the robot reports to clients and programs; what it can do is that of the firmware (default:
    2.10.0.0 of firmware 2.10, 2.15.0.0 of firmware 2.14)"""
    seed: int
    """seed of random() (default: 0)"""
    epoch_s: float
    """controller clock at the start, s since 1970 (default: 2024-01-01T00:00:00Z; of serve, the present time)"""
    joints: Six | None
    """joint positions at the start, rad (default: the model's home)"""
    speed: float
    """speed slider as a fraction (default: 1.0)"""
    power_on: bool
    """begin with power on and brakes released (default: True)"""
    remote: bool
    """whether clients may change the robot at the start (default: True)"""
    robot_id: str
    """name of the robot that clients are shown (default: 'elitescript')"""
    serial_number: str
    """serial number that clients are shown (default: 'ES0000000001')"""
    query_form: str
    """form of the replies of the query port: `[ID] [success] : [VALUE]` without exponents, or `ID success : VALUE`
    (default: 'bracketed')"""
    configuration: str
    """path of the configuration that is loaded at the start (default: 'default.configuration')"""
    safety: SafetyLimits | None
    """what the safety system watches (default: None)"""
    contact: ContactConfig | None
    """planes that the TCP can touch (default: None)"""
    plant: PlantConfig | None
    """how the joints follow their targets (default: exactly, unless an own arm has a `[plant]`)"""
    work_per_tick: int
    """loop passes and calls that a thread may make in one tick; how many the real controller makes is not known
    (default: 2000)"""
    held_up_max_s: float
    """for how long calls of 10 ms and more may hold up a served robot, beyond 1 % of the time, before its program
    ends with R135; 0: for ever (default: 0.25)"""
    rpc_timeout_s: float
    """how long a remote procedure call waits for its answer; 0 waits for ever (default: 60.0)"""
    network: str
    """what programs reach besides what is beside the robot in its world: none; local, the loopback addresses of this
    computer; HOST[:PORT],..., these as well; all (default: 'local')"""
    strict: bool
    """refuse what only warns otherwise (default: False)"""
    ignore: str
    """codes of findings that check and runs leave out, such as W230,N280; what ends a program cannot be left out
    (default: '')"""
    confirms_popups: bool
    """confirm popups that block at once; if not, a client of the dashboard does (default: True)"""
