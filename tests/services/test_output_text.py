from array import array

from elitescript.codec.json_text import from_text, to_text
from elitescript.codec.messages import shape_of
from elitescript.controller.force.contact import ContactConfig, Plane
from elitescript.controller.safety.limits import SafetyBounds, SafetyLimits, SafetyPlane, ToolDirection
from elitescript.kernel import KernelConfig
from elitescript.messages.events import MotionStarted
from elitescript.messages.faults import ChannelFault
from elitescript.messages.machine import DisturbInput
from elitescript.messages.motion import MicroLine, MoveML
from elitescript.messages.outputs import Output
from elitescript.messages.plant import PlantConfig
from elitescript.services.output_text import output_text
from tests.protocol.snapshots import output


def test_every_part_of_a_configuration_comes_back():
    config = KernelConfig(
        model="mine.toml",
        model_text='base = "CS66"\n[arm]\nd6 = 0.095\n',
        joints=(0.0, -1.5, 1.0, -1.0, 1.5, 0.1),
        plant=PlantConfig(lag_s=0.01),
        contact=ContactConfig((Plane((0.0, 0.0, 0.1), (0.0, 1.0, 2.0), friction=0.1),)),
        safety=SafetyLimits(
            SafetyBounds(qd_max=(1.0,) * 6, tcp_speed_max=0.5),
            planes=(SafetyPlane("table", (0.0, 0.0, 0.1), (0.0, 1.0, 3.0), pair=1),),
            tool_direction=ToolDirection((0.0, 0.0, 1.0), 0.5),
        ),
        faults=(
            ChannelFault("drop", 5000, ("tcp", "", 5000)),
            ChannelFault("wrong_reply", "h:1", ("tcp", "h", 1), 5, 6, form="bytes", reply=b"\xff"),
            DisturbInput("stuck", "standard_digital_in", 3, value=True),
        ),
        signals=(("flag[3]", True), ("output_float_register[1]", 0.1), ("output_int_register[1]", 7)),
    )
    shape = shape_of(KernelConfig)
    back = shape.decode(from_text(to_text(shape.encode(config))))
    assert repr(back) == repr(config)
    assert back.contact.planes[0].direction == config.contact.planes[0].direction


def test_the_points_of_a_file_stay_where_they_are():
    points = MicroLine("p.txt", 0.004, False, array("d", [0.5] * 600).tobytes(), array("I", range(100)).tobytes())
    event = MotionStarted(5, MoveML(points, 1, 100, 1.0, 1.0), 3, "main", 0.4)
    shape = shape_of(Output)
    (back,) = shape.decode(from_text(output_text(output(events=(event,))))).events
    assert (back.request.points.name, back.request.last, back.request.points.numbers) == ("p.txt", 100, b"")
