from array import array

from elitescript.controller.force.contact import ContactConfig, Plane
from elitescript.controller.safety.limits import SafetyBounds, SafetyLimits, SafetyPlane, ToolDirection
from elitescript.kernel import RobotOptions
from elitescript.messages.codec import from_text, to_text
from elitescript.messages.events import MotionStarted
from elitescript.messages.motion import MicroLine, MoveML
from elitescript.messages.outputs import Output
from elitescript.messages.plant import PlantConfig
from elitescript.services.config_codec import full_codec, output_text
from tests.protocol.snapshots import output


def test_every_part_of_a_configuration_comes_back():
    config = RobotOptions(
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
        faults=('{"kind": "drop", "on": 5000}',),
        signals=(("flag[3]", True), ("output_float_register[1]", 0.1), ("output_int_register[1]", 7)),
    )
    shape = full_codec().shape(RobotOptions)
    back = shape.decode(from_text(to_text(shape.encode(config))))
    assert back == config
    assert back.contact.planes[0].direction == config.contact.planes[0].direction


def test_the_points_of_a_file_stay_where_they_are():
    points = MicroLine("p.txt", 0.004, False, array("d", [0.5] * 600).tobytes(), array("I", range(100)).tobytes())
    event = MotionStarted(5, MoveML(points, 1, 100, 1.0, 1.0), 3, "main", 0.4)
    shape = full_codec().shape(Output)
    (back,) = shape.decode(from_text(output_text(shape, output(events=(event,))))).events
    assert (back.request.points.name, back.request.last, back.request.points.numbers) == ("p.txt", 100, b"")
