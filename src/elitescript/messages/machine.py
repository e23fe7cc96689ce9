"""Requests that change the machine without moving it."""

from __future__ import annotations

from elitescript.messages.enums import AnalogDomain, PulseDecoder, RunstateChoice, ToolPinMode
from elitescript.messages.motion import MotionRequest, Six
from elitescript.messages.signals import Value
from elitescript.records import record


@record
class WriteSignal:
    """Set one point of `messages.signals`."""

    name: str
    index: int
    value: Value


@record
class WritePortCoils:
    """Set coils of the controller's own Modbus server, upwards from an address: all of them or none."""

    first: int
    values: tuple[bool, ...]


@record
class WritePortRegisters:
    """Set registers of the controller's own Modbus server, upwards from an address: all of them or none."""

    first: int
    values: tuple[int, ...]
    """0 to 65535 each."""
    read_first: int = 0
    read_count: int = 0
    """Registers that the reply holds, read right after the write; none if the count is 0."""


@record
class SetAnalogDomain:
    """Choose current or voltage for one analog channel."""

    name: str
    index: int
    domain: AnalogDomain


@record
class SetAnalogFraction:
    """Drive an analog output to a fraction (0 to 1) of the range of its domain."""

    name: str
    index: int
    fraction: float


@record
class SetRunstateChoice:
    """Tie an output to whether a program runs."""

    name: str
    index: int
    choice: RunstateChoice


@record
class SetInputAction:
    """Bind hand guiding to an input, or unbind it."""

    name: str
    index: int
    is_freedrive: bool


@record
class ResetInputActions:
    """Unbind every input."""


@record
class SetToolAnalogMode:
    """Choose the use of the tool's shared pins: 0 serial, 1 analog in, 2 analog out, 3 both."""

    mode: int


@record
class SetToolPin:
    """Configure one digital pin of the tool."""

    index: int
    mode: ToolPinMode
    is_enabled: bool
    is_output: bool


@record
class SetTcp:
    """Set the active TCP: transform from flange to TCP as a pose."""

    offset: Six


@record
class SetPayload:
    """Set the payload at the flange."""

    mass_kg: float
    cog: tuple[float, float, float]
    """Centre of gravity in the flange frame, m."""
    inertia: Six = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    """Ixx, Iyy, Izz, Ixy, Ixz, Iyz about the centre of gravity, kg m^2."""


@record
class SetGravity:
    """Set the acceleration of the base against free fall: points away from the earth, m/s^2, base frame."""

    vector: tuple[float, float, float]


@record
class SetSpeedScale:
    """Set the speed percentage of the pendant as a fraction, 0 to 1."""

    fraction: float


@record
class SetOption:
    """Set an option that the simulation does not show."""

    name: str
    value: Value


@record
class SetLineMark:
    """Report the node of the pendant's program tree that the program has reached (`$ LINE`)."""

    number: int
    label: str


@record
class PrepareEncoder:
    """Let the program supply the count of a conveyor encoder."""

    index: int
    range_id: int
    """0 signed 32 bits, 1 to 4 unsigned 8, 16, 24, 32 bits."""


@record
class DecodePulses:
    """Let a conveyor encoder count pulses at high-speed inputs."""

    index: int
    decoder: PulseDecoder
    input_a: int
    input_b: int


@record
class SetEncoderCount:
    """Supply the count of a conveyor encoder."""

    index: int
    count: float


@record
class PowerOn:
    """Power the arm on; it becomes idle, with its brakes closed."""


@record
class ReleaseBrakes:
    """Open the brakes; an arm without power is powered on first."""


@record
class PowerOff:
    """Stop the arm and power it off; the cabinet stays on."""


@record
class PowerDown:
    """Stop the arm, then switch off arm and cabinet."""


@record
class PauseTask:
    """Brake on the path and hold every script thread."""


@record
class ResumeTask:
    """Resume a paused task."""


@record
class StopTask:
    """End the task; the arm brakes."""


@record
class SetForceGain:
    """Set the gain of force control, 0 to 2."""

    scaling: float


@record
class SetForceDamping:
    """Set the damping of force control, 0 to 1."""

    damping: float


@record
class ZeroForceSensor:
    """Take the present compensated wrench as zero."""


@record
class SetClientSensor:
    """Switch between a client's force sensor (signals `external_force_torque`) and that of the arm."""

    is_enabled: bool
    mass_kg: float = 0.0
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Where it measures, flange frame, m."""
    cog: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Its centre of gravity, flange frame, m."""


@record
class AskSafety:
    """Request an action of the safety system."""

    action: str
    """`stop_protectively`, `unlock_protective_stop`, `restart_safety`, `violate` or `fail`."""
    reason: str = ""


@record
class DisturbInput:
    """Let a digital or analog input read another value than the applied one, for a time.

    Attributes:
        kind: `stuck`, `inverted`, `bouncing`, `open_wire`, `drifting`, `noisy` or `late`.
        name: family of the input.
        index: within the family.
        begin_tick: the first tick with it; a past one begins at once.
        ticks: how long it lasts; to the end if None.
        value: what `stuck` and `open_wire` read; the present level or the default of the kind if None.
        span_ticks: settling time of `bouncing`, delay of `late`, period of `drifting` and `noisy`.
        bounces: of `bouncing`, after each edge.
        amount: V/s or A/s of `drifting`; standard deviation, V or A, or flips a second of `noisy`.
        bound: largest deviation of `drifting`, V or A; without a limit if None.
        seed: of the random numbers.
    """

    kind: str
    name: str
    index: int
    begin_tick: int = 0
    ticks: int | None = None
    value: bool | float | None = None
    span_ticks: int = 1
    bounces: int = 1
    amount: float = 0.0
    bound: float | None = None
    seed: int = 0


@record
class EndInputFaults:
    """Let every input read the applied value again."""


MachineRequest = (
    WriteSignal
    | WritePortCoils
    | WritePortRegisters
    | SetAnalogDomain
    | SetAnalogFraction
    | SetRunstateChoice
    | SetInputAction
    | ResetInputActions
    | SetToolAnalogMode
    | SetToolPin
    | SetTcp
    | SetPayload
    | SetGravity
    | SetSpeedScale
    | SetOption
    | SetLineMark
    | PrepareEncoder
    | DecodePulses
    | SetEncoderCount
    | PowerOn
    | ReleaseBrakes
    | PowerOff
    | PowerDown
    | PauseTask
    | ResumeTask
    | StopTask
    | AskSafety
    | SetForceGain
    | SetForceDamping
    | ZeroForceSensor
    | SetClientSensor
    | DisturbInput
    | EndInputFaults
)

Request = MotionRequest | MachineRequest
