from array import array

import pytest

from elitescript.codec.json_text import from_text, to_text
from elitescript.codec.messages import shape_of
from elitescript.codec.values import CodecError
from elitescript.controller.force.contact import ContactConfig, Plane
from elitescript.controller.safety.limits import SafetyBounds, SafetyLimits, SafetyPlane, ToolDirection
from elitescript.kernel import RobotOptions
from elitescript.messages.events import MotionStarted
from elitescript.messages.faults import ChannelFault
from elitescript.messages.machine import DisturbInput
from elitescript.messages.motion import MicroLine, MoveML
from elitescript.messages.outputs import Output
from elitescript.messages.plant import PlantConfig
from elitescript.services.journal.format2 import Format2
from elitescript.services.options_data import options_data, options_from_data
from elitescript.services.output_text import output_text
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
        faults=(
            ChannelFault("drop", 5000, ("tcp", "", 5000)),
            ChannelFault("wrong_reply", "h:1", ("tcp", "h", 1), 5, 6, form="bytes", reply=b"\xff"),
            DisturbInput("stuck", "standard_digital_in", 3, value=True),
        ),
        signals=(("flag[3]", True), ("output_float_register[1]", 0.1), ("output_int_register[1]", 7)),
    )
    back = options_from_data(from_text(to_text(options_data(config))))
    assert repr(back) == repr(config)
    assert back.contact.planes[0].direction == config.contact.planes[0].direction


FORMAT_2 = [
    *("CS63", "", "2.10", 5, 7, 1e9, None, 0.5, True, [0.4, 0.8, 1.0], False, "name", "ES1", "my.configuration"),
    *(None, None, None, [["flag[3]", True]], ['{"kind": "drop", "on": 5000}'], 2000, 60.0, True),
]
"""By hand: what stands in the first line of journals that have been written."""


class TestOptionsOfAJournal:
    """By hand: what stands in the first line of journals that have been written."""

    FORMAT_2 = (
        *("CS63", "", "2.10", 5, 7, 1e9, None, 0.5, True, [0.4, 0.8, 1.0], False, "name", "ES1", "my.configuration"),
        *(None, None, None, [["flag[3]", True]], ['{"kind": "drop", "on": 5000}'], 2000, 60.0, True),
    )

    def test_those_of_format_2_have_no_names(self):
        options = Format2().options(list(self.FORMAT_2))
        assert options == RobotOptions(
            model="CS63",
            firmware="2.10",
            seed=5,
            first_tick=7,
            epoch_s=1e9,
            speed=0.5,
            power_on=True,
            remote=False,
            robot_id="name",
            serial_number="ES1",
            configuration="my.configuration",
            signals=(("flag[3]", True),),
            faults=(ChannelFault("drop", 5000, ("tcp", "", 5000)),),
            strict=True,
        )

    def test_an_option_that_is_not_named_has_its_default(self):
        options = options_from_data({"seed": 4, "speed": 0.5})
        assert options == RobotOptions(seed=4, speed=0.5)

    def test_every_option_is_written_by_its_name(self):
        data = options_data(RobotOptions(seed=4, signals=(("flag[3]", True),)))
        assert (data["seed"], data["signals"], data["power_times"]) == (4, [["flag[3]", True]], [0.4, 0.8, 1.0])
        assert set(data) == set(RobotOptions.__slots__)

    @pytest.mark.parametrize(
        ("options", "words"),
        [
            ({"spee": 1.0}, "no option 'spee'"),
            ({"speed": 2.0}, r"speed must be in \[0, 1\], got 2.0"),
            ([], "by their names"),
        ],
    )
    def test_a_mistake_is_named(self, options, words):
        with pytest.raises(CodecError, match=words):
            options_from_data(options)


def test_the_points_of_a_file_stay_where_they_are():
    points = MicroLine("p.txt", 0.004, False, array("d", [0.5] * 600).tobytes(), array("I", range(100)).tobytes())
    event = MotionStarted(5, MoveML(points, 1, 100, 1.0, 1.0), 3, "main", 0.4)
    shape = shape_of(Output)
    (back,) = shape.decode(from_text(output_text(output(events=(event,))))).events
    assert (back.request.points.name, back.request.last, back.request.points.numbers) == ("p.txt", 100, b"")
